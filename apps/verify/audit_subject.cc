#include "verify/audit_subject.h"

#include <algorithm>
#include <cmath>

#include "carnot/tableau/methods.h"
#include "catalogue/scene_choice.h"

namespace carnot::apps {
namespace {

constexpr long kManySteps = 100000;
constexpr long kSteps = 10000;  // where a step costs more

// Chosen by hand: motions that are regular, and bounded where an energy step is given, and along
// which the errors of most methods fall in a straight line.
struct Choice {
  std::string scene;
  ParameterValues parameters;
  std::vector<double> z;
  double duration;
  double step;
  double energy_step;
  long energy_steps;
};

const std::vector<Choice>& choices() {
  // clang-format off
  static const std::vector<Choice> kChoices = {
      // Circles.
      {"heisenberg", {}, {0, 0, 0, 0.1, 0.3, 1}, 20, 0.5, 0.3, kManySteps},
      // p_x = p_y = 0: the steering angle swings like a pendulum and p_theta stays as it is.
      {"vehicle", {}, {0.4, 0.3, -0.3, 0.55, 0, 0, 0.75, -1}, 20, 0.5, 0.2, kManySteps},
      {"bicycle", {}, {-0.1, -0.15, 0.9, 0.55, 0, 0, -0.8, 0.05}, 10, 0.4, 0.2, kSteps},
      {"vehicle-cosine", {}, {0.75, 0.65, 0.65, -0.45, -0.9, 0.35, 0.2, 0.35}, 10, 0.4, 0, 0},
      {"pendulum", {}, {0.4, 0.3, 0.5, 0.6}, 5, 0.5, 0, 0},
      // Spring and trap keep them near the origin.
      {"appell", {{"stiffness", 1}}, {-0.1, -0.55, 0.05, 0.85, -0.1, -0.15}, 20, 0.4, 0.3, kSteps},
      {"magnetic-particle", {}, {-0.55, -0.2, -0.2, 0.35}, 10, 0.4, 0.3, kSteps},
      // Hanging, shaken gently.
      {"kapitza-pendulum", {{"frequency", 3}, {"amplitude", 0.2}}, {-0.2, 0.35}, 20, 0.3, 0.2, kSteps},
      {"spherical-pendulum", {}, {0.6, 0, -0.8, 0.2, 0.7, 0.15}, 10, 0.1, 0.1, kManySteps},
      {"rod-skate", {}, {-0.3, -0.4, 0.3, 0.4, 0.5, 0, 0.2, 0.8}, 5, 0.1, 0, 0},
  };
  // clang-format on
  return kChoices;
}

bool moves(const Dynamics& dynamics, const PhaseStart& start, double duration) {
  constexpr long kTrialSteps = 40;
  constexpr double kLeastWay = 0.1;
  constexpr double kFurthest = 100;
  std::vector<double> z = start.z;
  const FlowReport report = dynamics.flow(StepPlan::equal(start.t, duration, kTrialSteps), z);
  if (!report.completed()) return false;
  double way = 0;
  for (std::size_t i = 0; i < z.size(); ++i) way = std::max(way, std::abs(z[i] - start.z[i]));
  return way > kLeastWay && way < kFurthest;
}

// The k-th of a sequence of points in [-1, 1]^2n without any symmetry.
std::vector<double> generic_point(int k, int size) {
  std::vector<double> z(static_cast<std::size_t>(size));
  for (int i = 0; i < size; ++i) z[i] = std::sin(1.3 + 2.7 * i + 4.1 * k);
  return z;
}

bool on_manifold(const Dynamics& dynamics, PhaseStart& start) {
  return dynamics.holonomic == 0 || dynamics.project_on_manifold(start.t, start.z);
}

const char* accurate_method(const SceneEntry& entry) {
  return entry.needs_rattle ? "rattle6" : "gauss16";
}

}  // namespace

Dynamics AuditSubject::dynamics(const std::string& method) const {
  return entry->make(parameters, method);
}

std::vector<std::string> default_audit_scenes() {
  return {"heisenberg",
          "appell",
          "kapitza-pendulum",
          "bicycle",
          "pendulum",
          "magnetic-particle",
          "rod-skate",
          "spherical-pendulum"};
}

std::optional<AuditSubject> audit_subject(const SceneEntry& entry) {
  constexpr double kDuration = 2;
  constexpr double kStep = 0.1;
  constexpr int kTries = 50;
  AuditSubject subject;
  subject.entry = &entry;
  // Another scene may have the name of one of the program.
  const bool known = is_of_program(entry);
  const auto chosen = std::find_if(choices().begin(), choices().end(), [&](const Choice& choice) {
    return known && choice.scene == entry.info.name;
  });
  if (chosen != choices().end()) {
    subject.parameters = chosen->parameters;
    subject.start.z = chosen->z;
    subject.duration = chosen->duration;
    subject.step = chosen->step;
    subject.energy_step = chosen->energy_step;
    subject.energy_steps = chosen->energy_steps;
    subject.telling = true;
    if (!on_manifold(subject.dynamics(accurate_method(entry)), subject.start)) return std::nullopt;
    return subject;
  }
  subject.duration = kDuration;
  subject.step = kStep;
  const Dynamics dynamics = subject.dynamics(accurate_method(entry));
  for (int k = 0; k < kTries; ++k) {
    subject.start.z = generic_point(k, 2 * entry.dof);
    if (on_manifold(dynamics, subject.start) && moves(dynamics, subject.start, kDuration)) {
      return subject;
    }
  }
  return std::nullopt;
}

ReferenceRun audit_reference(const AuditSubject& subject) {
  constexpr long kMostSteps = 1 << 14;
  const Dynamics dynamics = subject.dynamics(accurate_method(*subject.entry));
  return reference_run(dynamics, subject.start, subject.duration, kMostSteps);
}

}  // namespace carnot::apps
