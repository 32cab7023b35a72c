// Short cuts for tests that run the stepping kernel with the tableau of a named method.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <string>

#include "carnot/step/runge_kutta.h"
#include "carnot/tableau/make_tableau.h"
#include "carnot/tableau/methods.h"
#include "testing/runs.h"

namespace carnot::test {

// One of every family and of every kind of coupling.
inline const char* const kRepresentatives[] = {
    "gauss6", "midpoint4", "midpoint6", "lobatto4", "radau5", "dop853"};

template <class T = double>
Tableau<T> tableau_of(const std::string& name) {
  const Method* method = find_method(name);
  if (method == nullptr) {
    ADD_FAILURE() << "there is no method of the name " << name;
    return make_tableau<T>(methods().front());
  }
  return make_tableau<T>(*method);
}

// How far the stages are from U_i = z + e + sum_j mu_ij L_j and L_i = h omega_i f(U_i), over their
// size.
template <class Step>
typename Step::Scalar stage_defect(const Step& step,
                                   const typename Step::Scalar& h,
                                   const State<typename Step::Scalar, Step::kDof>& before) {
  using T = typename Step::Scalar;
  using Point = Vector<T, Step::kSize>;
  const auto& tableau = step.tableau();
  T defect(0);
  for (int i = 0; i < tableau.stages(); ++i) {
    Point u = before.value + before.compensation;
    for (int j = 0; j < tableau.stages(); ++j) {
      for (int r = 0; r < Step::kSize; ++r) {
        const T mu = r < Step::kDof ? tableau.mu(i, j) : tableau.momentum_mu(i, j);
        u[r] += mu * step.increments()(r, j);
      }
    }
    Vector<T, Step::System::kAlgebraic> y = step.algebraic(i);
    const Point stage = step.stages().col(i);
    Point f;
    EXPECT_EQ(phase_rate(step.system(), step.stage_time(i), stage, y, f), RateStatus::kOk);
    const Point increment = h * tableau.omega[i] * f;
    defect = std::max(defect, relative_distance(u, stage));
    defect = std::max(defect, relative_distance(increment, Point(step.increments().col(i))));
  }
  return defect;
}

// A step that fails names one reason and leaves the state and the branch alone.
template <class Step, class Z>
void expect_refused(Step& step, double t, double h, Z& z) {
  const Z before = z;
  const auto branch = step.branch();
  const StepReport report = step.step(t, h, z);
  EXPECT_NE(report.status, StepStatus::kOk);
  const bool diverged = report.status == StepStatus::kStagesDiverged;
  EXPECT_NE(diverged, report.rate != RateStatus::kOk) << "one reason, named";
  EXPECT_EQ(z.value, before.value);
  EXPECT_EQ(z.compensation, before.compensation);
  EXPECT_EQ(step.branch(), branch);
  EXPECT_EQ(step.last_step(), 0);
}

// Parameterised over the representatives.
class MethodTest : public ::testing::TestWithParam<const char*> {
 protected:
  const std::string name_ = GetParam();
  const Tableau<double> tableau_ = tableau_of(name_);

  [[nodiscard]] bool implicit() const { return tableau_.coupling != Coupling::kExplicit; }
};

inline std::string method_test_name(const ::testing::TestParamInfo<const char*>& info) {
  return info.param;
}

}  // namespace carnot::test
