// The midpoint transcription through the calls behind a Dynamics.
#include "carnot/transcription/midpoint_transcription.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <vector>

#include "carnot/step/gauss.h"
#include "carnot/system/system_of.h"
#include "carnot/transcription/transcription_calls.h"
#include "testing/control_scene_list.h"
#include "testing/runs.h"

namespace carnot::midpoint_transcription_test {
namespace {

constexpr double kEps = std::numeric_limits<double>::epsilon();
// Central differences of fourth order with step 1e-3: truncation and round-off below 1e-11, times
// fifth derivatives up to 100.
constexpr double kStep = 1e-3;
constexpr double kDifferences = 1e-9;

// Controls with a weight that depends on the place.
struct WeightedBrockett {
  static constexpr int kDof = 3;
  static constexpr int kControls = 2;

  template <class T>
  [[nodiscard]] Matrix<T, 3, 2> frame(const Vector<T, 3>& q) const {
    return scenes::Brockett{}.frame(q);
  }
  template <class T>
  [[nodiscard]] Matrix<T, 2, 2> control_weight(const Vector<T, 3>& q) const {
    Matrix<T, 2, 2> weight;
    weight << q[2] * q[2] + constant<T>(1), constant<T>(0.3), constant<T>(0.3),
        q[0] * q[0] + constant<T>(2);
    return weight;
  }
  [[nodiscard]] SceneInfo info() const {
    SceneInfo info = scenes::Brockett{}.info();
    info.name = "weighted-brockett";
    return info;
  }
};

// What a Dynamics points to, without its methods, which are slow to compile.
template <class Scene>
struct Calls {
  using System = decltype(make_system(Scene{}));
  static constexpr int n = Scene::kDof;
  System system = make_system(test::uneven<Scene>());
  static const Calls& from(const void* opaque) { return *static_cast<const Calls*>(opaque); }

  bool midpoint(const double* qm, const double* v, double* terms, double* jacobian) const {
    return midpoint_terms(functions(), this, qm, v, terms, jacobian);
  }
  void discrete_lagrangian(double h, const double* x, double* gradient, double* hessian) const {
    carnot::discrete_lagrangian(functions(), this, h, x, gradient, hessian);
  }
  static const TranscriptionFunctions& functions() {
    return dynamics_calls::transcription_of<Calls>();
  }
};

template <class Scene>
class MidpointTest : public ::testing::Test {
 protected:
  // What is transcribed: the system itself, or a control problem without its controls.
  using System = std::decay_t<decltype(dynamics_calls::transcription(make_system(Scene{})))>;
  static constexpr int kDof = Scene::kDof;
  static constexpr int kMultipliers = System::kMultipliers;
  static constexpr int kTerms = kDof + kMultipliers + 1;
  static constexpr int kUnknowns = 2 * kDof + kMultipliers;
  using Unknowns = Vector<double, kUnknowns>;

  const System system_ = dynamics_calls::transcription(make_system(test::uneven<Scene>()));
  const Calls<Scene> calls_{};
  test::Generator generator_{1};

  [[nodiscard]] Vector<double, kTerms> terms(const Vector<double, 2 * kDof>& x) const {
    Vector<double, kTerms> out;
    EXPECT_TRUE(calls_.midpoint(x.data(), x.data() + kDof, out.data(), nullptr));
    return out;
  }
  [[nodiscard]] Unknowns gradient(double h, const Unknowns& x) const {
    Unknowns out;
    calls_.discrete_lagrangian(h, x.data(), out.data(), nullptr);
    return out;
  }
};
using MidpointScenes = ::testing::Types<scenes::VehicleCosine, scenes::HeisenbergGroup>;
TYPED_TEST_SUITE(MidpointTest, MidpointScenes, test::SceneNames);

template <class Scene>
class MidpointDerivativesTest : public MidpointTest<Scene> {};
// One with a potential, one whose mass is singular, one with controls. The other scenes of the
// program are compared with their texts, in tests/verification/text_twins_test.cc.
using DerivativeScenes =
    ::testing::Types<scenes::VehicleCosine, scenes::HeisenbergGroup, WeightedBrockett>;
TYPED_TEST_SUITE(MidpointDerivativesTest, DerivativeScenes, test::SceneNames);

// Derivative of a vector function along unit vector i.
template <class F, class X>
auto difference(const F& f, const X& x, int i) {
  const auto at = [&](double d) {
    X shifted = x;
    shifted[i] += d;
    return f(shifted);
  };
  return ((8 * (at(kStep) - at(-kStep)) - (at(2 * kStep) - at(-2 * kStep))) / (12 * kStep)).eval();
}

TYPED_TEST(MidpointDerivativesTest, JacobianAgreesWithDifferences) {
  constexpr int kColumns = 2 * TypeParam::kDof;
  constexpr int kRows = TestFixture::kTerms;
  using RowMajor = Eigen::Matrix<double, kRows, kColumns, Eigen::RowMajor>;
  for (int sample = 0; sample < 20; ++sample) {
    const auto x = test::random_vector<kColumns>(this->generator_);
    Vector<double, kRows> values;
    RowMajor jacobian;
    ASSERT_TRUE(this->calls_.midpoint(
        x.data(), x.data() + TypeParam::kDof, values.data(), jacobian.data()));
    EXPECT_LE((values - this->terms(x)).cwiseAbs().maxCoeff(), 64 * kEps);
    for (int i = 0; i < kColumns; ++i) {
      const auto column = difference([&](const auto& y) { return this->terms(y); }, x, i);
      EXPECT_LE((column - jacobian.col(i)).cwiseAbs().maxCoeff(), kDifferences);
    }
  }
}

// |r|^2 = v'M v where G v = 0; c = G v; the last term is V.
TYPED_TEST(MidpointTest, TermsMakeTheLagrangian) {
  constexpr int n = TypeParam::kDof;
  constexpr int k = TestFixture::kMultipliers;
  for (int sample = 0; sample < 20; ++sample) {
    auto x = test::random_vector<2 * n>(this->generator_, 2);
    const Vector<double, n> q = x.template head<n>();
    Vector<double, n> v = x.template tail<n>();
    const Vector<double, k> g = this->system_.constraint(q, v);
    EXPECT_LE((this->terms(x).template segment<k>(n) - g).cwiseAbs().maxCoeff(), 16 * kEps);
    ASSERT_EQ(this->system_.project(q, v), RateStatus::kOk);
    x.template tail<n>() = v;
    const auto terms = this->terms(x);
    const double lagrangian =
        0.5 * terms.template head<n>().squaredNorm() - terms[TestFixture::kTerms - 1];
    EXPECT_NEAR(lagrangian, this->system_.lagrangian(q, v), 256 * kEps);
  }
}

// The gradient against F_d itself.
TYPED_TEST(MidpointDerivativesTest, GradientAgreesWithDifferences) {
  constexpr int kSize = TestFixture::kUnknowns;
  constexpr int n = TypeParam::kDof;
  constexpr int k = TestFixture::kMultipliers;
  constexpr double h = 0.5;
  const auto discrete = [&](const auto& x) {
    const Vector<double, n> q = 0.5 * (x.template head<n>() + x.template segment<n>(n));
    const Vector<double, n> v = (x.template segment<n>(n) - x.template head<n>()) / h;
    const Vector<double, k> lambda = x.template tail<k>();
    double value = this->system_.lagrangian(q, v) - lambda.dot(this->system_.constraint(q, v));
    if constexpr (dynamics_calls::HasGauge<std::decay_t<decltype(this->system_.scene())>>) {
      value -= 0.5 * lambda.dot(this->system_.scene().gauge(q) * lambda);
    }
    return Vector<double, 1>(Vector<double, 1>::Constant(h * value));
  };
  for (int sample = 0; sample < 10; ++sample) {
    const auto x = test::random_vector<kSize>(this->generator_);
    const auto slope = this->gradient(h, x);
    for (int i = 0; i < kSize; ++i) {
      EXPECT_NEAR(slope[i], difference(discrete, x, i)[0], kDifferences);
    }
  }
}

// The Hessian against the gradient.
TYPED_TEST(MidpointDerivativesTest, HessianAgreesWithDifferencesAndIsSymmetric) {
  constexpr int kSize = TestFixture::kUnknowns;
  constexpr double h = 0.5;
  using Square = Matrix<double, kSize, kSize>;
  for (int sample = 0; sample < 10; ++sample) {
    const auto x = test::random_vector<kSize>(this->generator_);
    Vector<double, kSize> slope;
    Square hessian;
    this->calls_.discrete_lagrangian(h, x.data(), slope.data(), hessian.data());
    const double scale = std::max(1.0, hessian.cwiseAbs().maxCoeff());
    EXPECT_LE((slope - this->gradient(h, x)).cwiseAbs().maxCoeff(), 64 * kEps * scale);
    EXPECT_LE((hessian - hessian.transpose()).cwiseAbs().maxCoeff(), 64 * kEps * scale);
    for (int i = 0; i < kSize; ++i) {
      const auto column = difference([&](const auto& y) { return this->gradient(h, y); }, x, i);
      EXPECT_LE((column - hessian.col(i)).cwiseAbs().maxCoeff(), kDifferences * scale);
    }
  }
}

// d F_d / d lambda = -h (g(qm, v) + P lambda): the constraints of the transcription.
TYPED_TEST(MidpointDerivativesTest, DerivativeByTheMultipliersIsTheConstraint) {
  constexpr int n = TypeParam::kDof;
  constexpr int k = TestFixture::kMultipliers;
  constexpr double h = 0.5;
  const auto x = test::random_vector<TestFixture::kUnknowns>(this->generator_);
  const Vector<double, n> q0 = x.template head<n>();
  const Vector<double, n> q1 = x.template segment<n>(n);
  const Vector<double, n> qm = 0.5 * (q0 + q1);
  const Vector<double, n> v = (q1 - q0) / h;
  Vector<double, k> g = this->system_.constraint(qm, v);
  if constexpr (dynamics_calls::HasGauge<std::decay_t<decltype(this->system_.scene())>>) {
    g += this->system_.scene().gauge(qm) * x.template tail<k>();
  }
  EXPECT_LE((this->gradient(h, x).template tail<k>() + h * g).cwiseAbs().maxCoeff(), 64 * kEps);
}

// A step of the midpoint rule (Gauss, s = 1) is a stationary interval: p0 = -D1 F_d and
// p1 = D2 F_d with the multipliers of the midpoint, to round-off.
TYPED_TEST(MidpointTest, MidpointRuleIsTheDiscreteLegendreTransform) {
  constexpr int n = TypeParam::kDof;
  constexpr int k = TestFixture::kMultipliers;
  using Step = Gauss<VelocityConstraints<TypeParam>, 1>;
  for (const double h : {0.3, 0.05}) {
    // v = (q1 - q0) / h magnifies the rounding of q by 1 / h.
    const double tolerance = 32 * kEps / h;
    for (int sample = 0; sample < 20; ++sample) {
      Step step(this->system_);
      const auto before = test::random_state<n>(this->generator_);
      auto after = before;
      ASSERT_EQ(step.step(0, h, after).status, StepStatus::kOk);
      const Vector<double, n> qm = step.stages().template topRows<n>();
      const Vector<double, n> pm = step.stages().template bottomRows<n>();
      const Vector<double, n> v = step.increments().template topRows<n>() / h;
      Vector<double, k> lambda;
      ASSERT_EQ(this->system_.multipliers(qm, pm, v, lambda), RateStatus::kOk);
      Vector<double, 2 * n + k> x;
      x << before.value.template head<n>(), after.value.template head<n>(), lambda;
      const auto gradient = this->gradient(h, x);
      const Vector<double, n> p0 = -gradient.template head<n>();
      const Vector<double, n> p1 = gradient.template segment<n>(n);
      EXPECT_LE((p0 - before.value.template tail<n>()).cwiseAbs().maxCoeff(), tolerance);
      EXPECT_LE((p1 - after.value.template tail<n>()).cwiseAbs().maxCoeff(), tolerance);
      EXPECT_LE(gradient.template tail<k>().cwiseAbs().maxCoeff(), tolerance);
    }
  }
}

// Rows of every length, by a Lagrangian of n separate coordinates and one constraint:
// M = diag(2 + sin q_i), G = (cos q_j), V = |q|^2/2.
template <int n>
struct Separate {
  static void entries(
      const void* /*system*/, const double* q, const GaugeUnits&, bool slopes, double* out) {
    const auto write = [&](double value, int direction, double slope) {
      out[0] = value;
      if (slopes) {
        std::fill_n(out + 1, row_length(n) - 1, 0.0);
        if (direction >= 0) out[1 + direction] = slope;
      }
      out += slopes ? row_length(n) : 1;
    };
    double potential = 0;
    for (int i = 0; i < n; ++i) {
      potential += q[i] * q[i] / 2;
      for (int j = 0; j < i; ++j) write(0, -1, 0);
      write(2 + std::sin(q[i]), i, std::cos(q[i]));
    }
    for (int j = 0; j < n; ++j) write(std::cos(q[j]), j, -std::sin(q[j]));
    double* const last = out;
    write(potential, -1, 0);
    for (int j = 0; slopes && j < n; ++j) last[1 + j] = q[j];
  }
  static void hessian(const void* /*system*/,
                      const double* q,
                      const double* v,
                      const double* lambda,
                      const GaugeUnits&,
                      double* l_qq) {
    std::fill_n(l_qq, n * n, 0.0);
    for (int i = 0; i < n; ++i) {
      l_qq[i * n + i] = -std::sin(q[i]) * v[i] * v[i] / 2 - 1 + lambda[0] * std::cos(q[i]) * v[i];
    }
  }
  static constexpr TranscriptionFunctions kFunctions = {n, 1, false, entries, hessian};
};

// Numbers of kTranscriptionLanes intervals side by side, `count` of each.
using Packed = std::vector<double>;
Packed packed(int count) { return Packed(static_cast<std::size_t>(count) * kTranscriptionLanes); }
std::vector<double> lane(const Packed& from, int l) {
  std::vector<double> own;
  for (std::size_t i = l; i < from.size(); i += kTranscriptionLanes) own.push_back(from[i]);
  return own;
}
// The packed sine and cosine are good to 2 ulp, and sums are contracted in another way; that is
// enlarged by the condition of M and of F'F, which is up to a hundred.
constexpr double kPackedRoundOff = 1000 * kEps;
void expect_same(const std::vector<double>& a, const std::vector<double>& b) {
  ASSERT_EQ(a.size(), b.size());
  double size = 1;
  for (const double x : b) size = std::max(size, std::abs(x));
  for (std::size_t i = 0; i < a.size(); ++i) EXPECT_NEAR(a[i], b[i], kPackedRoundOff * size);
}

// Eight intervals side by side against one by one. An angle for which packs have no sine is in one
// of them, in every second sample.
TYPED_TEST(MidpointDerivativesTest, SideBySideIsOneByOne) {
  constexpr int n = TypeParam::kDof;
  constexpr int kCount = TestFixture::kTerms;
  constexpr int m = TestFixture::kUnknowns;
  constexpr double kFar = 4e6;
  constexpr double h = 0.3;
  const TranscriptionFunctions& f = this->calls_.functions();
  ASSERT_NE(f.packed_entries, nullptr);
  for (int sample = 0; sample < 10; ++sample) {
    Packed x = packed(m);
    for (int l = 0; l < kTranscriptionLanes; ++l) {
      const auto own = test::random_vector<m>(this->generator_);
      for (int i = 0; i < m; ++i) x[i * kTranscriptionLanes + l] = own[i];
    }
    if (sample % 2 == 1) {
      // Both ends of interval 5, of the last coordinate.
      x[(n - 1) * kTranscriptionLanes + 5] += kFar;
      x[(2 * n - 1) * kTranscriptionLanes + 5] += kFar;
    }
    const double* const v = x.data() + n * kTranscriptionLanes;
    Packed terms = packed(kCount), slopes = packed(kCount * 2 * n), again = packed(kCount);
    Packed gradient = packed(m), hessian = packed(m * m), first = packed(m);
    ASSERT_TRUE(packed_midpoint_terms(f, &this->calls_, x.data(), v, terms.data(), slopes.data()));
    ASSERT_TRUE(packed_midpoint_terms(f, &this->calls_, x.data(), v, again.data(), nullptr));
    packed_discrete_lagrangian(f, &this->calls_, h, x.data(), gradient.data(), hessian.data());
    packed_discrete_lagrangian(f, &this->calls_, h, x.data(), first.data(), nullptr);
    for (int l = 0; l < kTranscriptionLanes; ++l) {
      const std::vector<double> own = lane(x, l);
      std::vector<double> a(kCount), b(kCount * 2 * n), c(m), d(m * m);
      ASSERT_TRUE(this->calls_.midpoint(own.data(), own.data() + n, a.data(), b.data()));
      expect_same(lane(terms, l), a);
      expect_same(lane(again, l), a);
      expect_same(lane(slopes, l), b);
      this->calls_.discrete_lagrangian(h, own.data(), c.data(), d.data());
      expect_same(lane(gradient, l), c);
      expect_same(lane(first, l), c);
      expect_same(lane(hessian, l), d);
    }
  }
}

// One interval that cannot be evaluated is told, and the others are right all the same.
TYPED_TEST(MidpointDerivativesTest, OneFailureSideBySideDoesNotSpoilTheOthers) {
  constexpr int n = TypeParam::kDof;
  constexpr int kCount = TestFixture::kTerms;
  constexpr int kBroken = 3;
  Packed x = packed(2 * n);
  for (double& number : x) number = std::uniform_real_distribution<double>(-1, 1)(this->generator_);
  for (int j = 0; j < n; ++j) {
    x[j * kTranscriptionLanes + kBroken] = std::numeric_limits<double>::quiet_NaN();
  }
  Packed terms = packed(kCount);
  const double* const v = x.data() + n * kTranscriptionLanes;
  const bool good = packed_midpoint_terms(
      this->calls_.functions(), &this->calls_, x.data(), v, terms.data(), nullptr);
  for (int l = 0; l < kTranscriptionLanes; ++l) {
    const std::vector<double> own = lane(x, l);
    std::vector<double> a(kCount);
    const bool found = this->calls_.midpoint(own.data(), own.data() + n, a.data(), nullptr);
    if (l == kBroken) {
      EXPECT_EQ(good, found);
      continue;
    }
    ASSERT_TRUE(found);
    expect_same(lane(terms, l), a);
  }
}

// A scene that has no formulas for packs, and one with more coordinates than packs are made for.
template <int n>
void expect_one_by_one() {
  constexpr int kTerms = n + 2;
  constexpr int m = 2 * n + 1;
  const TranscriptionFunctions& f = Separate<n>::kFunctions;
  test::Generator generator(n);
  Packed x = packed(m);
  for (double& number : x) number = std::uniform_real_distribution<double>(-1, 1)(generator);
  Packed terms = packed(kTerms), slopes = packed(kTerms * 2 * n), gradient = packed(m);
  const double* const v = x.data() + n * kTranscriptionLanes;
  ASSERT_TRUE(packed_midpoint_terms(f, nullptr, x.data(), v, terms.data(), slopes.data()));
  packed_discrete_lagrangian(f, nullptr, 0.5, x.data(), gradient.data(), nullptr);
  for (int l = 0; l < kTranscriptionLanes; ++l) {
    const std::vector<double> own = lane(x, l);
    std::vector<double> a(kTerms), b(kTerms * 2 * n), c(m);
    ASSERT_TRUE(midpoint_terms(f, nullptr, own.data(), own.data() + n, a.data(), b.data()));
    EXPECT_EQ(lane(terms, l), a);
    EXPECT_EQ(lane(slopes, l), b);
    discrete_lagrangian(f, nullptr, 0.5, own.data(), c.data(), nullptr);
    EXPECT_EQ(lane(gradient, l), c);
  }
}
TEST(MidpointRows, WithoutPacksAreOneByOne) {
  expect_one_by_one<7>();
  expect_one_by_one<16>();
}

template <int n>
void expect_exact_derivatives() {
  constexpr int kTerms = n + 2;
  constexpr int kUnknowns = 2 * n + 1;
  constexpr double h = 0.5;
  const TranscriptionFunctions& functions = Separate<n>::kFunctions;
  test::Generator generator(n);
  const Vector<double, 2 * n> at = test::random_vector<2 * n>(generator);
  const auto terms = [&](const Vector<double, 2 * n>& y) {
    Vector<double, kTerms> out;
    EXPECT_TRUE(midpoint_terms(functions, nullptr, y.data(), y.data() + n, out.data(), nullptr));
    return out;
  };
  Vector<double, kTerms> values;
  Eigen::Matrix<double, kTerms, 2 * n, Eigen::RowMajor> jacobian;
  ASSERT_TRUE(
      midpoint_terms(functions, nullptr, at.data(), at.data() + n, values.data(), jacobian.data()));
  EXPECT_LE((values - terms(at)).cwiseAbs().maxCoeff(), 64 * kEps);
  for (int i = 0; i < 2 * n; ++i) {
    EXPECT_LE((difference(terms, at, i) - jacobian.col(i)).cwiseAbs().maxCoeff(), kDifferences);
  }
  using Unknowns = Vector<double, kUnknowns>;
  const auto gradient = [&](const Unknowns& y) {
    Unknowns out;
    discrete_lagrangian(functions, nullptr, h, y.data(), out.data(), nullptr);
    return out;
  };
  const Unknowns x = test::random_vector<kUnknowns>(generator);
  Unknowns slope;
  Matrix<double, kUnknowns, kUnknowns> hessian;
  discrete_lagrangian(functions, nullptr, h, x.data(), slope.data(), hessian.data());
  EXPECT_LE((slope - gradient(x)).cwiseAbs().maxCoeff(), 64 * kEps);
  for (int i = 0; i < kUnknowns; ++i) {
    EXPECT_LE((difference(gradient, x, i) - hessian.col(i)).cwiseAbs().maxCoeff(), kDifferences);
  }
}

TEST(MidpointRows, OfEveryLengthHaveExactDerivatives) {
  expect_exact_derivatives<7>();   // 8
  expect_exact_derivatives<8>();   // 16
  expect_exact_derivatives<16>();  // 64
}

}  // namespace
}  // namespace carnot::midpoint_transcription_test
