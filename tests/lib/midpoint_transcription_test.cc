// The midpoint transcription through the calls behind a Dynamics.
#include "carnot/transcription/midpoint_transcription.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <random>
#include <vector>

#include "carnot/step/gauss.h"
#include "carnot/system/system_of.h"
#include "carnot/transcription/transcription_calls.h"
#include "testing/control_scene_list.h"
#include "testing/distance.h"
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
};

// The transcription of one interval, for vectors of any length.
using Numbers = std::vector<double>;
struct Transcription {
  const TranscriptionFunctions& functions;
  const void* system = nullptr;

  [[nodiscard]] int dof() const { return functions.dof; }
  [[nodiscard]] int term_count() const { return dof() + functions.constraints + 1; }
  [[nodiscard]] int unknowns() const { return 2 * dof() + functions.constraints; }

  // At x = (qm, v); with the Jacobian where one is given, row by row.
  Numbers terms(const Numbers& x, Numbers* jacobian = nullptr) const {
    Numbers out(term_count());
    if (jacobian) jacobian->resize(out.size() * 2 * dof());
    EXPECT_TRUE(midpoint_terms(functions,
                               system,
                               x.data(),
                               x.data() + dof(),
                               out.data(),
                               jacobian ? jacobian->data() : nullptr));
    return out;
  }
  Numbers gradient(double h, const Numbers& x, Numbers* hessian = nullptr) const {
    Numbers out(unknowns());
    if (hessian) hessian->resize(out.size() * out.size());
    discrete_lagrangian(
        functions, system, h, x.data(), out.data(), hessian ? hessian->data() : nullptr);
    return out;
  }
};

// Uniform in [-scale, scale].
Numbers random_numbers(int count, test::Generator& generator, double scale = 1) {
  std::uniform_real_distribution<double> uniform(-scale, scale);
  Numbers numbers(count);
  for (double& number : numbers) number = uniform(generator);
  return numbers;
}

// Derivative of a vector function along unit vector i.
Numbers difference(const std::function<Numbers(const Numbers&)>& f, const Numbers& x, int i) {
  const auto at = [&](double d) {
    Numbers shifted = x;
    shifted[i] += d;
    return f(shifted);
  };
  const Numbers right = at(kStep), left = at(-kStep);
  const Numbers far_right = at(2 * kStep), far_left = at(-2 * kStep);
  Numbers slope(right.size());
  for (std::size_t k = 0; k < slope.size(); ++k) {
    slope[k] = (8 * (right[k] - left[k]) - (far_right[k] - far_left[k])) / (12 * kStep);
  }
  return slope;
}

// Every stride-th number from the first on.
Numbers part(const Numbers& all, int first, int count, int stride = 1) {
  Numbers some(count);
  for (int k = 0; k < count; ++k) some[k] = all[first + k * stride];
  return some;
}

double size(const Numbers& x) { return test::largest_change(x, Numbers(x.size())); }

void expect_exact_jacobian(const Transcription& transcription, const Numbers& x) {
  const int columns = 2 * transcription.dof();
  Numbers jacobian;
  const Numbers values = transcription.terms(x, &jacobian);
  EXPECT_LE(test::largest_change(values, transcription.terms(x)), 64 * kEps);
  const auto terms = [&](const Numbers& y) { return transcription.terms(y); };
  for (int i = 0; i < columns; ++i) {
    const Numbers column = part(jacobian, i, transcription.term_count(), columns);
    EXPECT_LE(test::largest_change(difference(terms, x, i), column), kDifferences);
  }
}

// The Hessian against the gradient, and against its transpose.
void expect_exact_hessian(const Transcription& transcription, double h, const Numbers& x) {
  const int m = transcription.unknowns();
  Numbers hessian;
  const Numbers slope = transcription.gradient(h, x, &hessian);
  EXPECT_LE(test::largest_change(slope, transcription.gradient(h, x)), 64 * kEps);
  const auto gradient = [&](const Numbers& y) { return transcription.gradient(h, y); };
  for (int i = 0; i < m; ++i) {
    const Numbers column = part(hessian, i * m, m);
    EXPECT_LE(test::largest_change(column, part(hessian, i, m, m)), 64 * kEps);
    EXPECT_LE(test::largest_change(difference(gradient, x, i), column), kDifferences);
  }
}

template <class Scene>
class MidpointTest : public ::testing::Test {
 protected:
  // What is transcribed: the system itself, or a control problem without its controls.
  using System = std::decay_t<decltype(dynamics_calls::transcription(make_system(Scene{})))>;
  static constexpr int kDof = Scene::kDof;
  static constexpr int kMultipliers = System::kMultipliers;

  const System system_ = dynamics_calls::transcription(make_system(test::uneven<Scene>()));
  const Calls<Scene> calls_{};
  const Transcription transcription_{dynamics_calls::transcription_of<Calls<Scene>>(), &calls_};
  test::Generator generator_{1};

  // P lambda, which is zero without a gauge.
  [[nodiscard]] Vector<double, kMultipliers> gauge_force(
      const Vector<double, kDof>& q, const Vector<double, kMultipliers>& lambda) const {
    if constexpr (dynamics_calls::HasGauge<std::decay_t<decltype(system_.scene())>>) {
      return product(system_.scene().gauge(q), lambda);
    } else {
      return filled<kMultipliers>(0.0);
    }
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

TYPED_TEST(MidpointDerivativesTest, JacobianAgreesWithDifferences) {
  for (int sample = 0; sample < 20; ++sample) {
    expect_exact_jacobian(this->transcription_,
                          random_numbers(2 * TypeParam::kDof, this->generator_));
  }
}

// |r|^2 = v'M v where G v = 0; c = G v; the last term is V.
TYPED_TEST(MidpointTest, TermsMakeTheLagrangian) {
  constexpr int n = TypeParam::kDof;
  for (int sample = 0; sample < 20; ++sample) {
    Numbers x = random_numbers(2 * n, this->generator_, 2);
    const Vector<double, n> q = vector_at<n>(x.data());
    Vector<double, n> v = vector_at<n>(x.data() + n);
    const auto g = this->system_.constraint(q, v);
    Numbers terms = this->transcription_.terms(x);
    for (int j = 0; j < g.size(); ++j) EXPECT_NEAR(terms[n + j], g[j], 16 * kEps);
    ASSERT_EQ(this->system_.project(q, v), RateStatus::kOk);
    store(v, x.data() + n);
    terms = this->transcription_.terms(x);
    double lagrangian = -terms.back();
    for (int j = 0; j < n; ++j) lagrangian += 0.5 * terms[j] * terms[j];
    EXPECT_NEAR(lagrangian, this->system_.lagrangian(q, v), 256 * kEps);
  }
}

// The gradient against F_d itself.
TYPED_TEST(MidpointDerivativesTest, GradientAgreesWithDifferences) {
  constexpr int n = TypeParam::kDof;
  constexpr int k = TestFixture::kMultipliers;
  constexpr double h = 0.5;
  const auto discrete = [&](const Numbers& x) {
    Vector<double, n> q, v;
    for (int j = 0; j < n; ++j) {
      q[j] = 0.5 * (x[j] + x[n + j]);
      v[j] = (x[n + j] - x[j]) / h;
    }
    const Vector<double, k> lambda = vector_at<k>(x.data() + 2 * n);
    const double value = this->system_.lagrangian(q, v) -
                         dot<double, k>(lambda, this->system_.constraint(q, v)) -
                         0.5 * dot<double, k>(lambda, this->gauge_force(q, lambda));
    return Numbers{h * value};
  };
  for (int sample = 0; sample < 10; ++sample) {
    const Numbers x = random_numbers(2 * n + k, this->generator_);
    const Numbers slope = this->transcription_.gradient(h, x);
    for (std::size_t i = 0; i < slope.size(); ++i) {
      EXPECT_NEAR(slope[i], difference(discrete, x, static_cast<int>(i))[0], kDifferences);
    }
  }
}

TYPED_TEST(MidpointDerivativesTest, HessianAgreesWithDifferencesAndIsSymmetric) {
  for (int sample = 0; sample < 10; ++sample) {
    expect_exact_hessian(this->transcription_,
                         0.5,
                         random_numbers(this->transcription_.unknowns(), this->generator_));
  }
}

// d F_d / d lambda = -h (g(qm, v) + P lambda): the constraints of the transcription.
TYPED_TEST(MidpointDerivativesTest, DerivativeByTheMultipliersIsTheConstraint) {
  constexpr int n = TypeParam::kDof;
  constexpr int k = TestFixture::kMultipliers;
  constexpr double h = 0.5;
  const Numbers x = random_numbers(2 * n + k, this->generator_);
  Vector<double, n> qm, v;
  for (int j = 0; j < n; ++j) {
    qm[j] = 0.5 * (x[j] + x[n + j]);
    v[j] = (x[n + j] - x[j]) / h;
  }
  const Vector<double, k> g = this->system_.constraint(qm, v);
  const Vector<double, k> force = this->gauge_force(qm, vector_at<k>(x.data() + 2 * n));
  const Numbers gradient = this->transcription_.gradient(h, x);
  for (int j = 0; j < k; ++j) {
    EXPECT_NEAR(gradient[2 * n + j], -h * (g[j] + force[j]), 64 * kEps);
  }
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
      Vector<double, n> qm, pm, v;
      for (int j = 0; j < n; ++j) {
        qm[j] = step.stages()(j, 0);
        pm[j] = step.stages()(n + j, 0);
        v[j] = step.increments()(j, 0) / h;
      }
      auto lambda = filled<k>(0.0);
      ASSERT_EQ(this->system_.multipliers(qm, pm, v, lambda), RateStatus::kOk);
      Numbers x(2 * n + k);
      std::copy_n(before.value.data(), n, x.data());
      std::copy_n(after.value.data(), n, x.data() + n);
      store(lambda, x.data() + 2 * n);
      const Numbers gradient = this->transcription_.gradient(h, x);
      for (int j = 0; j < n; ++j) {
        EXPECT_NEAR(-gradient[j], before.value[n + j], tolerance);
        EXPECT_NEAR(gradient[n + j], after.value[n + j], tolerance);
      }
      EXPECT_LE(size(part(gradient, 2 * n, k)), tolerance);
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
using Packed = Numbers;
Packed packed(int count) { return Packed(static_cast<std::size_t>(count) * kTranscriptionLanes); }
Numbers lane(const Packed& from, int l) {
  Numbers own;
  for (std::size_t i = l; i < from.size(); i += kTranscriptionLanes) own.push_back(from[i]);
  return own;
}
// The packed sine and cosine are good to 2 ulp, and sums are contracted in another way; that is
// enlarged by the condition of M and of F'F, which is up to a hundred.
constexpr double kPackedRoundOff = 1000 * kEps;
void expect_same(const Numbers& a, const Numbers& b) {
  ASSERT_EQ(a.size(), b.size());
  const double tolerance = kPackedRoundOff * std::max(1.0, size(b));
  for (std::size_t i = 0; i < a.size(); ++i) EXPECT_NEAR(a[i], b[i], tolerance);
}

// Eight intervals side by side against one by one. If the last coordinate is an angle, one for
// which packs have no sine is in one of them, in every second sample.
void expect_side_by_side(const Transcription& one, bool last_is_angle, test::Generator& generator) {
  constexpr double kFar = 4e6;
  constexpr double h = 0.3;
  const int n = one.dof(), count = one.term_count(), m = one.unknowns();
  const TranscriptionFunctions& f = one.functions;
  ASSERT_NE(f.packed_entries, nullptr);
  for (int sample = 0; sample < 10; ++sample) {
    Packed x = packed(m);
    for (int l = 0; l < kTranscriptionLanes; ++l) {
      const Numbers own = random_numbers(m, generator);
      for (int i = 0; i < m; ++i) x[i * kTranscriptionLanes + l] = own[i];
    }
    if (last_is_angle && sample % 2 == 1) {
      // Both ends of interval 5.
      x[(n - 1) * kTranscriptionLanes + 5] += kFar;
      x[(2 * n - 1) * kTranscriptionLanes + 5] += kFar;
    }
    const double* const v = x.data() + n * kTranscriptionLanes;
    Packed terms = packed(count), slopes = packed(count * 2 * n), again = packed(count);
    Packed gradient = packed(m), hessian = packed(m * m), first = packed(m);
    ASSERT_TRUE(packed_midpoint_terms(f, one.system, x.data(), v, terms.data(), slopes.data()));
    ASSERT_TRUE(packed_midpoint_terms(f, one.system, x.data(), v, again.data(), nullptr));
    packed_discrete_lagrangian(f, one.system, h, x.data(), gradient.data(), hessian.data());
    packed_discrete_lagrangian(f, one.system, h, x.data(), first.data(), nullptr);
    for (int l = 0; l < kTranscriptionLanes; ++l) {
      const Numbers own = lane(x, l);
      Numbers own_slopes, own_hessian;
      const Numbers own_terms = one.terms(own, &own_slopes);
      expect_same(lane(terms, l), own_terms);
      expect_same(lane(again, l), own_terms);
      expect_same(lane(slopes, l), own_slopes);
      const Numbers own_gradient = one.gradient(h, own, &own_hessian);
      expect_same(lane(gradient, l), own_gradient);
      expect_same(lane(first, l), own_gradient);
      expect_same(lane(hessian, l), own_hessian);
    }
  }
}
TYPED_TEST(MidpointDerivativesTest, SideBySideIsOneByOne) {
  const bool last_is_angle = TypeParam{}.info().configuration.back().period > 0;
  expect_side_by_side(this->transcription_, last_is_angle, this->generator_);
}

// One interval that cannot be evaluated is told, and the others are right all the same.
void expect_one_failure(const Transcription& one, test::Generator& generator) {
  constexpr int kBroken = 3;
  const int n = one.dof();
  Packed x = random_numbers(2 * n * kTranscriptionLanes, generator);
  for (int j = 0; j < n; ++j) {
    x[j * kTranscriptionLanes + kBroken] = std::numeric_limits<double>::quiet_NaN();
  }
  Packed terms = packed(one.term_count());
  const double* const v = x.data() + n * kTranscriptionLanes;
  const bool good =
      packed_midpoint_terms(one.functions, one.system, x.data(), v, terms.data(), nullptr);
  for (int l = 0; l < kTranscriptionLanes; ++l) {
    const Numbers own = lane(x, l);
    if (l == kBroken) {
      Numbers unused(one.term_count());
      EXPECT_EQ(good,
                midpoint_terms(
                    one.functions, one.system, own.data(), own.data() + n, unused.data(), nullptr));
    } else {
      expect_same(lane(terms, l), one.terms(own));
    }
  }
}
// What stands in one lane changes nothing in the others, to the last bit: not an angle for which
// packs have no sine, and not a number that is none. That one has no terms.
void expect_lanes_apart(const Transcription& one, test::Generator& generator) {
  constexpr int kChanged = 6;
  constexpr double kFar = 4e6;
  const int n = one.dof(), count = one.term_count(), m = one.unknowns();
  const TranscriptionFunctions& f = one.functions;
  const Packed x = random_numbers(m * kTranscriptionLanes, generator);
  const auto numbers_at = [&](const Packed& at) {
    Packed terms = packed(count), slopes = packed(count * 2 * n);
    Packed gradient = packed(m), hessian = packed(m * m);
    const double* const v = at.data() + n * kTranscriptionLanes;
    (void)packed_midpoint_terms(f, one.system, at.data(), v, terms.data(), slopes.data());
    packed_discrete_lagrangian(f, one.system, 0.3, at.data(), gradient.data(), hessian.data());
    return std::vector<Packed>{terms, slopes, gradient, hessian};
  };
  const std::vector<Packed> before = numbers_at(x);
  for (const double change : {kFar, std::numeric_limits<double>::quiet_NaN()}) {
    Packed other = x;
    for (int i = 0; i < 2 * n; ++i) other[i * kTranscriptionLanes + kChanged] += change;
    const std::vector<Packed> after = numbers_at(other);
    for (std::size_t i = 0; i < before.size(); ++i) {
      for (int l = 0; l < kTranscriptionLanes; ++l) {
        if (l != kChanged) {
          EXPECT_EQ(lane(after[i], l), lane(before[i], l));
        }
      }
    }
    EXPECT_EQ(std::isnan(change), std::isnan(after[0][kChanged]));
  }
}
TYPED_TEST(MidpointDerivativesTest, LanesAreApart) {
  expect_lanes_apart(this->transcription_, this->generator_);
}

TYPED_TEST(MidpointDerivativesTest, OneFailureSideBySideDoesNotSpoilTheOthers) {
  expect_one_failure(this->transcription_, this->generator_);
}

// A scene that has no formulas for packs, and one with more coordinates than packs are made for.
void expect_one_by_one(const Transcription& one) {
  const int n = one.dof(), count = one.term_count(), m = one.unknowns();
  const TranscriptionFunctions& f = one.functions;
  test::Generator generator(n);
  const Packed x = random_numbers(m * kTranscriptionLanes, generator);
  Packed terms = packed(count), slopes = packed(count * 2 * n), gradient = packed(m);
  const double* const v = x.data() + n * kTranscriptionLanes;
  ASSERT_TRUE(packed_midpoint_terms(f, one.system, x.data(), v, terms.data(), slopes.data()));
  packed_discrete_lagrangian(f, one.system, 0.5, x.data(), gradient.data(), nullptr);
  for (int l = 0; l < kTranscriptionLanes; ++l) {
    const Numbers own = lane(x, l);
    Numbers own_slopes;
    EXPECT_EQ(lane(terms, l), one.terms(own, &own_slopes));
    EXPECT_EQ(lane(slopes, l), own_slopes);
    EXPECT_EQ(lane(gradient, l), one.gradient(0.5, own));
  }
}
TEST(MidpointRows, WithoutPacksAreOneByOne) {
  expect_one_by_one({Separate<7>::kFunctions});
  expect_one_by_one({Separate<16>::kFunctions});
}

TEST(MidpointRows, OfEveryLengthHaveExactDerivatives) {
  for (const TranscriptionFunctions& functions : {Separate<7>::kFunctions,      // rows of 8
                                                  Separate<8>::kFunctions,      // 16
                                                  Separate<16>::kFunctions}) {  // 64
    const Transcription transcription{functions};
    test::Generator generator(functions.dof);
    expect_exact_jacobian(transcription, random_numbers(2 * functions.dof, generator));
    expect_exact_hessian(transcription, 0.5, random_numbers(transcription.unknowns(), generator));
  }
}

}  // namespace
}  // namespace carnot::midpoint_transcription_test
