#include "carnot/plots/figure.h"

#include <limits>
#include <stdexcept>

#include "plot_fixtures.h"

namespace carnot::plots {
namespace {

using View = Drawing::View;
using FigureFile = Directory;

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

// Every figure of one trajectory, in every view, without a warning.
void draw_all(const std::string& stem, const Trajectory& trajectory) {
  for (const View view : {View::kPlane, View::kSpace, View::kTimeOnly}) {
    for (const Figure figure :
         {Figure::kAutomatic, Figure::kTime, Figure::kEnergy, Figure::kOverview}) {
      if (view == View::kTimeOnly && figure == Figure::kOverview) continue;
      SCOPED_TRACE(static_cast<int>(view) * 10 + static_cast<int>(figure));
      draw_silently(stem + ".svg", scene_of(view), {curve_of(trajectory)}, figure);
    }
  }
}

TEST_F(FigureFile, NamesWhatItShows) {
  const Trajectory trajectory = wave(50);
  Curve curve = curve_of(trajectory);
  curve.name = "Ann's {best}";
  draw_silently(file("a.svg"), plane_scene(), {curve});
  const std::string svg = contents(file("a.svg"));
  for (const std::string text : {"two_wheels: Ann's {best}",
                                 "action 1.5, length 2.5, largest turn 0.5 rad",
                                 "x [length]",
                                 "y [length]",
                                 "t [time]",
                                 "start",
                                 "goal",
                                 "path of (x, y)",
                                 "other wheel"}) {
    EXPECT_NE(svg.find(text), std::string::npos) << text;
  }
  EXPECT_EQ(entries(), 1);
}

TEST_F(FigureFile, EveryEndingWorksForEveryView) {
  const Trajectory trajectory = wave(40);
  for (const View view : {View::kPlane, View::kSpace, View::kTimeOnly}) {
    for (const std::string ending : {"png", "svg", "pdf", "gif"}) {
      draw_silently(file("a." + ending), scene_of(view), {curve_of(trajectory)});
    }
  }
  EXPECT_EQ(entries(), 4);
}

TEST_F(FigureFile, AFilmHasManyFrames) {
  const Trajectory trajectory = wave(40);
  draw_silently(file("a.gif"), plane_scene(), {curve_of(trajectory)});
  const std::string gif = contents(file("a.gif"));
  EXPECT_NE(gif.find("NETSCAPE2.0"), std::string::npos);
  std::size_t frames = 0;  // graphic control extensions
  const std::string mark("\x21\xf9\x04", 3);
  for (auto at = gif.find(mark); at != std::string::npos; at = gif.find(mark, at + 1)) ++frames;
  EXPECT_GE(frames, 40U);
}

TEST_F(FigureFile, SeveralCurvesBecomePanels) {
  const Trajectory a = wave(40);
  const Trajectory b = wave(40, 1, 3);
  std::vector<Curve> curves;
  for (int n = 1; n <= 9; ++n) {
    curves.push_back(curve_of(n % 2 == 0 ? a : b));
    draw_silently(file("a.svg"), plane_scene(), curves);
  }
  EXPECT_NE(contents(file("a.svg")).find("first 6 of 9"), std::string::npos);
  for (const Figure figure : {Figure::kAutomatic, Figure::kTime, Figure::kEnergy}) {
    draw_silently(file("b.svg"), scene_of(View::kSpace), curves, figure);
  }
}

TEST_F(FigureFile, DegeneratePathsAreDrawn) {
  draw_all(file("one_point"), wave(1));
  Trajectory rest = wave(20);
  for (auto& q : rest.q) q = {0, 0, 0};
  for (auto& p : rest.p) p = {0, 0, 0};
  draw_all(file("from_is_to"), rest);
  Trajectory straight = wave(20);
  for (auto& q : straight.q) q = {q[0], 0, 0};
  draw_all(file("straight"), straight);
  Trajectory upright = wave(20);
  for (auto& q : upright.q) q = {0, q[0], 0};
  draw_all(file("upright"), upright);
}

TEST_F(FigureFile, LargeAndSmallCoordinatesAreDrawn) {
  draw_all(file("far"), wave(20, 4.5e9));
  draw_all(file("far_point"), wave(1, 4.5e9));
  draw_all(file("large"), wave(20, 0, 4.5e9));
  draw_all(file("huge"), wave(20, 0, 1e200));
  draw_all(file("small"), wave(20, 0, 1e-9));
}

TEST_F(FigureFile, ValuesThatAreNotFiniteAreLeftOut) {
  Trajectory hole = wave(20);
  hole.q[7] = {kNan, 1, 2};
  hole.p[8] = {kNan, kNan, kNan};
  hole.lambda[0] = {kNan, 1 / 0.0};
  hole.hamiltonian[9] = kNan;
  hole.q.front()[1] = kNan;
  hole.q.back()[0] = kNan;
  draw_all(file("hole"), hole);
  draw_silently(file("hole.gif"), plane_scene(), {curve_of(hole)});
  Trajectory nothing = wave(3);
  for (auto& q : nothing.q) q = {kNan, kNan, kNan};
  for (auto& h : nothing.hamiltonian) h = kNan;
  draw_all(file("nothing"), nothing);
}

TEST_F(FigureFile, NoMultipliersNoPanel) {
  Trajectory free = wave(10);
  for (auto& lambda : free.lambda) lambda.clear();
  draw_silently(file("a.svg"), plane_scene(), {curve_of(free)}, Figure::kTime);
  EXPECT_EQ(contents(file("a.svg")).find("λ"), std::string::npos);
}

TEST_F(FigureFile, BadInputIsRefused) {
  const Trajectory trajectory = wave(10);
  const Trajectory empty;
  const auto name = file("a.png");
  EXPECT_THROW(write_figure(name, plane_scene(), {}), std::invalid_argument);
  EXPECT_THROW(write_figure(name, plane_scene(), {curve_of(empty)}), std::invalid_argument);
  EXPECT_THROW(write_figure(name, plane_scene(), {Curve{}}), std::invalid_argument);
  EXPECT_THROW(write_figure(file("a.bmp"), plane_scene(), {curve_of(trajectory)}),
               std::invalid_argument);
  EXPECT_THROW(write_figure(name, scene_of(View::kTimeOnly), {curve_of(trajectory)}, Figure::kPath),
               std::invalid_argument);
  EXPECT_EQ(entries(), 0);
}

}  // namespace
}  // namespace carnot::plots
