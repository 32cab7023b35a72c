// Scenes made ready for an audit: parameters, a start and steps at which the laws show.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "carnot/laws/laws.h"
#include "catalogue/scene_entry.h"

namespace carnot::apps {

struct AuditSubject {
  const SceneEntry* entry = nullptr;
  ParameterValues parameters;  // those that are not the scene's own defaults
  PhaseStart start;
  double duration = 0;     // of the run that measures the order
  double step = 0;         // for symplectic form and reversal: large enough that others break them
  double energy_step = 0;  // for the long run; 0: the motion is not bounded, so H says nothing
  long energy_steps = 0;   // of the long run
  bool telling = false;    // methods that do not declare a law are known to break it here

  // With the parameters above.
  [[nodiscard]] Dynamics dynamics(const std::string& method) const;
};

// One scene of each kind.
std::vector<std::string> default_audit_scenes();

// With a start chosen by hand where there is one, else with the first generic one from which the
// scene moves. Nothing where none is found.
std::optional<AuditSubject> audit_subject(const SceneEntry& entry);

// The run that measures the order, by the most accurate method that suits the scene.
ReferenceRun audit_reference(const AuditSubject& subject);

}  // namespace carnot::apps
