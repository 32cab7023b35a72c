// Each scene against the picture it models: axles, attitudes, masses, drawn another way.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <limits>
#include <vector>

#include "testing/attitude.h"
#include "testing/charted_scenes.h"
#include "testing/distance.h"

namespace carnot::velocity_scene_models_test {
namespace {

using test::largest_change;

constexpr double kEps = std::numeric_limits<double>::epsilon();
constexpr double kRoundOff = 64 * kEps;  // sums of some ten products of numbers up to 5
constexpr int kSamples = 30;

// A number with its derivative along a path.
using Along = Jet<double, 1>;

// q + s v at s = 0.
template <int n>
Vector<Along, n> path(const Vector<double, n>& q, const Vector<double, n>& v) {
  Vector<Along, n> x;
  for (int i = 0; i < n; ++i) x[i] = Along(q[i], Vector<double, 1>(v[i]));
  return x;
}

template <int rows, int cols>
Matrix<double, rows, cols> values(const Matrix<Along, rows, cols>& m) {
  Matrix<double, rows, cols> a;
  for (int j = 0; j < cols; ++j) {
    for (int i = 0; i < rows; ++i) a(i, j) = m(i, j).a;
  }
  return a;
}
template <int rows, int cols>
Matrix<double, rows, cols> slopes(const Matrix<Along, rows, cols>& m) {
  Matrix<double, rows, cols> a;
  for (int j = 0; j < cols; ++j) {
    for (int i = 0; i < rows; ++i) a(i, j) = m(i, j).v[0];
  }
  return a;
}

// The middle of axle i, the car's being axle 0.
template <class T, int n>
Vector<T, 2> axle(const Vector<T, n>& q, int i) {
  using std::cos, std::sin;
  Vector<T, 2> place(q[0], q[1]);
  for (int j = 1; j <= i; ++j) {
    place[0] -= cos(q[2 + j]);
    place[1] -= sin(q[2 + j]);
  }
  return place;
}

template <int count>
void expect_trailers() {
  constexpr int n = 3 + count;
  const scenes::Trailers<count> scene{0.3};
  const SceneInfo info = scene.info();
  test::Generator generator(count);
  for (int sample = 0; sample < kSamples; ++sample) {
    const auto q = test::random_vector<n>(generator, 3);
    const Vector<double, n> any = test::random_vector<n>(generator);
    const Vector<double, n> v = product(scene.frame(q), test::random_vector<2>(generator));
    const Vector<double, 1 + count> g = product(scene.constraints(q), any);
    const auto lines = info.drawing.body(q.data());
    std::vector<Polyline> wheels;
    std::copy_if(lines.begin(), lines.end(), std::back_inserter(wheels), [](const auto& line) {
      return line.role == Polyline::Role::kWheel;
    });
    ASSERT_EQ(wheels.size(), 1U + count);
    EXPECT_EQ(lines.size(), 2U + 3 * count);  // a box and a wheel each, and rods between
    double largest_angle = 0;
    for (int i = 0; i <= count; ++i) {
      // Sideways: x' sin - y' cos. The rows of G measure it for any velocity, frames make it zero.
      const auto sideways = [&](const Vector<double, n>& velocity) {
        const Vector<double, 2> moved = slopes(axle(path(q, velocity), i));
        return moved[0] * std::sin(q[2 + i]) - moved[1] * std::cos(q[2 + i]);
      };
      EXPECT_NEAR(sideways(v), 0, kRoundOff);
      EXPECT_NEAR(sideways(any), g[i], kRoundOff);
      const Polyline& wheel = wheels[static_cast<std::size_t>(i)];
      const Vector<double, 2> place = axle(q, i);
      for (std::size_t j = 0; j < 2; ++j) {
        EXPECT_NEAR((wheel.points[0][j] + wheel.points[1][j]) / 2, place[j], kRoundOff);
      }
      if (i > 0) largest_angle = std::max(largest_angle, std::abs(q[1 + i] - q[2 + i]));
    }
    EXPECT_EQ(info.extremes.at(0).value(q.data()), largest_angle);
  }
  EXPECT_EQ(info.name, "trailer" + std::to_string(count));
}

TEST(TrailersTest, NoAxleSlipsAndEachIsDrawnInItsPlace) {
  expect_trailers<1>();
  expect_trailers<2>();
  expect_trailers<3>();
}

// The rate of the first n coordinates and momenta, the others without momentum.
template <int n, class Scene>
Vector<double, 2 * n> rate_of_first(const Scene& scene,
                                    const Vector<double, 6>& q,
                                    const Vector<double, n>& p) {
  const VelocityConstraints<Scene> system(scene);
  constexpr int kDof = Scene::kDof;
  const Vector<double, kDof> place = part<0, kDof>(q);
  Vector<double, kDof> momentum = filled<kDof>(0.0);
  store(p, momentum.data());
  Vector<double, 2> u;
  Rate<double, kDof> rate;
  EXPECT_EQ(system.rate(0.0, place, momentum, u, rate), RateStatus::kOk);
  for (int i = n; i < kDof; ++i) EXPECT_EQ(rate.p_dot[i], 0) << "momentum appears";
  Vector<double, 2 * n> first;
  store(part<0, n>(rate.q_dot), first.data());
  store(part<0, n>(rate.p_dot), first.data() + n);
  return first;
}

// Without weight and momentum trailers only follow: what pulls them does not feel them.
TEST(TrailersTest, WithoutMomentumTheyFollow) {
  test::Generator generator(8);
  for (int sample = 0; sample < kSamples; ++sample) {
    const auto q = test::random_vector<6>(generator, 3);
    const auto p = test::random_vector<4>(generator);
    const auto one = rate_of_first<4>(scenes::Trailers<1>{}, q, p);
    const auto two = rate_of_first<4>(scenes::Trailers<2>{}, q, p);
    const auto three = rate_of_first<4>(scenes::Trailers<3>{}, q, p);
    EXPECT_LE(largest_change(two, one), kRoundOff);
    EXPECT_LE(largest_change(three, one), kRoundOff);
    const Vector<double, 3> car = part<0, 3>(p);
    const auto alone = rate_of_first<3>(scenes::Unicycle{}, q, car);
    const auto pulling = rate_of_first<3>(scenes::Trailers<1>{}, q, car);
    EXPECT_LE(largest_change(pulling, alone), kRoundOff);
  }
}

TEST(SatelliteTest, BodyRatesAreThoseOfTheAttitude) {
  const auto scene = test::uneven_scene<scenes::Satellite>();
  test::Generator generator(4);
  for (int sample = 0; sample < kSamples; ++sample) {
    const auto q = test::random_vector<3>(generator, 3);
    const auto v = test::random_vector<3>(generator);
    const auto x = path(q, v);
    const auto r = test::attitude(x[0], x[1], x[2]);
    const Vector<double, 3> w = test::axis_of(transposed_times(values(r), slopes(r)));
    EXPECT_LE(largest_change(product(scene.body_rates(q), v), w), kRoundOff);
    EXPECT_NEAR(product(scene.constraints(q), v)(0), w[2], kRoundOff);
    const double cost = scene.j1 * w[0] * w[0] + scene.j2 * w[1] * w[1] + w[2] * w[2];
    EXPECT_NEAR(dot(v, product(scene.mass(q), v)), cost, kRoundOff);
  }
}

TEST(PlateBallTest, RollsWithoutSlipOrSpin) {
  const scenes::PlateBall scene;
  test::Generator generator(5);
  for (int sample = 0; sample < kSamples; ++sample) {
    const auto q = test::random_vector<5>(generator, 3);
    const auto v = test::random_vector<5>(generator);
    const auto x = path(q, v);
    const auto r = test::attitude(x[2], x[3], x[4]);
    const Vector<double, 3> w = test::axis_of(times_transposed(slopes(r), values(r)));
    // The lowest point of the ball, at -e_z from its centre, moves with c + w x (-e_z): in the
    // plane that is
    const Vector<double, 2> contact(v[0] - w[1], v[1] + w[0]);
    const Vector<double, 3> g = product(scene.constraints(q), v);
    EXPECT_NEAR(g[0], contact[1], kRoundOff);
    EXPECT_NEAR(g[1], -contact[0], kRoundOff);
    EXPECT_NEAR(g[2], w[2], kRoundOff);
  }
}

// The three centres of the links, about their common centre of mass.
template <class T>
std::array<Vector<T, 2>, 3> links(const Vector<T, 3>& q) {
  using std::cos, std::sin;
  const auto along = [](const T& heading) { return Vector<T, 2>(cos(heading), sin(heading)); };
  const Vector<T, 2> front = along(q[0]) + along(q[0] + q[1]);
  const Vector<T, 2> back = -along(q[0]) - along(q[0] + q[2]);
  const Vector<T, 2> centre = (front + back) / constant<T>(3);
  return {Vector<T, 2>(-centre), Vector<T, 2>(front - centre), Vector<T, 2>(back - centre)};
}

TEST(FallingCatTest, ConstraintIsTheAngularMomentum) {
  const scenes::FallingCat scene;
  constexpr double kInertia = 1.0 / 3;  // of a thin link of mass 1 and length 2
  test::Generator generator(6);
  for (int sample = 0; sample < kSamples; ++sample) {
    const auto q = test::random_vector<3>(generator, 3);
    const auto v = test::random_vector<3>(generator);
    const std::array turns{v[0], v[0] + v[1], v[0] + v[2]};
    const auto centres = links(path(q, v));
    double momentum = 0;
    for (std::size_t i = 0; i < 3; ++i) {
      const Vector<double, 2> r = values(centres[i]);
      const Vector<double, 2> moved = slopes(centres[i]);
      momentum += r[0] * moved[1] - r[1] * moved[0] + kInertia * turns[i];
    }
    EXPECT_NEAR(product(scene.constraints(q), v)(0), momentum, kRoundOff);
  }
}

TEST(FallingCatTest, IsDrawnAtItsShapeAboutItsCentreOfMass) {
  const auto body = scenes::FallingCat{}.info().drawing.body;
  const Vector<double, 3> q(0.4, 1.1, -0.7);
  const auto lines = body(q.data());
  ASSERT_EQ(lines.size(), 1U);
  const auto& points = lines[0].points;
  ASSERT_EQ(points.size(), 4U);
  const double half = std::hypot(points[1][0] - points[2][0], points[1][1] - points[2][1]) / 2;
  const auto centres = links(q);
  for (std::size_t link = 0; link < 3; ++link) {  // the drawing begins at the front
    const std::size_t drawn = link == 0 ? 1 : (link == 1 ? 0 : 2);
    for (std::size_t j = 0; j < 2; ++j) {
      const double middle = (points[drawn][j] + points[drawn + 1][j]) / 2;
      EXPECT_NEAR(middle, q[1 + static_cast<int>(j)] + half * centres[link][j], kRoundOff);
    }
  }
}

// [X, Y] = (DY) X - (DX) Y of the frame fields and their brackets.
TEST(EngelTest, FrameHasTheBracketsOfTheEngelAlgebra) {
  using V = Vector<double, 4>;
  const scenes::Engel scene;
  test::Generator generator(7);
  const auto field = [&](int i, const auto& q) {
    using T = typename std::decay_t<decltype(q)>::Scalar;
    const T zero = constant<T>(0);
    const T one = constant<T>(1);
    if (i <= 2) return Vector<T, 4>(scene.frame(q).col(i - 1));
    return i == 3 ? Vector<T, 4>(zero, zero, one, q[0]) : Vector<T, 4>(zero, zero, zero, one);
  };
  for (int sample = 0; sample < kSamples; ++sample) {
    const V q = test::random_vector<4>(generator, 2);
    const auto bracket = [&](int i, int j) -> V {
      V along = slopes(field(j, path<4>(q, field(i, q))));
      subtract_from(along, slopes(field(i, path<4>(q, field(j, q)))));
      return along;
    };
    EXPECT_LE(largest_change(bracket(1, 2), field(3, q)), kRoundOff);
    EXPECT_LE(largest_change(bracket(1, 3), field(4, q)), kRoundOff);
    for (const auto& [i, j] : {std::array{2, 3}, {1, 4}, {2, 4}, {3, 4}}) {
      EXPECT_LE(largest_entry(bracket(i, j)), kRoundOff) << i << " " << j;
    }
  }
}

}  // namespace
}  // namespace carnot::velocity_scene_models_test
