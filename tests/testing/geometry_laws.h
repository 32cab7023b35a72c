// Laws of a symplectic, reversible method, told a run as a function: so the laws are compiled once
// per number of unknowns, and the kernel of all methods once per scene.
#pragma once

#include <gtest/gtest.h>

#include <functional>
#include <string>
#include <vector>

#include "carnot/flow/tangent_flow.h"
#include "carnot/tableau/methods.h"
#include "carnot/tableau/tableau_laws.h"
#include "testing/runs.h"

namespace carnot::test {

template <int n>
using TangentState = Compensated<Matrix<double, 2 * n, 2 * n>>;

template <int n>
TangentState<n> identity_tangent() {
  using Square = Matrix<double, 2 * n, 2 * n>;
  return {Square::Identity(), Square::Zero()};
}

// Advances z, and m with it, by equal steps over `duration`.
template <int n>
using Run =
    std::function<FlowReport(double duration, long steps, State<double, n>& z, TangentState<n>& m)>;

// max-norm of M'JM - J over max(1, |M|^2).
template <int size>
double relative_symplecticity_defect(const Matrix<double, size, size>& m) {
  const double norm = m.norm();
  return symplecticity_defect(m) / std::max(1.0, norm * norm);
}

template <int n>
void expect_symplectic(const Run<n>& run, double h, long steps) {
  constexpr double kDefect = 1e-14;  // about 50 eps: round-off of the products, per |M|^2
  Generator generator(1);
  for (int sample = 0; sample < 3; ++sample) {
    auto z = random_state<n>(generator);
    auto m = identity_tangent<n>();
    const FlowReport report = run(h * static_cast<double>(steps), steps, z, m);
    ASSERT_TRUE(report.completed()) << report.reason();
    EXPECT_LE(relative_symplecticity_defect(m.value), kDefect);
  }
}

// M against central differences of fourth order of the flow itself.
template <int n>
void expect_tangent_of_the_map(const Run<n>& run, double h, long steps) {
  constexpr double kStep = 1e-3;
  // Truncation kStep^4 and round-off eps / kStep are below 1e-12, times high derivatives of the
  // flow, up to 1e3 here.
  constexpr double kTolerance = 1e-8;
  Generator generator(2);
  const auto start = random_state<n>(generator);
  const auto end = [&](int i, double d, TangentState<n>& m) {
    auto z = start;
    z.value[i] += d;
    EXPECT_TRUE(run(h * static_cast<double>(steps), steps, z, m).completed());
    return z.value;
  };
  auto m = identity_tangent<n>();
  auto unused = identity_tangent<n>();
  end(0, 0, m);
  for (int i = 0; i < 2 * n; ++i) {
    const Vector<double, 2 * n> near = end(i, kStep, unused) - end(i, -kStep, unused);
    const Vector<double, 2 * n> far = end(i, 2 * kStep, unused) - end(i, -2 * kStep, unused);
    const Vector<double, 2 * n> column = (8 * near - far) / (12 * kStep);
    EXPECT_LE((column - m.value.col(i)).cwiseAbs().maxCoeff(), kTolerance) << "column " << i;
  }
}

// Steps of h, then of -h, are the identity; so is h, flip p, h, flip p.
template <int n>
void expect_reversible(const Run<n>& run, double h, long steps) {
  // Each step rounds once; an unstable orbit amplifies by |M|, below 1e3 here.
  const double tolerance = 1e3 * static_cast<double>(steps) * epsilon<double>();
  const double duration = h * static_cast<double>(steps);
  auto unused = identity_tangent<n>();
  Generator generator(3);
  for (int sample = 0; sample < 5; ++sample) {
    const auto start = random_state<n>(generator);
    auto z = start;
    ASSERT_TRUE(run(duration, steps, z, unused).completed());
    auto back = z;
    ASSERT_TRUE(run(-duration, steps, back, unused).completed());
    EXPECT_LE(relative_distance(back.value, start.value), tolerance);
    auto mirrored = flipped<double, n>(z);
    ASSERT_TRUE(run(duration, steps, mirrored, unused).completed());
    mirrored = flipped<double, n>(mirrored);
    EXPECT_LE(relative_distance(mirrored.value, start.value), tolerance);
  }
}

// The names of the methods that claim to keep all this, for TEST_P.
inline std::vector<std::string> geometric_methods() {
  std::vector<std::string> names;
  for (const Method& method : methods()) {
    if (method.symplectic && method.symmetric && method.family != kRattleFamily) {
      names.push_back(method.name);
    }
  }
  return names;
}

template <int n>
void expect_geometry_laws(const Run<n>& run) {
  constexpr double kStep = 0.1;
  expect_symplectic<n>(run, kStep, 1);
  expect_symplectic<n>(run, kStep, 30);
  expect_symplectic<n>(run, 0.6, 3);  // large: Newton's ground for small s
  expect_tangent_of_the_map<n>(run, kStep, 5);
  expect_reversible<n>(run, kStep, 20);
}

}  // namespace carnot::test
