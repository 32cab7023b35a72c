// Steering in the Open Motion Planning Library: a state space, its motions and their cost.
//
//   const auto space = std::make_shared<SteeringStateSpace>(steer, bounds);
//   const auto si = std::make_shared<ompl::base::SpaceInformation>(space);
//   si->setMotionValidator(std::make_shared<SteeringMotionValidator>(si));
//   problem->setOptimizationObjective(std::make_shared<SteeringObjective>(si));
//
// Header only: whoever includes it brings OMPL (1.5 of Debian 12 is tested).
//
// A state is a point of R^k and, with SteeringOptions::mod_angles, an SO(2) for each coordinate
// with a period; R^k holds the others.
// Paths are geodesics (SteeringStateSpace::interpolate), and the cost of a motion is their length
// (SteeringObjective). A new pair of states costs a search of 10 to 200 ms, so planners must not
// ask for it where they look for neighbours: distance() is the straight line with angles weighed by
// `radian`, which takes nanoseconds, unless Nearness::kGeodesic is chosen. RRT* then searches for
// about 4 log(n) + 1 geodesics per sample, SteeringOptions::starts = 2 makes these quicker.
#pragma once

#include <ompl/base/MotionValidator.h>
#include <ompl/base/OptimizationObjective.h>
#include <ompl/base/SpaceInformation.h>
#include <ompl/base/StateSpace.h>
#include <ompl/base/spaces/RealVectorStateSpace.h>
#include <ompl/base/spaces/SO2StateSpace.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <numbers>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "carnot/shooting/steering_function.h"

namespace carnot {

class SteeringStateSpace : public ompl::base::CompoundStateSpace {
 public:
  using State = ompl::base::State;
  enum class Nearness { kStraight, kGeodesic };

  // `bounds` of the coordinates in R^k, in the order of the scene; `radian` is a length.
  SteeringStateSpace(SteeringFunction steer,
                     const ompl::base::RealVectorBounds& bounds,
                     double radian = 1,
                     Nearness nearness = Nearness::kStraight)
      : steer_(std::move(steer)), nearness_(nearness) {
    const auto lines = std::make_shared<ompl::base::RealVectorStateSpace>(bounds.low.size());
    lines->setBounds(bounds);
    addSubspace(lines, 1);
    for (int j = 0; j < steer_.dof(); ++j) {
      if (!turns(j)) continue;
      addSubspace(std::make_shared<ompl::base::SO2StateSpace>(), radian * unit_of(j));
    }
    if (getDimension() != static_cast<unsigned>(steer_.dof())) {
      throw std::invalid_argument("bounds are of " + std::to_string(bounds.low.size()) +
                                  " coordinates, the states have others that do not turn");
    }
    setName("Steering" + getName());
    lock();
  }

  [[nodiscard]] const SteeringFunction& steering() const { return steer_; }

  [[nodiscard]] std::vector<double> configuration(const State* state) const {
    std::vector<double> q(steer_.dof());
    each(const_cast<State*>(state),
         [&](int j, double& value, double unit) { q[j] = value * unit; });
    return q;
  }
  void set(State* state, const std::vector<double>& q) const {
    each(state, [&](int j, double& value, double unit) { value = q[j] / unit; });
    for (unsigned i = 1; i < getSubspaceCount(); ++i) {
      getSubspace(i)->enforceBounds(state->as<ompl::base::CompoundState>()->components[i]);
    }
  }

  // The length of the geodesic; infinite where none was found.
  [[nodiscard]] double length(const State* from, const State* to) const {
    return steer_.distance(configuration(from), configuration(to));
  }

  double distance(const State* from, const State* to) const override {
    return nearness_ == Nearness::kGeodesic ? length(from, to)
                                            : CompoundStateSpace::distance(from, to);
  }
  // Where there is no geodesic: `from`. SteeringMotionValidator refuses such a motion.
  void interpolate(const State* from, const State* to, double t, State* state) const override {
    std::vector<double> q = configuration(from);
    (void)steer_.interpolate(configuration(from), configuration(to), t, q);
    set(state, q);
  }
  unsigned int validSegmentCount(const State* from, const State* to) const override {
    const double segments = std::ceil(length(from, to) / longestValidSegment_);
    constexpr double kMost = 1e6;
    return longestValidSegmentCountFactor_ * static_cast<unsigned>(std::min(segments, kMost));
  }
  // The searches are good, not perfect: a longer way than the shortest breaks the axioms.
  bool isMetricSpace() const override { return nearness_ == Nearness::kStraight; }
  bool hasSymmetricDistance() const override {
    return nearness_ == Nearness::kStraight || steer_.symmetric();
  }
  bool hasSymmetricInterpolate() const override { return steer_.symmetric(); }

 private:
  // f(j, value, unit): coordinate j is value times unit.
  template <class F>
  void each(State* state, const F& f) const {
    auto* parts = state->as<ompl::base::CompoundState>()->components;
    double* line = parts[0]->as<ompl::base::RealVectorStateSpace::StateType>()->values;
    auto** angle = parts + 1;
    for (int j = 0; j < steer_.dof(); ++j) {
      if (turns(j)) {
        f(j, (*angle++)->as<ompl::base::SO2StateSpace::StateType>()->value, unit_of(j));
      } else {
        f(j, *line++, 1.0);
      }
    }
  }

  // Whether coordinate j is an SO(2), and what it is there at one radian.
  [[nodiscard]] bool turns(int j) const { return steer_.options().mod_angles && unit_of(j) > 0; }
  [[nodiscard]] double unit_of(int j) const {
    return steer_.info().configuration[j].period / (2 * std::numbers::pi);
  }

  SteeringFunction steer_;
  Nearness nearness_;
};

// A motion is valid where there is a geodesic and all of its states are.
class SteeringMotionValidator : public ompl::base::MotionValidator {
 public:
  using State = ompl::base::State;

  explicit SteeringMotionValidator(const ompl::base::SpaceInformationPtr& si)
      : MotionValidator(si), space_(si->getStateSpace()->as<SteeringStateSpace>()) {}

  bool checkMotion(const State* from, const State* to) const override {
    std::pair<State*, double> unused{nullptr, 0};
    return checkMotion(from, to, unused);
  }
  bool checkMotion(const State* from,
                   const State* to,
                   std::pair<State*, double>& last_valid) const override {
    const Steering way =
        space_->steering().steer(space_->configuration(from), space_->configuration(to));
    const unsigned count = way.found() ? space_->validSegmentCount(from, to) : 1;
    std::vector<double> q = space_->configuration(from);
    State* state = si_->allocState();
    unsigned i = 1;
    bool valid = way.found();
    for (; valid && i <= std::max(1U, count); ++i) {
      valid = way.at(static_cast<double>(i) / std::max(1U, count), q);
      if (valid) space_->set(state, q);
      valid = valid && si_->isValid(state);
    }
    si_->freeState(state);
    ++(valid ? valid_ : invalid_);
    if (valid) return true;
    last_valid.second = i >= 2 ? static_cast<double>(i - 2) / std::max(1U, count) : 0;
    if (last_valid.first != nullptr) {
      space_->interpolate(from, to, last_valid.second, last_valid.first);
    }
    return false;
  }

 private:
  const SteeringStateSpace* space_;
};

// The length of geodesics.
class SteeringObjective : public ompl::base::OptimizationObjective {
 public:
  using State = ompl::base::State;
  using Cost = ompl::base::Cost;

  explicit SteeringObjective(const ompl::base::SpaceInformationPtr& si)
      : OptimizationObjective(si), space_(si->getStateSpace()->as<SteeringStateSpace>()) {
    description_ = "length of geodesics";
  }
  Cost stateCost(const State* /*state*/) const override { return identityCost(); }
  Cost motionCost(const State* from, const State* to) const override {
    return Cost(space_->length(from, to));
  }
  bool isSymmetric() const override { return space_->steering().symmetric(); }

 private:
  const SteeringStateSpace* space_;
};

}  // namespace carnot
