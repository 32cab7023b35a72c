#include "carnot/plots/figure.h"

#include <limits>
#include <optional>
#include <stdexcept>

#include "carnot/plots/curves_of.h"
#include "plot_fixtures.h"

namespace carnot::plots::figure_test {
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
                                 ">start<",
                                 ">end<",
                                 "path of (x, y)",
                                 "other wheel"}) {
    EXPECT_NE(svg.find(text), std::string::npos) << text;
  }
  EXPECT_EQ(entries(), 1);
}

// A forbidden region, an arc and a touch, in every figure that has room for them.
TEST_F(FigureFile, ShowsLimits) {
  const Trajectory trajectory = wave(40);
  Curve curve = curve_of(trajectory);
  const double end = trajectory.t.back();
  curve.on_limits = {{0.2 * end, 0.4 * end}, {0.7 * end, 0.7 * end}};
  SceneInfo scene = plane_scene();
  scene.limits.resize(1);
  scene.limits[0].outline = {{0, 0}, {1, 0}, {0, 1}};
  const std::string region = "rgb(216, 212, 206)";
  const std::string band = "rgb(251, 230, 207)";
  for (const Figure figure : {Figure::kPath, Figure::kTime, Figure::kOverview}) {
    draw_silently(file("a.svg"), scene, {curve}, figure);
    const std::string svg = contents(file("a.svg"));
    EXPECT_EQ(svg.find(region) != std::string::npos, figure != Figure::kTime);
    EXPECT_EQ(svg.find(band) != std::string::npos, figure != Figure::kPath);
    if (figure == Figure::kPath) {
      EXPECT_NE(svg.find("at a limit"), std::string::npos);
    }
  }
  draw_silently(file("a.gif"), scene, {curve});
  curve.on_limits.clear();
  draw_silently(file("a.svg"), plane_scene(), {curve});
  EXPECT_EQ(contents(file("a.svg")).find("at a limit"), std::string::npos);
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

TEST_F(FigureFile, DotsForZeroErrorAreInTheLegendOnlyIfThereAreAny) {
  Trajectory trajectory = wave(20);
  for (std::size_t i = 0; i < 20; ++i) trajectory.hamiltonian[i] = i == 0 ? 1 : 1 + 1e-12;
  draw_silently(file("a.svg"), plane_scene(), {curve_of(trajectory)}, Figure::kTime);
  EXPECT_EQ(contents(file("a.svg")).find("exactly 0"), std::string::npos);
  trajectory.hamiltonian[7] = 1;
  draw_silently(file("a.svg"), plane_scene(), {curve_of(trajectory)}, Figure::kTime);
  EXPECT_NE(contents(file("a.svg")).find("exactly 0"), std::string::npos);
}

TEST_F(FigureFile, ALineWithoutPointsIsNotInTheLegend) {
  Trajectory trajectory = wave(20);
  for (double& h : trajectory.hamiltonian) h = 1;
  draw_silently(file("a.svg"), plane_scene(), {curve_of(trajectory)}, Figure::kTime);
  const std::string svg = contents(file("a.svg"));
  EXPECT_EQ(svg.find("|H"), std::string::npos);
  EXPECT_NE(svg.find("exactly 0"), std::string::npos);
}

TEST_F(FigureFile, MomentaHaveTheUnitOfActionOverThatOfTheCoordinate) {
  SceneInfo info = plane_scene();
  info.configuration[1].unit = "rad/time";
  info.configuration[2].unit = "1";
  const Trajectory trajectory = wave(10);
  draw_silently(file("a.svg"), info, {curve_of(trajectory)}, Figure::kTime);
  const std::string svg = contents(file("a.svg"));
  for (const std::string text : {"[action/length]", "[action time/rad]", "[action]"}) {
    EXPECT_NE(svg.find(text), std::string::npos) << text;
  }
}

TEST_F(FigureFile, WhatIsDrawnIsInTheLegend) {
  const Trajectory trajectory = wave(20);
  for (const View view : {View::kPlane, View::kSpace}) {
    SceneInfo info = scene_of(view);
    info.drawing.body_in_space = [](const double* q) {
      return std::vector<SpaceLine>{{{{q[0], q[1], q[2]}, {q[0], q[1], q[2] + 0.1}}}};
    };
    draw_silently(file("a.svg"), info, {curve_of(trajectory)});
    EXPECT_EQ(contents(file("a.svg")).find("a flag"), std::string::npos);
    info.drawing.glyph = "a flag";
    info.drawing.path = "its pole";
    draw_silently(file("a.svg"), info, {curve_of(trajectory)});
    const std::string svg = contents(file("a.svg"));
    EXPECT_NE(svg.find("a flag"), std::string::npos);
    EXPECT_NE(svg.find("path of its pole"), std::string::npos);
    EXPECT_EQ(svg.find("shadow") != std::string::npos, view == View::kSpace);
  }
}

TEST_F(FigureFile, APlaceMayBeDrawnInsteadOfCoordinates) {
  SceneInfo info = scene_of(View::kSpace);
  info.drawing.place = {{{{"X", "mile", 0}, {"Y", "mile", 0}, {"Z", "mile^2", 0}}},
                        [](const double* q) -> std::array<double, 3> {
                          return {std::cos(q[0]), std::sin(q[0]), 0};
                        }};
  for (const double sphere : {0.0, 1.0}) {
    info.drawing.sphere = sphere;
    const Trajectory trajectory = wave(40);
    draw_silently(file("a.svg"), info, {curve_of(trajectory)});
    const std::string svg = contents(file("a.svg"));
    EXPECT_NE(svg.find("X [mile]"), std::string::npos);
    EXPECT_EQ(svg.find("x [length]"), std::string::npos);
    EXPECT_EQ(svg.find("shadow") == std::string::npos, sphere > 0);
    draw_all(file("place"), trajectory);
  }
}

struct Found {
  Trajectory trajectory;
  double action = 2;
  std::optional<double> length;
  std::vector<std::pair<std::string, double>> extremes;
};

TEST_F(FigureFile, WhateverWasFoundBecomesCurves) {
  std::vector<Found> found(2);
  found[0].trajectory = found[1].trajectory = wave(10);
  found[1].length = 3;
  const std::vector<Curve> curves = curves_of(found);
  ASSERT_EQ(curves.size(), 2U);
  EXPECT_EQ(curves[1].name, "geodesic 2");
  EXPECT_EQ(curves[1].trajectory, &found[1].trajectory);
  EXPECT_EQ(curves[0].action, 2);
  EXPECT_FALSE(curves[0].length.has_value());
  EXPECT_EQ(curves[1].length, 3);
  draw_silently(file("a.svg"), plane_scene(), curves);
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
}  // namespace carnot::plots::figure_test
