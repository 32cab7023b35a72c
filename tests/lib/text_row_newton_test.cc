// Algebraic variables at eight points side by side: what Newton's method finds one by one.
#include "carnot/language/text_row_newton.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <limits>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "carnot/load_scene.h"
#include "carnot/make_dynamics.h"
#include "carnot/scenes/appell.h"
#include "testing/random_points.h"

namespace carnot::text_row_newton_test {
namespace {

constexpr int kLanes = kErasedLanes;
constexpr double kEps = std::numeric_limits<double>::epsilon();
// Both end with a step below 8 eps, and condition numbers of H_yy are below 100 at these points.
constexpr double kRoundOff = 1024 * kEps;

Dynamics scene(const std::string& name) {
  return make_dynamics(
      load_scene(std::string(CARNOT_SOURCE_DIR) + "/lib/carnot/scenes/" + name + ".scene"));
}

struct Rows {
  std::vector<double> t = std::vector<double>(kLanes, 0.3);
  std::vector<double> z;
  std::vector<double> y;
};

class Subject {
 public:
  explicit Subject(Dynamics dynamics) : dynamics_(std::move(dynamics)) {}

  [[nodiscard]] int dof() const { return dynamics_.dof; }
  [[nodiscard]] int algebraic() const { return dynamics_.functions->algebraic; }

  // Of a point alone; y is warm, or cold where it is zero.
  RateStatus rate(std::vector<double> z, std::vector<double>& y, std::vector<double>& rate) const {
    rate.assign(z.size(), 0.0);
    return dynamics_.functions->rate(dynamics_.system.get(), 0.3, z.data(), y.data(), rate.data());
  }

  // Whether eight points side by side have the y and the rates that each has alone.
  void expect_each_as_alone(Rows rows) const {
    const Rows before = rows;
    std::vector<double> rates(rows.z.size());
    ASSERT_TRUE(dynamics_.functions->rates(
        dynamics_.system.get(), rows.t.data(), rows.z.data(), rows.y.data(), rates.data()));
    for (int l = 0; l < kLanes; ++l) {
      std::vector<double> y = lane(before.y, l);
      std::vector<double> expected;
      ASSERT_EQ(rate(lane(before.z, l), y, expected), RateStatus::kOk) << l;
      expect_near(lane(rows.y, l), y);
      expect_near(lane(rates, l), expected);
    }
  }

  [[nodiscard]] bool rates_exist(Rows rows) const {
    std::vector<double> rates(rows.z.size());
    return dynamics_.functions->rates(
        dynamics_.system.get(), rows.t.data(), rows.z.data(), rows.y.data(), rates.data());
  }

  static std::vector<double> lane(const std::vector<double>& rows, int l) {
    std::vector<double> x;
    for (std::size_t k = l; k < rows.size(); k += kLanes) x.push_back(rows[k]);
    return x;
  }

 private:
  static void expect_near(const std::vector<double>& x, const std::vector<double>& expected) {
    double size = 0;
    for (const double e : expected) size = std::max(size, std::abs(e));
    for (std::size_t k = 0; k < x.size(); ++k) {
      EXPECT_NEAR(x[k], expected[k], kRoundOff * size) << k;
    }
  }

  Dynamics dynamics_;
};

void put(const std::vector<double>& x, int l, std::vector<double>& rows) {
  rows.resize(x.size() * kLanes);
  for (std::size_t k = 0; k < x.size(); ++k) rows[k * kLanes + l] = x[k];
}

// Points with q of size 1 and momenta of size `momentum` about `centre`, and the y found at momenta
// that are `away` of their size off.
Rows random_rows(const Subject& subject,
                 test::Generator& generator,
                 double momentum,
                 double away,
                 const std::vector<double>& centre) {
  std::uniform_real_distribution<double> uniform(-1, 1);
  Rows rows;
  for (int l = 0; l < kLanes;) {
    std::vector<double> z(static_cast<std::size_t>(2 * subject.dof()));
    for (double& x : z) x = uniform(generator);
    for (int j = 0; j < subject.dof(); ++j) {
      z[subject.dof() + j] = momentum * (z[subject.dof() + j] + centre[j]);
    }
    std::vector<double> near = z;
    for (int j = 0; j < subject.dof(); ++j)
      near[subject.dof() + j] *= 1 + away * uniform(generator);
    std::vector<double> y(static_cast<std::size_t>(subject.algebraic()), 0.0);
    std::vector<double> rate;
    if (subject.rate(near, y, rate) != RateStatus::kOk) continue;
    put(z, l, rows.z);
    put(y, l, rows.y);
    ++l;
  }
  return rows;
}

struct Case {
  std::string name;
  std::vector<double> centre;  // momenta far from where H_yy is singular
};

class TextRowNewton : public ::testing::TestWithParam<Case> {};

TEST_P(TextRowNewton, WarmLanesAreAsAlone) {
  const Subject subject(scene(GetParam().name));
  test::Generator generator(1);
  for (const double away : {1e-14, 1e-6, 0.01, 0.3}) {
    for (int sample = 0; sample < 20; ++sample) {
      subject.expect_each_as_alone(random_rows(subject, generator, 1, away, GetParam().centre));
    }
  }
}

TEST_P(TextRowNewton, ColdLanesBesideWarmOnesAreAsAlone) {
  const Subject subject(scene(GetParam().name));
  test::Generator generator(2);
  for (int cold = 1; cold < 1 << kLanes; cold += 18) {
    Rows rows = random_rows(subject, generator, 1, 0.1, GetParam().centre);
    for (std::size_t k = 0; k < rows.y.size(); ++k) {
      if ((cold >> (k % kLanes) & 1) != 0) rows.y[k] = 0;
    }
    subject.expect_each_as_alone(rows);
  }
}

INSTANTIATE_TEST_SUITE_P(Scenes,
                         TextRowNewton,
                         ::testing::Values(Case{"appell", {2, 0, 2}},
                                           Case{"boat", {2, 1}},
                                           Case{"relativistic-particle", {0, 0, 0}}),
                         [](const auto& subject) {
                           std::string name = subject.param.name;
                           std::erase(name, '-');
                           return name;
                         });

// The branch s = -1 of Appell's constraint, which no cold start finds where p_z > 0, from the
// branch at other momenta: near ones, where whole steps do, and far ones, where they are shortened.
TEST(TextRowNewtonBranch, IsKept) {
  const Subject subject(scene("appell"));
  const scenes::Appell closed;
  test::Generator generator(3);
  std::uniform_real_distribution<double> uniform(-1, 1);
  for (const double away : {0.01, 0.3, 0.8}) {
    Rows rows;
    std::vector<double> expected;
    for (int l = 0; l < kLanes; ++l) {
      const auto momentum = [&](double by) {
        return Vector<double, 3>(2 + by * uniform(generator),
                                 1 + by * uniform(generator),
                                 0.3 + 0.2 * by * uniform(generator));
      };
      const auto solution = [&](const Vector<double, 3>& p) {
        const double horizontal = std::hypot(p[0], p[1]);
        const double w = (horizontal - p[2]) / 2;
        return std::vector<double>{
            w * p[0] / horizontal, w * p[1] / horizontal, -w, closed.multiplier(p, -1)};
      };
      const Vector<double, 3> p = momentum(away);
      put({0, 0, 0, p[0], p[1], p[2]}, l, rows.z);
      put(solution(momentum(away)), l, rows.y);
      expected.push_back(closed.multiplier(p, -1));
    }
    subject.expect_each_as_alone(rows);
    std::vector<double> rates(rows.z.size());
    const Dynamics dynamics = scene("appell");
    ASSERT_TRUE(dynamics.functions->rates(
        dynamics.system.get(), rows.t.data(), rows.z.data(), rows.y.data(), rates.data()));
    for (int l = 0; l < kLanes; ++l) {
      EXPECT_NEAR(rows.y[3 * kLanes + l], expected[l], kRoundOff * std::abs(expected[l])) << l;
    }
  }
}

TEST(TextRowNewtonFailure, OneLaneWithoutASolutionIsEnough) {
  const Subject subject(scene("appell"));
  test::Generator generator(4);
  for (int bad = 0; bad < kLanes; ++bad) {
    for (const double momentum :
         {std::numeric_limits<double>::infinity(), std::numeric_limits<double>::quiet_NaN()}) {
      Rows rows = random_rows(subject, generator, 1, 0.01, {2, 0, 2});
      ASSERT_TRUE(subject.rates_exist(rows));
      for (int j = 3; j < 6; ++j) rows.z[j * kLanes + bad] = momentum;
      EXPECT_FALSE(subject.rates_exist(rows));
    }
  }
}

// More algebraic variables than fit side by side are solved for one by one.
TEST(TextRowNewtonSize, AsMuchAsThereIs) {
  for (const int n : {8, 9}) {
    std::string names;
    std::string terms;
    for (int i = 1; i <= n; ++i) {
      const std::string q = "q" + std::to_string(i);
      names += (i > 1 ? ", " : "") + q;
      terms += (i > 1 ? " + " : "") + q + "'^2 / 2 + " + q + "'^4 / 4 - " + q + "^2 / 2";
    }
    const Subject subject(
        make_dynamics(scene_from_text("coordinates " + names + "\nlagrangian = " + terms + "\n")));
    ASSERT_EQ(subject.algebraic(), n);
    test::Generator generator(5);
    subject.expect_each_as_alone(
        random_rows(subject, generator, 1, 0.3, std::vector<double>(static_cast<std::size_t>(n))));
  }
}

// Where factors without pivots lose their digits, they say so.
TEST(RowFactor, KnowsItsLanes) {
  using language::RowFactor;
  using P = RowFactor::P;
  RowFactor::Square a;
  std::array<double, kLanes> corner{
      1, 0, 1e-20, -2, 4, 4 + 1e-12, 5, std::numeric_limits<double>::quiet_NaN()};
  a[0][0] = P::load(corner.data());
  a[0][1] = a[1][0] = P(2.0);
  a[1][1] = P(1.0);
  RowFactor factor;
  factor.factor(a, 2);
  std::array<double, kLanes> regular;
  std::array<double, kLanes> determinant;
  factor.regular().store(regular.data());
  factor.determinant().store(determinant.data());
  for (int l = 0; l < kLanes; ++l) {
    // 1 - 4 / corner loses all digits where the corner is 4.
    const bool sound = corner[l] != 0 && std::abs(corner[l] - 4) > 1e-6;
    EXPECT_EQ(regular[l], sound ? 1 : 0) << l;
    if (!sound) continue;
    EXPECT_NEAR(determinant[l], corner[l] - 4, 16 * kEps) << l;
  }
  RowFactor::Column right;
  right[0] = P(3.0);
  right[1] = P(-1.0);
  const RowFactor::Column x = factor.solve(right);
  std::array<double, kLanes> first;
  x[0].store(first.data());
  for (const int l : {0, 3, 6}) EXPECT_NEAR(first[l], 5 / (corner[l] - 4), 64 * kEps) << l;
}

}  // namespace
}  // namespace carnot::text_row_newton_test
