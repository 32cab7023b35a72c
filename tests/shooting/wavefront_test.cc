// Surfaces of the ends of extremals, against closed forms and against what surfaces have to be.
#include "carnot/shooting/wavefront.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <set>
#include <stdexcept>
#include <string>
#include <vector>

#include "carnot/load_scene.h"
#include "carnot/shooting/cut_time.h"
#include "shooting/problems.h"
#include "shooting/same_mesh.h"

namespace carnot::wavefront_test {
namespace {

using std::numbers::pi;
using ::testing::HasSubstr;
using ::testing::Not;

// Without a refinement: the first mesh is enough for what is tested.
FrontOptions coarse(FrontKind what, double length) {
  FrontOptions options;
  options.what = what;
  options.length = length;
  options.edge = 10;
  options.angle = 4;
  return options;
}

Dynamics heisenberg() { return test::heisenberg_group({0, 0, 0}).dynamics; }
Dynamics unicycle() { return test::unicycle({0, 0, 0}, {0, 0, 0}).dynamics; }

Dynamics grushin() { return test::grushin({0, 0}, {0, 0}).dynamics; }
// a x^2 + b y^2 + c z^2 + d w^2 = 1, an ellipsoid of three dimensions.
Dynamics ellipsoid(const std::vector<double>& coefficients) {
  const std::vector<double>& k = coefficients;
  return make_dynamics(load_scene(CARNOT_SOURCE_DIR "/docs/examples/scenes/ellipsoid.scene")
                           .with({{"a", k[0]}, {"b", k[1]}, {"c", k[2]}, {"d", k[3]}}));
}

// The end at time t on the Heisenberg group: the velocity turns by a = p_z t.
std::vector<double> heisenberg_end(const std::vector<double>& p, double t) {
  const double a = p[2] * t;
  const bool small = std::abs(a) < 1e-2;
  const double chord = small ? 1 - a * a / 24 + a * a * a * a / 1920 : 2 * std::sin(a / 2) / a;
  const double area =
      small ? a / 12 * (1 - a * a / 20 + a * a * a * a / 840) : (a - std::sin(a)) / (2 * a * a);
  const double c = std::cos(a / 2);
  const double s = std::sin(a / 2);
  return {t * chord * (p[0] * c - p[1] * s), t * chord * (p[0] * s + p[1] * c), t * t * area};
}

constexpr double kClosedForm = 1e-10;  // measured: 3e-13

void expect_closed_form(const FrontMesh& mesh, bool at_conjugate) {
  ASSERT_TRUE(mesh.finished);
  ASSERT_FALSE(mesh.triangles.empty());
  double worst = 0;
  for (const FrontVertex& vertex : mesh.vertices) {
    const double t = at_conjugate ? 2 * pi / std::abs(vertex.p0[2]) : mesh.length;
    const std::vector<double> expected = heisenberg_end(vertex.p0, t);
    for (int j = 0; j < 3; ++j) worst = std::max(worst, std::abs(vertex.q[j] - expected[j]));
    if (at_conjugate) worst = std::max(worst, std::abs(vertex.conjugate_time - t));
  }
  EXPECT_LT(worst, kClosedForm);
}

TEST(Wavefront, OfTheHeisenbergGroupIsThatOfTheClosedForm) {
  expect_closed_form(wavefront(heisenberg(), {0, 0, 0}, coarse(FrontKind::kFront, 1)), false);
  expect_closed_form(wavefront(heisenberg(), {0, 0, 0}, coarse(FrontKind::kSphere, 1)), false);
  expect_closed_form(wavefront(heisenberg(), {0, 0, 0}, coarse(FrontKind::kCaustic, 1)), true);
  expect_closed_form(wavefront(heisenberg(), {0, 0, 0}, coarse(FrontKind::kCut, 1)), true);
}

TEST(Wavefront, TheHeisenbergBallHasItsVolume) {
  FrontOptions options = coarse(FrontKind::kSphere, 1);
  options.edge = 0.1;
  options.angle = 0.35;
  const FrontMesh sphere = wavefront(heisenberg(), {0, 0, 0}, options);
  EXPECT_TRUE(sphere.closed);
  EXPECT_EQ(sphere.euler, 2);
  // A surface of revolution: the integral of pi r^2 dz along its profile.
  constexpr int kPieces = 20000;
  double expected = 0;
  std::vector<double> before = heisenberg_end({1, 0, -2 * pi}, 1);
  for (int i = 1; i <= kPieces; ++i) {
    const std::vector<double> end = heisenberg_end({1, 0, 2 * pi * (2.0 * i / kPieces - 1)}, 1);
    const double square =
        0.5 * (end[0] * end[0] + end[1] * end[1] + before[0] * before[0] + before[1] * before[1]);
    expected += pi * square * (end[2] - before[2]);
    before = end;
  }
  // The chords of an edge of length h are inside by h^2 / 8 of a radius of curvature.
  EXPECT_NEAR(sphere.volume, expected, 5e-3 * expected);
  EXPECT_LT(sphere.volume, expected);
}

void expect_sphere_of_se2(double length) {
  SCOPED_TRACE(length);
  const FrontMesh sphere = wavefront(unicycle(), {0, 0, 0}, coarse(FrontKind::kSphere, length));
  ASSERT_TRUE(sphere.finished);
  EXPECT_TRUE(sphere.closed);
  EXPECT_EQ(sphere.euler, 2);
  int on_seam = 0;
  for (const FrontVertex& vertex : sphere.vertices) {
    EXPECT_GE(vertex.cut_time, length * (1 - 1e-9));
    if (!is_maxwell(vertex.label)) continue;
    EXPECT_NEAR(vertex.cut_time, length, 1e-9);
    if (++on_seam % 40 != 0) continue;
    const CutTime cut = cut_time(unicycle(), {0, 0, 0}, vertex.p0);
    ASSERT_TRUE(cut.cut_time);
    EXPECT_NEAR(*cut.cut_time, length, 1e-8);
    const std::string expected = cut.label == "none" ? "maxwell" : "maxwell by " + cut.label;
    EXPECT_EQ(name_of(vertex.label), expected);
  }
  EXPECT_GT(on_seam, 40);
}

TEST(Wavefront, SpheresOfSE2AreClosedAndEndAtTheirCutTimes) {
  // A short one has partners that are neighbours all along its seam.
  for (const double length : {1.0, 2.0}) expect_sphere_of_se2(length);
}

TEST(Wavefront, SaysWhereASphereIsOpen) {
  // At the length 1 all are cut from 2 pi on.
  FrontOptions options = coarse(FrontKind::kSphere, 1);
  options.bound = 3;
  const FrontMesh open = wavefront(heisenberg(), {0, 0, 0}, options);
  EXPECT_FALSE(open.closed);
  EXPECT_THAT(open.message, HasSubstr("momenta beyond 3"));
  EXPECT_THAT(open.message, HasSubstr("open"));
  options.bound = 7;
  EXPECT_EQ(wavefront(heisenberg(), {0, 0, 0}, options).message, "");
}

// Of the extremal of unit speed with momentum p on SE(2): a pendulum with rho = |(p_x, p_y)|, whose
// cut time is 2 K(rho) for rho < 1 and 2 k p1(k), k = 1 / rho, for rho > 1, where p1(k) is the
// least positive zero of cn(p) (E(p) - p) - dn(p) sn(p) (Sachkov, ESAIM: COCV 16 (2010), 1018).
double se2_cut_time(const std::vector<double>& p) {
  const double rho = std::hypot(p[0], p[1]);
  if (rho < 1) return 2 * std::comp_ellint_1(rho);
  const double k = 1 / rho;
  const auto f = [&](double amplitude) {
    const double sn = std::sin(amplitude);
    return std::cos(amplitude) * (std::ellint_2(k, amplitude) - std::ellint_1(k, amplitude)) -
           std::sqrt(1 - k * k * sn * sn) * sn;
  };
  double low = 0.5 * pi;  // f < 0
  double high = pi;       // f > 0
  for (int i = 0; i < 60; ++i) {
    const double middle = 0.5 * (low + high);
    (f(middle) < 0 ? low : high) = middle;
  }
  return 2 * k * std::ellint_1(k, low);
}

// Far along the line partners are neighbours, and cut times nearly conjugate.
TEST(Wavefront, TheCutLocusOfSE2IsThatOfTheClosedForm) {
  const FrontMesh cut = wavefront(unicycle(), {0, 0, 0}, coarse(FrontKind::kCut, 4));
  ASSERT_TRUE(cut.finished);
  EXPECT_THAT(cut.message, HasSubstr("left out: momenta beyond"));
  EXPECT_GT(cut.vertices.size(), 1000U);
  double earliest = 4;
  for (const FrontVertex& vertex : cut.vertices) {
    // Partners that are nearer to each other than a thousandth are as good as one.
    const double tolerance = is_maxwell(vertex.label) ? 1e-9 : 1e-6;
    const double expected = se2_cut_time(vertex.p0);
    EXPECT_NEAR(vertex.cut_time, expected, tolerance * expected);
    earliest = std::min(earliest, vertex.cut_time);
  }
  EXPECT_LT(earliest, 0.51);
}

// In the Grushin plane from the origin, p = (c, w) with c = 1 or -1: x = c sin(w t) / w and
// y = t / (2 w) - sin(2 w t) / (4 w^2) (Agrachev, Barilari & Boscain 2019, sec. 13.2); conjugate
// where tan(w t) = w t, cut on the y axis at pi / |w|.
std::vector<double> grushin_end(double c, double w, double t) {
  if (std::abs(w) * t < 1e-2) {
    const double a = w * t;
    return {c * t * (1 - a * a / 6 + std::pow(a, 4) / 120),
            t * t * a / 3 * (1 - a * a / 5 + 2 * std::pow(a, 4) / 105)};
  }
  return {c * std::sin(w * t) / w, t / (2 * w) - std::sin(2 * w * t) / (4 * w * w)};
}

TEST(Wavefront, ACausticHasCutTimesWhereTheyAreAskedFor) {
  FrontOptions options = coarse(FrontKind::kCaustic, 3);
  options.edge = 2;
  const FrontMesh plain = wavefront(unicycle(), {0, 0, 0}, options);
  options.times = true;
  const FrontMesh caustic = wavefront(unicycle(), {0, 0, 0}, options);
  test::expect_the_same(caustic, plain);
  ASSERT_FALSE(caustic.vertices.empty());
  for (std::size_t i = 0; i < caustic.vertices.size(); ++i) {
    const FrontVertex& vertex = caustic.vertices[i];
    const double expected = se2_cut_time(vertex.p0);
    EXPECT_TRUE(std::isnan(plain.vertices[i].cut_time));
    EXPECT_EQ(vertex.conjugate_time, plain.vertices[i].conjugate_time);
    EXPECT_NEAR(vertex.cut_time, expected, 1e-6 * expected);
  }
}

TEST(Wavefront, OfTheGrushinPlaneIsACurve) {
  for (const FrontKind what : {FrontKind::kFront, FrontKind::kCaustic, FrontKind::kSphere}) {
    FrontOptions options = coarse(what, 2);
    if (what == FrontKind::kSphere) options.edge = 0.1;
    const FrontMesh mesh = wavefront(grushin(), {0, 0}, options);
    ASSERT_TRUE(mesh.finished);
    EXPECT_TRUE(mesh.triangles.empty());
    ASSERT_GT(mesh.segments.size(), 10U);
    double worst = 0;
    for (const FrontVertex& v : mesh.vertices) {
      const double t = what == FrontKind::kCaustic ? v.conjugate_time : mesh.length;
      const double a = v.p0[1] * t;
      if (what == FrontKind::kCaustic) worst = std::max(worst, std::abs(std::tan(a) / a - 1) / a);
      if (what == FrontKind::kSphere) {
        EXPECT_LE(std::abs(a), pi * (1 + 1e-9));
      }
      const std::vector<double> end = grushin_end(v.p0[0], v.p0[1], t);
      worst = std::max({worst, std::abs(v.q[0] - end[0]), std::abs(v.q[1] - end[1])});
    }
    EXPECT_LT(worst, kClosedForm);
    if (what != FrontKind::kSphere) continue;
    EXPECT_TRUE(mesh.closed);
    EXPECT_EQ(mesh.euler, 0);
    // Twice the integral of 2 x dy over half the sphere.
    constexpr int kPieces = 4000;
    double area = 0;
    std::vector<double> before = grushin_end(1, 0, 2);
    for (int i = 1; i <= kPieces; ++i) {
      const std::vector<double> end = grushin_end(1, pi / 2 * i / kPieces, 2);
      area += 2 * (end[0] + before[0]) * (end[1] - before[1]);
      before = end;
    }
    EXPECT_NEAR(mesh.volume, area, 5e-3 * area);
    EXPECT_LT(mesh.volume, area);
  }
}

TEST(Wavefront, OfARegularPointOfThePlaneIsAClosedCurve) {
  FrontOptions options = coarse(FrontKind::kFront, 0.5);
  options.edge = 0.05;
  const FrontMesh mesh = wavefront(grushin(), {1, 0}, options);
  ASSERT_TRUE(mesh.finished);
  EXPECT_EQ(mesh.vertices.size(), mesh.segments.size());
  EXPECT_GT(mesh.segments.size(), 48U);  // it was refined
  EXPECT_EQ(mesh.message, "");           // nothing is left out
}

// On the Heisenberg group det X vanishes where sin(a / 2) (sin(a / 2) - a / 2 cos(a / 2)) does,
// a = p_z t: at 2 pi, at the first root of tan(a / 2) = a / 2, and at 4 pi.
TEST(Wavefront, ConjugateTimesHaveAnOrder) {
  const double roots[] = {2 * pi, 8.986818915818129, 4 * pi};
  for (const int order : {2, 3}) {
    FrontOptions options = coarse(FrontKind::kCaustic, 1);
    options.order = order;
    const FrontMesh mesh = wavefront(heisenberg(), {0, 0, 0}, options);
    ASSERT_TRUE(mesh.finished);
    ASSERT_FALSE(mesh.triangles.empty());
    double worst = 0;
    for (const FrontVertex& v : mesh.vertices) {
      worst =
          std::max(worst, std::abs(v.conjugate_time * std::abs(v.p0[2]) / roots[order - 1] - 1));
    }
    EXPECT_LT(worst, 1e-11) << order;
  }
}

// The antipode of a point of the round sphere is conjugate twice, which a sign of det X does not
// tell.
TEST(Wavefront, SeesEvenMultiplicities) {
  const Dynamics round = ellipsoid({1, 1, 1, 1});
  const std::vector<double> from{0.5, 0.5, 0.5, 0.5};
  for (const int order : {1, 2}) {
    FrontOptions options = coarse(FrontKind::kCaustic, 3.5);
    options.order = order;
    options.fixed = {{3, 0.0}};
    const FrontMesh mesh = wavefront(round, from, options);
    ASSERT_TRUE(mesh.finished);
    ASSERT_GT(mesh.vertices.size(), 1000U);
    double worst = 0;
    for (const FrontVertex& v : mesh.vertices) {
      worst = std::max(worst, std::abs(v.conjugate_time - pi));
      for (int j = 0; j < 4; ++j) {
        worst = std::max(worst, std::abs(v.q[j] + from[j]));
      }
    }
    EXPECT_LT(worst, 1e-11) << order;
  }
}

// Of a general point of an ellipsoid with different axes, four hyperbolic umbilics (Offen &
// Ober-Bloebaum 2021). Both sheets that meet there lead to the same ones. On each of them one cusp
// line is closed, and two lead from one umbilic to another: those of both sheets together close.
TEST(Wavefront, TheEllipsoidHasFourHyperbolicUmbilics) {
  // Its half axes are 1, 1.2, 1.5 and 1.9.
  const Dynamics dynamics = ellipsoid({1, 1 / 1.44, 1 / 2.25, 1 / 3.61});
  constexpr double kSame = 1e-10;
  std::vector<std::vector<double>> first;
  std::array<std::array<int, 4>, 2> across{};  // of each sheet: the umbilic at the other end
  for (const int order : {1, 2}) {
    FrontOptions options = coarse(FrontKind::kCaustic, 12);
    options.fixed = {{3, 0.0}};
    options.cusps = true;
    options.order = order;
    const FrontMesh mesh = wavefront(dynamics, {0.5, 0.6, 0.75, 0.95}, options);
    ASSERT_TRUE(mesh.finished);
    ASSERT_EQ(mesh.umbilics.size(), 4U);
    for (const FrontVertex& v : mesh.umbilics) EXPECT_EQ(v.label, FrontLabel::kHyperbolicUmbilic);
    EXPECT_EQ(mesh.cusps.size(), 3U);
    EXPECT_EQ(
        std::count_if(
            mesh.cusps.begin(), mesh.cusps.end(), [](const CuspEdge& edge) { return edge.closed; }),
        1);
    if (order == 1) {
      for (const FrontVertex& v : mesh.umbilics) first.push_back(v.q);
    }
    // The place among the umbilics of the first sheet.
    const auto place = [&](int umbilic) {
      const std::vector<double>& q = mesh.umbilics[umbilic].q;
      const auto found = std::find_if(first.begin(), first.end(), [&](const auto& other) {
        double apart = 0;
        for (int j = 0; j < 4; ++j) apart = std::max(apart, std::abs(q[j] - other[j]));
        return apart < kSame;
      });
      EXPECT_NE(found, first.end());
      return static_cast<int>(found - first.begin());
    };
    auto& other_end = across[order - 1];
    other_end.fill(-1);
    for (const CuspEdge& edge : mesh.cusps) {
      if (edge.closed) continue;
      ASSERT_GE(edge.first_umbilic, 0);
      ASSERT_GE(edge.last_umbilic, 0);
      EXPECT_EQ(edge.points.front().q, mesh.umbilics[edge.first_umbilic].q);
      EXPECT_EQ(edge.points.back().q, mesh.umbilics[edge.last_umbilic].q);
      const int a = place(edge.first_umbilic);
      const int b = place(edge.last_umbilic);
      other_end[a] = b;
      other_end[b] = a;
    }
  }
  // From sheet to sheet, all four are passed before the line closes.
  std::set<int> passed;
  int at = 0;
  for (int i = 0; i < 4; ++i) {
    passed.insert(at);
    at = across[i % 2][at];
    ASSERT_GE(at, 0);
  }
  EXPECT_EQ(at, 0);
  EXPECT_EQ(passed.size(), 4U);
}

// Offen & Ober-Bloebaum (arXiv:2107.13853) have ten steps of a variational method of order 2, and
// single precision. So their umbilics are a little beside.
TEST(Wavefront, TheUmbilicsOfAnArticleAreFound) {
  constexpr double kTenSteps = 0.006;
  FrontOptions options = coarse(FrontKind::kCaustic, 6);
  options.fixed = {{3, 0.0}};
  options.cusps = true;
  const std::vector<double> from{0.1, 0.05, 0.2, std::sqrt(0.924)};
  const FrontMesh mesh = wavefront(ellipsoid({0.9, 1.2, 1.6, 1}), from, options);
  ASSERT_EQ(mesh.umbilics.size(), 4U);
  const std::vector<std::array<double, 3>> published{{-0.41641262, -0.05142419, 0.04059413},
                                                     {-0.4125571, -0.04061218, -0.3533893},
                                                     {0.2442697, -0.04175623, -0.3565497},
                                                     {0.22954877, -0.05261957, 0.03806705}};
  for (const std::array<double, 3>& place : published) {
    double nearest = 1;
    for (const FrontVertex& umbilic : mesh.umbilics) {
      double apart = 0;
      for (int j = 0; j < 3; ++j) apart = std::max(apart, std::abs(umbilic.q[j] - place[j]));
      nearest = std::min(nearest, apart);
    }
    EXPECT_LT(nearest, kTenSteps);
  }
}

// Behind a lens of two bumps. There a cusp line, seen in space, turns back; it is the same place on
// a finer mesh.
TEST(Wavefront, SwallowtailsAreWhereCuspLinesTurnBack) {
  constexpr double kSame = 1e-6;
  const Dynamics dynamics = make_dynamics(scene_from_text(R"(coordinates x, y, z [length]
let near = exp(-1.2 (x - 1.4)^2 - 1.9 (y - 0.2)^2 - 1.5 (z + 0.6)^2)
let far = exp(-1.6 (x - 1.8)^2 - 0.7 (y - 0.3)^2 - 1.1 (z - 0.6)^2)
kinetic = (1 + 1.7 near + 2 far) (x'^2 + y'^2 + z'^2) / 2
)"));
  std::vector<std::vector<double>> found;
  for (const double longest : {0.5, 0.3}) {
    FrontOptions options;
    options.what = FrontKind::kCaustic;
    options.length = 6;
    options.edge = longest;
    options.cusps = true;
    const FrontMesh mesh = wavefront(dynamics, {0, 0, 0}, options);
    ASSERT_TRUE(mesh.finished);
    ASSERT_EQ(mesh.swallowtails.size(), 1U);
    const FrontVertex& tail = mesh.swallowtails[0];
    EXPECT_EQ(tail.label, FrontLabel::kSwallowtail);
    found.push_back(tail.q);
    // The cosine of the turn of the line at its point that is nearest.
    double nearest = std::numeric_limits<double>::infinity();
    double cosine = 1;
    for (const CuspEdge& edge : mesh.cusps) {
      for (std::size_t i = 1; i + 1 < edge.points.size(); ++i) {
        double away = 0;
        double before = 0;
        double after = 0;
        double along = 0;
        for (int j = 0; j < 3; ++j) {
          const double p = edge.points[i].p0[j] - tail.p0[j];
          const double a = edge.points[i].q[j] - edge.points[i - 1].q[j];
          const double b = edge.points[i + 1].q[j] - edge.points[i].q[j];
          away += p * p;
          before += a * a;
          after += b * b;
          along += a * b;
        }
        if (away >= nearest) continue;
        nearest = away;
        cosine = along / std::sqrt(before * after);
      }
    }
    EXPECT_LT(cosine, -0.9);
  }
  for (int j = 0; j < 3; ++j) EXPECT_NEAR(found[0][j], found[1][j], kSame);
}

TEST(Wavefront, IsRefinedUntilEdgesAreShort) {
  FrontOptions options = coarse(FrontKind::kFront, 1);
  options.edge = 0.05;
  const FrontMesh mesh = wavefront(heisenberg(), {0, 0, 0}, options);
  std::vector<double> low(3, 1e9), high(3, -1e9);
  // Widths are those of the first mesh, which has the extremes of x and z but for its own edges.
  for (const FrontVertex& vertex : mesh.vertices) {
    for (int j = 0; j < 3; ++j) {
      low[j] = std::min(low[j], vertex.q[j]);
      high[j] = std::max(high[j], vertex.q[j]);
    }
  }
  double longest = 0;
  for (const auto& t : mesh.triangles) {
    for (int k = 0; k < 3; ++k) {
      const auto& a = mesh.vertices[t[k]].q;
      const auto& b = mesh.vertices[t[(k + 1) % 3]].q;
      double sum = 0;
      for (int j = 0; j < 3; ++j) sum += std::pow((a[j] - b[j]) / (high[j] - low[j]), 2);
      longest = std::max(longest, std::sqrt(sum));
    }
  }
  EXPECT_LE(longest, 1.001 * options.edge);
  EXPECT_THAT(mesh.message, HasSubstr("left out"));
  options.most = 1600;
  EXPECT_THAT(wavefront(heisenberg(), {0, 0, 0}, options).message, HasSubstr("more vertices"));
}

// At y = 0 the line along x is an abnormal minimiser.
TEST(Wavefront, SaysWhereAbnormalCurvesStart) {
  const Dynamics martinet = test::martinet({0, 0, 0}).dynamics;
  const FrontOptions options = coarse(FrontKind::kFront, 0.5);
  EXPECT_THAT(wavefront(martinet, {0, 0, 0}, options).message, HasSubstr("abnormal curves"));
  EXPECT_THAT(wavefront(martinet, {0, 0.5, 0}, options).message, Not(HasSubstr("abnormal")));
}

// Nothing of its caustic was within the bound that is taken where nothing is known.
TEST(Wavefront, HasACausticBesideAnAbnormalCurve) {
  const Dynamics martinet = test::martinet({0, 0, 0}).dynamics;
  const FrontMesh mesh = wavefront(martinet, {0, 0, 0}, coarse(FrontKind::kCaustic, 1));
  EXPECT_GT(mesh.triangles.size(), 100U);
  EXPECT_THAT(mesh.message, HasSubstr("half of the times are below 0.5"));
}

TEST(Wavefront, IsTheSameForAnyNumberOfThreads) {
  for (const FrontKind what : {FrontKind::kCaustic, FrontKind::kSphere}) {
    FrontOptions options = coarse(what, 1);
    options.edge = 0.3;
    options.threads = 1;
    const FrontMesh one = wavefront(heisenberg(), {0, 0, 0}, options);
    options.threads = 3;
    const FrontMesh three = wavefront(heisenberg(), {0, 0, 0}, options);
    test::expect_the_same(one, three);
  }
}

TEST(Wavefront, IsASectionWhereMomentaAreFixed) {
  const Dynamics engel = test::engel({0, 0, 0, 0}).dynamics;
  FrontOptions options = coarse(FrontKind::kFront, 1);
  options.fixed = {{3, 0.7}};
  options.project = {0, 1, 3};
  const FrontMesh mesh = wavefront(engel, {0, 0, 0, 0}, options);
  ASSERT_TRUE(mesh.finished);
  for (const FrontVertex& vertex : mesh.vertices) {
    EXPECT_NEAR(vertex.p0[3], 0.7, 1e-14);
    EXPECT_NEAR(std::hypot(vertex.p0[0], vertex.p0[1]), 1, 1e-14);
  }
}

// theta = phi at the end of every extremal. The front of the vehicle is the same after a turn of
// the plane, and after a reversal: (x, y, theta, phi) and (-x, -y, theta, phi) are ends together.
TEST(Wavefront, IsASectionWhereEndsAreToldToAgree) {
  constexpr double kRoundOff = 1e-10;
  const Dynamics vehicle = test::vehicle({0, 0, 0, 0}, {0, 0, 0, 0}).dynamics;
  FrontOptions options;
  options.what = FrontKind::kFront;
  options.edge = 1;
  options.angle = 4;
  options.section = EndCondition{2, 3, 0};
  const FrontMesh mesh = wavefront(vehicle, {0, 0, 0, 0}, options);
  ASSERT_TRUE(mesh.finished);
  EXPECT_THAT(mesh.message, HasSubstr("conjugate at the length 1"));
  double widest = 0;
  for (const FrontVertex& vertex : mesh.vertices) {
    EXPECT_NEAR(vertex.q[2], vertex.q[3], kRoundOff);
    EXPECT_NEAR(std::hypot(vertex.p0[0], vertex.p0[3]), 1, 1e-13);
    widest = std::max(widest, std::abs(vertex.q[0]));
  }
  EXPECT_NEAR(widest, 1, 1e-3);  // straight on
  const auto has_end_near = [&](const std::vector<double>& q) {
    return std::any_of(mesh.vertices.begin(), mesh.vertices.end(), [&](const FrontVertex& vertex) {
      double square = 0;
      for (int j = 0; j < 4; ++j) square += (vertex.q[j] - q[j]) * (vertex.q[j] - q[j]);
      return square < 0.1 * 0.1;
    });
  };
  for (std::size_t i = 0; i < mesh.vertices.size(); i += 40) {
    const std::vector<double>& q = mesh.vertices[i].q;
    EXPECT_TRUE(has_end_near({q[0], -q[1], -q[2], -q[3]})) << i;
  }
}

TEST(Wavefront, SeesWhatASectionDoesNotTell) {
  const Dynamics engel = test::engel({0, 0, 0, 0}).dynamics;
  FrontOptions options;
  EXPECT_EQ(seen_coordinates(engel, options), (std::vector{0, 1, 2}));
  options.section = EndCondition{1, -1, 0};
  EXPECT_EQ(seen_coordinates(engel, options), (std::vector{0, 2, 3}));
  options.section = EndCondition{0, 2, 0};
  EXPECT_EQ(seen_coordinates(engel, options), (std::vector{0, 1, 3}));
  options.project = {3, 2, 1};
  EXPECT_EQ(seen_coordinates(engel, options), (std::vector{3, 2, 1}));
  EXPECT_EQ(seen_coordinates(grushin(), {}), (std::vector{0, 1}));
}

TEST(Wavefront, RefusesWhatHasNoSurface) {
  const std::vector<double> origin{0, 0, 0};
  const auto refused = [](const Dynamics& dynamics, const std::vector<double>& from, auto change) {
    FrontOptions options = coarse(FrontKind::kFront, 1);
    change(options);
    EXPECT_THROW((void)wavefront(dynamics, from, options), std::invalid_argument);
  };
  const auto nothing = [](FrontOptions&) {};
  refused(test::engel({0, 0, 0, 0}).dynamics, {0, 0, 0, 0}, nothing);  // a momentum is to be fixed
  refused(test::satellite_quaternion({1, 0, 0, 0}).dynamics, {1, 0, 0, 0}, nothing);
  refused(unicycle(), {0, 0}, nothing);
  refused(unicycle(), origin, [](FrontOptions& o) { o.length = 0; });
  refused(unicycle(), origin, [](FrontOptions& o) { o.edge = 0; });
  refused(unicycle(), origin, [](FrontOptions& o) { o.bound = -1; });
  refused(unicycle(), origin, [](FrontOptions& o) { o.project = {0, 1}; });
  refused(unicycle(), origin, [](FrontOptions& o) { o.project = {0, 1, 3}; });
  refused(unicycle(), origin, [](FrontOptions& o) { o.fixed = {{1, 0.0}}; });
  refused(unicycle(), origin, [](FrontOptions& o) { o.order = 2; });
  refused(unicycle(), origin, [](FrontOptions& o) { o.cusps = true; });
  refused(grushin(), {0, 0}, [](FrontOptions& o) { o.project = {0, 1, 1}; });
  refused(unicycle(), origin, [](FrontOptions& o) { o.section = EndCondition{2, -1, 0}; });
  const auto with_section = [&](const EndCondition& end, FrontKind what = FrontKind::kFront) {
    refused(test::engel({0, 0, 0, 0}).dynamics, {0, 0, 0, 0}, [&](FrontOptions& o) {
      o.section = end;
      o.what = what;
    });
  };
  with_section({4, -1, 0});
  with_section({0, 4, 0});
  with_section({1, 1, 0});
  with_section({1, -1, std::numeric_limits<double>::infinity()});
  with_section({1, -1, 0}, FrontKind::kCaustic);
  with_section({1, -1, 0}, FrontKind::kCut);
  refused(unicycle(), origin, [](FrontOptions& o) {
    o.what = FrontKind::kSphere;
    o.section = EndCondition{2, -1, 0};
  });
  FrontOptions stopped = coarse(FrontKind::kCut, 1);
  stopped.progress = [](double) { return false; };
  EXPECT_FALSE(wavefront(unicycle(), origin, stopped).finished);
}

}  // namespace
}  // namespace carnot::wavefront_test
