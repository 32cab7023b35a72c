// Every scene of the program as text, against its compiled twin: point by point, and along flows.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <random>
#include <span>
#include <string>
#include <vector>

#include "carnot/load_scene.h"
#include "carnot/make_dynamics.h"
#include "carnot/scenes/appell.h"
#include "carnot/scenes/bicycle.h"
#include "carnot/scenes/boat.h"
#include "carnot/scenes/kapitza_pendulum.h"
#include "carnot/scenes/magnetic_particle.h"
#include "carnot/scenes/relativistic_particle.h"
#include "carnot/scenes/trailers.h"
#include "carnot/system/system_functions.h"
#include "carnot/transcription/transcription_functions.h"
#include "catalogue/scene_choice.h"
#include "testing/distance.h"

namespace carnot::text_twins_test {
namespace {

using test::largest_change;

using apps::SceneEntry;

constexpr double kEps = std::numeric_limits<double>::epsilon();
// Another order of the same operations, in formulas of up to a hundred of them with a condition of
// up to ten at these points: measured up to 12 eps.
constexpr double kRoundOff = 100 * kEps;

TextScene text_of(const std::string& name) {
  return load_scene(CARNOT_SOURCE_DIR "/lib/carnot/scenes/" + name + ".scene");
}

// Of those that the program itself has as text, the class.
Dynamics twin_of(const std::string& name, const char* method) {
  if (name == "boat") return make_dynamics(scenes::Boat{}, method);
  if (name == "appell") return make_dynamics(scenes::Appell{}, method);
  if (name == "kapitza-pendulum") return make_dynamics(scenes::KapitzaPendulum{}, method);
  if (name == "relativistic-particle") return make_dynamics(scenes::RelativisticParticle{}, method);
  if (name == "magnetic-particle") return make_dynamics(scenes::MagneticParticle{}, method);
  if (name == "bicycle") return make_dynamics(scenes::Bicycle{}, method);
  if (name == "trailer1") return make_dynamics(scenes::Trailers<1>{}, method);
  return apps::find_scene(name).make({}, method);
}

enum class Which { kAll, kFree, kHolonomic };
std::vector<std::string> names(Which which) {
  std::vector<std::string> result;
  for (const std::string& name : apps::scene_names()) {
    const SceneEntry& entry = apps::find_scene(name);
    // More rods of the same kind: LongTrailers.
    if (entry.info.name == "trailer2" || entry.info.name == "trailer3") continue;
    const bool held = entry.holonomic > 0;
    if (which == Which::kAll || held == (which == Which::kHolonomic)) {
      result.push_back(entry.info.name);
    }
  }
  return result;
}

std::string test_name(const ::testing::TestParamInfo<std::string>& scene) {
  std::string name = scene.param;
  std::replace(name.begin(), name.end(), '-', '_');
  return name;
}

double largest(const std::vector<double>& x) {
  double most = 0;
  for (const double e : x) most = maximum(most, std::abs(e));
  return most;
}

class TextDescriptions : public ::testing::TestWithParam<std::string> {
 protected:
  const SceneEntry& entry_ = apps::find_scene(GetParam());
  TextScene scene_ = text_of(GetParam());
};

TEST_P(TextDescriptions, AreThoseOfTheTwin) {
  const SceneInfo& text = scene_.info();
  const SceneInfo twin = twin_of(GetParam(), entry_.needs_rattle ? "rattle" : "gauss16").info;
  EXPECT_EQ(text.name, twin.name);
  EXPECT_EQ(text.summary, twin.summary);
  EXPECT_EQ(text.kind, twin.kind);
  EXPECT_EQ(text.reference, twin.reference);
  EXPECT_EQ(scene_.dof(), entry_.dof);
  EXPECT_EQ(scene_.multipliers(), entry_.multipliers);
  ASSERT_EQ(text.configuration.size(), twin.configuration.size());
  for (std::size_t i = 0; i < twin.configuration.size(); ++i) {
    EXPECT_EQ(text.configuration[i].name, twin.configuration[i].name);
    EXPECT_EQ(text.configuration[i].unit, twin.configuration[i].unit);
    EXPECT_EQ(text.configuration[i].period, twin.configuration[i].period);
  }
  ASSERT_EQ(scene_.parameters().size(), entry_.parameters.size());
  for (std::size_t i = 0; i < entry_.parameters.size(); ++i) {
    EXPECT_EQ(scene_.parameters()[i].name, entry_.parameters[i].name);
    EXPECT_EQ(scene_.parameters()[i].default_value, entry_.parameters[i].default_value);
    EXPECT_EQ(scene_.parameters()[i].unit, entry_.parameters[i].unit);
    EXPECT_EQ(scene_.parameters()[i].range.text(), entry_.parameters[i].range.text());
  }
  EXPECT_EQ(scene_.holonomic(), entry_.holonomic);
  ASSERT_EQ(text.extremes.size(), twin.extremes.size());
  for (std::size_t i = 0; i < twin.extremes.size(); ++i) {
    EXPECT_EQ(text.extremes[i].name, twin.extremes[i].name);
    EXPECT_EQ(text.extremes[i].unit, twin.extremes[i].unit);
    std::vector<double> q;
    for (int j = 0; j < scene_.dof(); ++j) q.push_back(std::sin(1 + 3 * j));
    EXPECT_NEAR(std::abs(text.extremes[i].value(q.data())),
                std::abs(twin.extremes[i].value(q.data())),
                kRoundOff);
  }
}

class TextTwins : public ::testing::TestWithParam<std::string> {
 protected:
  TextTwins()
      : entry_(apps::find_scene(GetParam())),
        scene_(text_of(GetParam())),
        text_(make_dynamics(scene_)),
        twin_(twin_of(GetParam(), "gauss16")) {}

  std::vector<double> random(int count) {
    std::uniform_real_distribution<double> number(-1, 1);
    std::vector<double> x(static_cast<std::size_t>(count));
    for (double& e : x) e = number(bits_);
    return x;
  }

  // What both say at one phase point.
  struct Values {
    RateStatus status;
    std::vector<double> rate;
    std::vector<double> jacobian;
    std::vector<double> lambda;
    double hamiltonian;
  };
  static Values at(const Dynamics& d, double t, const std::vector<double>& z) {
    const int n = d.dof;
    const SystemFunctions& f = *d.functions;
    const void* const system = d.system.get();
    std::vector<double> y(static_cast<std::size_t>(f.algebraic));
    f.branch(system, y.data());
    Values v{RateStatus::kOk,
             std::vector<double>(2 * n),
             std::vector<double>(4 * n * n),
             std::vector<double>(static_cast<std::size_t>(f.multipliers)),
             0};
    v.status = f.rate(system, t, z.data(), y.data(), v.rate.data());
    if (v.status != RateStatus::kOk) return v;
    v.hamiltonian = f.hamiltonian(system, t, z.data(), z.data() + n, y.data());
    EXPECT_EQ(f.find_multipliers(system, t, z.data(), z.data() + n, y.data(), v.lambda.data()),
              RateStatus::kOk);
    EXPECT_EQ(f.jacobian(system, t, z.data(), y.data(), v.jacobian.data()), RateStatus::kOk);
    return v;
  }

  const SceneEntry& entry_;
  TextScene scene_;
  Dynamics text_;
  Dynamics twin_;
  std::mt19937_64 bits_{3};
};

// Those that the twin names are found; there may be more.
TEST_P(TextTwins, FindsTheSymmetries) {
  const Symmetries& found = scene_.info().symmetries;
  const Symmetries& known = twin_.info.symmetries;
  for (const std::vector<double>& mirror : known.mirrors) {
    EXPECT_NE(std::find(found.mirrors.begin(), found.mirrors.end(), mirror), found.mirrors.end());
  }
  for (const int i : known.cyclic) {
    EXPECT_NE(std::find(found.cyclic.begin(), found.cyclic.end(), i), found.cyclic.end()) << i;
  }
  if (known.x < 0) return;
  EXPECT_EQ(found.x, known.x);
  EXPECT_EQ(found.y, known.y);
  for (const int i : known.angles) {
    EXPECT_NE(std::find(found.angles.begin(), found.angles.end(), i), found.angles.end()) << i;
  }
}

TEST_P(TextTwins, AgreesAtRandomPoints) {
  EXPECT_EQ(text_.autonomous, twin_.autonomous);
  EXPECT_EQ(text_.transcribed, twin_.transcribed);
  EXPECT_EQ(text_.has_branches(), twin_.has_branches());
  constexpr int kPoints = 50;
  int other_branch = 0;
  for (int i = 0; i < kPoints; ++i) {
    const std::vector<double> z = random(2 * text_.dof);
    const Values text = at(text_, 0.3, z);
    const Values twin = at(twin_, 0.3, z);
    ASSERT_EQ(text.status, twin.status);
    if (twin.status != RateStatus::kOk) continue;
    // Near a singular point Newton's method may end on either of two solutions.
    if (text_.has_branches() && largest_change(text.rate, twin.rate) > 1e-3) {
      ++other_branch;
      continue;
    }
    EXPECT_LE(largest_change(text.rate, twin.rate), kRoundOff * (1 + largest(twin.rate)));
    EXPECT_LE(largest_change(text.jacobian, twin.jacobian),
              kRoundOff * (1 + largest(twin.jacobian)));
    EXPECT_LE(largest_change(text.lambda, twin.lambda), kRoundOff * (1 + largest(twin.lambda)));
    EXPECT_NEAR(text.hamiltonian, twin.hamiltonian, kRoundOff * (1 + std::abs(twin.hamiltonian)));
  }
  EXPECT_LE(other_branch, 1);
}

TEST_P(TextTwins, TurnsVelocitiesIntoTheSameMomenta) {
  const int n = text_.dof;
  for (int i = 0; i < 20; ++i) {
    const std::vector<double> q = random(n);
    std::vector<double> v = random(n);
    for (double& e : v) e *= 0.5;  // of a relativistic particle, below the speed of light
    std::vector<double> w = v;
    const std::vector<double> lambda = random(text_.multipliers);
    std::vector<double> p(v.size());
    std::vector<double> expected(v.size());
    const double violated = text_.momentum(0.3, q, v, lambda, p);
    const double twin = twin_.momentum(0.3, q, w, lambda, expected);
    ASSERT_EQ(std::isnan(violated), std::isnan(twin));
    if (std::isnan(twin)) continue;
    // Iterations end at round-off of their equations, times their condition.
    constexpr double kIterated = 100 * kRoundOff;
    EXPECT_NEAR(violated, twin, kIterated * (1 + twin));
    EXPECT_LE(largest_change(v, w), kIterated * (1 + largest(w)));
    EXPECT_LE(largest_change(p, expected), kIterated * (1 + largest(expected)));
  }
}

// Random points side by side have the entries and Hessians that they have one by one.
void expect_side_by_side(const TranscriptionFunctions& f,
                         const void* system,
                         const GaugeUnits& units,
                         const std::function<std::vector<double>(int)>& random) {
  constexpr int kLanes = kTranscriptionLanes;
  constexpr double kTolerance = 100 * kRoundOff;
  const int n = f.dof;
  const std::vector<double> q = random(n * kLanes);
  const std::vector<double> v = random(n * kLanes);
  const std::vector<double> lambda = random(f.constraints * kLanes);
  const auto lane = [](const std::vector<double>& from, int l) {
    std::vector<double> own;
    for (std::size_t i = l; i < from.size(); i += kLanes) own.push_back(from[i]);
    return own;
  };
  const auto size = [](int count) { return static_cast<std::size_t>(count) * kLanes; };
  std::vector<double> slopes(size(entry_count(f) * (1 + n)));
  std::vector<double> values(size(entry_count(f)));
  std::vector<double> hessian(size(n * n));
  f.packed_entries(system, q.data(), units, true, slopes.data());
  f.packed_entries(system, q.data(), units, false, values.data());
  f.packed_hessian(system, q.data(), v.data(), lambda.data(), units, hessian.data());
  for (int l = 0; l < kLanes; ++l) {
    std::vector<double> rows(static_cast<std::size_t>(entry_count(f)) * row_length(n));
    f.entries(system, lane(q, l).data(), units, true, rows.data());
    std::vector<double> known;
    for (int i = 0; i < entry_count(f); ++i) {
      known.insert(known.end(), &rows[i * row_length(n)], &rows[i * row_length(n)] + 1 + n);
    }
    EXPECT_LE(largest_change(lane(slopes, l), known), kTolerance * (1 + largest(known)));
    std::vector<double> entries(static_cast<std::size_t>(entry_count(f)));
    f.entries(system, lane(q, l).data(), units, false, entries.data());
    EXPECT_LE(largest_change(lane(values, l), entries), kTolerance * (1 + largest(entries)));
    std::vector<double> second(static_cast<std::size_t>(n * n));
    const auto own = [&](const std::vector<double>& x) { return lane(x, l); };
    f.hessian(system, own(q).data(), own(v).data(), own(lambda).data(), units, second.data());
    EXPECT_LE(largest_change(lane(hessian, l), second), kTolerance * (1 + largest(second)));
  }
}

// The entries of the transcription and the Hessian of its Lagrangian, in several units of a gauge.
TEST_P(TextTwins, IsTranscribedAlike) {
  ASSERT_EQ(text_.has_transcription(), twin_.has_transcription());
  if (!twin_.has_transcription()) return;
  const TranscriptionFunctions& f = *text_.transcription;
  const TranscriptionFunctions& g = *twin_.transcription;
  ASSERT_EQ(f.gauge, g.gauge);
  ASSERT_EQ(f.constraints, g.constraints);
  const int n = f.dof;
  // Through Cholesky factors of F'F, whose condition is up to a hundred at these points.
  constexpr double kTolerance = 100 * kRoundOff;
  std::vector<double> sizes;
  for (int j = 0; j < n; ++j) sizes.push_back(0.5 + 0.4 * j);
  for (int i = 0; i < 20; ++i) {
    const GaugeUnits units = i % 2 == 0 ? GaugeUnits{} : GaugeUnits{sizes.data(), 0.7};
    const std::vector<double> q = random(n);
    const std::vector<double> v = random(n);
    const std::vector<double> lambda = random(f.constraints);
    for (const bool slopes : {false, true}) {
      const int size = entry_count(f) * (slopes ? row_length(n) : 1);
      std::vector<double> a(static_cast<std::size_t>(size));
      std::vector<double> b(a.size());
      f.entries(text_.system.get(), q.data(), units, slopes, a.data());
      g.entries(twin_.system.get(), q.data(), units, slopes, b.data());
      EXPECT_LE(largest_change(a, b), kTolerance * (1 + largest(b)));
    }
    const auto numbers = [this](int count) { return random(count); };
    expect_side_by_side(f, text_.system.get(), units, numbers);
    if (g.packed_entries != nullptr) expect_side_by_side(g, twin_.system.get(), units, numbers);
    std::vector<double> a(static_cast<std::size_t>(n * n));
    std::vector<double> b(a.size());
    f.hessian(text_.system.get(), q.data(), v.data(), lambda.data(), units, a.data());
    g.hessian(twin_.system.get(), q.data(), v.data(), lambda.data(), units, b.data());
    EXPECT_LE(largest_change(a, b), kTolerance * (1 + largest(b)));
  }
}

TEST_P(TextTwins, FlowsAlike) {
  constexpr double kTolerance = 1e-11;  // round-off of 40 steps of a motion that enlarges it
  for (const char* method : {"gauss16", "midpoint", "dop853"}) {
    const Dynamics text = make_dynamics(scene_, method);
    const Dynamics twin = twin_of(GetParam(), method);
    const int n = text.dof;
    std::vector<double> z(static_cast<std::size_t>(2 * n));
    for (int i = 0; i < 2 * n; ++i) z[i] = 0.3 + 0.1 * std::sin(1.7 * i);
    std::vector<double> w = z;
    std::vector<double> m(static_cast<std::size_t>(4 * n * n));
    std::vector<double> expected(m.size());
    const StepPlan plan = StepPlan::equal(0, 2, 40);
    ASSERT_TRUE(text.tangent_flow(plan, z, m).completed()) << method;
    ASSERT_TRUE(twin.tangent_flow(plan, w, expected).completed()) << method;
    EXPECT_LE(largest_change(z, w), kTolerance * (1 + largest(w))) << method;
    EXPECT_LE(largest_change(m, expected), kTolerance * (1 + largest(expected))) << method;
  }
}

TEST_P(TextTwins, MeasuresAlike) {
  const int n = text_.dof;
  std::vector<double> z(static_cast<std::size_t>(2 * n));
  for (int i = 0; i < 2 * n; ++i) z[i] = 0.3 + 0.1 * std::sin(1.7 * i);
  std::vector<double> w = z;
  const StepPlan plan = StepPlan::equal(0, 2, 40);
  const FlowSummary text = text_.monitored_flow(plan, z, {});
  const FlowSummary twin = twin_.monitored_flow(plan, w, {});
  constexpr double kTolerance = 1e-11;
  EXPECT_NEAR(text.action, twin.action, kTolerance * (1 + std::abs(twin.action)));
  EXPECT_EQ(std::isnan(text.length), std::isnan(twin.length));
  if (!std::isnan(twin.length)) {
    EXPECT_NEAR(text.length, twin.length, kTolerance * (1 + twin.length));
  }
  EXPECT_LE(text.constraint_error, 1e-13);
}

// Holonomic constraints are kept as Dh q' = 0 here, by RATTLE there: the same paths, of momenta
// that differ along Dh.
class HolonomicTwins : public ::testing::TestWithParam<std::string> {
 protected:
  // A point of the manifold and an admissible velocity there, all of them about one.
  static std::vector<double> start(const Dynamics& d) {
    const int n = d.dof;
    std::vector<double> z(static_cast<std::size_t>(2 * n));
    for (int i = 0; i < n; ++i) z[i] = 0.8 * std::cos(1.3 * i * i + 0.2);
    EXPECT_TRUE(d.project_on_manifold(0, z));
    std::vector<double> v(static_cast<std::size_t>(n));
    for (int i = 0; i < n; ++i) v[i] = 0.5 * std::sin(1.7 * i + 0.4);
    const std::vector<double> lambda(static_cast<std::size_t>(d.multipliers), 0.1);
    const std::span<double> all(z);
    EXPECT_FALSE(std::isnan(d.momentum(0, all.first(n), v, lambda, all.subspan(n))));
    return z;
  }
};

TEST_P(HolonomicTwins, TakeTheSamePaths) {
  const Dynamics text = make_dynamics(text_of(GetParam()));
  const SceneEntry& entry = apps::find_scene(GetParam());
  const Dynamics twin = entry.make({}, "rattle6");
  ASSERT_EQ(text.dof, twin.dof);
  const int n = text.dof;
  std::vector<double> z = start(text);
  std::vector<double> w = z;
  ASSERT_TRUE(twin.project_on_manifold(0, w));
  const FlowSummary run = text.monitored_flow(StepPlan::equal(0, 1, 50), z, {});
  const FlowSummary expected = twin.monitored_flow(StepPlan::equal(0, 1, 1000), w, {});
  ASSERT_TRUE(run.completed() && expected.completed());
  constexpr double kTolerance = 1e-11;  // of a thousand steps of order six
  z.resize(static_cast<std::size_t>(n));
  w.resize(z.size());
  EXPECT_LE(largest_change(z, w), kTolerance);
  EXPECT_NEAR(run.action, expected.action, kTolerance * (1 + std::abs(expected.action)));
  EXPECT_LE(run.holonomic_error, 1e-13);
  EXPECT_LE(run.constraint_error, 1e-13);
  EXPECT_LE(run.energy_drift, 1e-13);
}

// The nearest point of the manifold with the momentum that has no part along Dh, and a projector on
// its tangent space.
TEST_P(HolonomicTwins, ProjectOnTheManifold) {
  const Dynamics d = make_dynamics(text_of(GetParam()));
  const int n = d.dof;
  std::vector<double> z = start(d);
  ASSERT_TRUE(d.project_on_manifold(0, z));
  EXPECT_LE(d.holonomic_residuals(0, z).position, 8 * kEps);
  EXPECT_LE(d.holonomic_residuals(0, z).relative_velocity, 8 * kEps);
  std::vector<double> again = z;
  ASSERT_TRUE(d.project_on_manifold(0, again));
  EXPECT_LE(largest_change(z, again), 64 * kEps * (1 + largest(z)));
  const std::size_t size = z.size();
  std::vector<double> p(size * size);
  ASSERT_TRUE(d.tangent_projector(0, z, p));
  double trace = 0;
  for (std::size_t i = 0; i < size; ++i) {
    trace += p[i * size + i];
    for (std::size_t j = 0; j < size; ++j) {
      double square = 0;
      for (std::size_t k = 0; k < size; ++k) square += p[i * size + k] * p[k * size + j];
      EXPECT_NEAR(square, p[i * size + j], kRoundOff);
    }
  }
  EXPECT_NEAR(trace, 2 * (n - d.holonomic), kRoundOff);
  // A small step along the manifold stays on it to second order.
  std::vector<double> step(size);
  for (std::size_t i = 0; i < size; ++i) {
    for (std::size_t j = 0; j < size; ++j) {
      step[i] += p[j * size + i] * std::cos(2.1 * static_cast<double>(j));
    }
  }
  constexpr double kSmall = 1e-5;
  std::vector<double> moved = z;
  for (std::size_t i = 0; i < size; ++i) moved[i] += kSmall * step[i];
  std::vector<double> back = moved;
  ASSERT_TRUE(d.project_on_manifold(0, back));
  EXPECT_LE(largest_change(moved, back), 1e3 * kSmall * kSmall);
}

// Two and three trailers, whose classes take the compiler longest: what they say at a point.
template <int trailers>
void expect_rates_of_the_class() {
  constexpr int n = scenes::Trailers<trailers>::kDof;
  const VelocityConstraints system(scenes::Trailers<trailers>{});
  const Dynamics text = make_dynamics(text_of("trailer" + std::to_string(trailers)));
  ASSERT_EQ(text.dof, n);
  const SceneInfo info = scenes::Trailers<trailers>{}.info();
  EXPECT_EQ(text.info.name, info.name);
  EXPECT_EQ(text.info.summary, info.summary);
  EXPECT_EQ(text.info.extremes.size(), info.extremes.size());
  std::mt19937_64 bits(5);
  std::uniform_real_distribution<double> number(-1, 1);
  const SystemFunctions& f = *text.functions;
  for (int i = 0; i < 50; ++i) {
    Vector<double, 2 * n> z;
    for (double& e : z) e = number(bits);
    const Vector<double, n> q = z.template head<n>();
    const Vector<double, n> p = z.template tail<n>();
    Vector<double, decltype(system)::kAlgebraic> y;
    Rate<double, n> expected;
    ASSERT_EQ(system.rate(0.0, q, p, y, expected), RateStatus::kOk);
    std::vector<double> algebraic(static_cast<std::size_t>(f.algebraic));
    std::vector<double> rate(2 * n);
    ASSERT_EQ(f.rate(text.system.get(), 0, z.data(), algebraic.data(), rate.data()),
              RateStatus::kOk);
    const double size =
        1 + expected.q_dot.cwiseAbs().maxCoeff() + expected.p_dot.cwiseAbs().maxCoeff();
    for (int j = 0; j < n; ++j) {
      EXPECT_NEAR(rate[j], expected.q_dot[j], kRoundOff * size);
      EXPECT_NEAR(rate[n + j], expected.p_dot[j], kRoundOff * size);
    }
  }
}

TEST(LongTrailers, HaveTheRatesOfTheClass) {
  expect_rates_of_the_class<2>();
  expect_rates_of_the_class<3>();
}

INSTANTIATE_TEST_SUITE_P(Scenes,
                         TextDescriptions,
                         ::testing::ValuesIn(names(Which::kAll)),
                         test_name);
INSTANTIATE_TEST_SUITE_P(Scenes, TextTwins, ::testing::ValuesIn(names(Which::kFree)), test_name);
INSTANTIATE_TEST_SUITE_P(Scenes,
                         HolonomicTwins,
                         ::testing::ValuesIn(names(Which::kHolonomic)),
                         test_name);

}  // namespace
}  // namespace carnot::text_twins_test
