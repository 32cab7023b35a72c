// Ipopt, which is under the EPL, on the transcriptions of ipopt.cc and ipopt_controls.cc.
#pragma once

#include <coin/IpTNLP.hpp>
#include <optional>

#include "benchmark/benchmark_direct.h"

namespace carnot::apps {

// Whether Ipopt says that it has solved a problem, with the options of all of them.
bool run_ipopt(const Ipopt::SmartPtr<Ipopt::TNLP>& problem);

// A problem of optimal control without limits. The action of the transcription where it is solved.
std::optional<double> control_with_ipopt(const BoundaryValueProblem& problem, GridPath& path);

}  // namespace carnot::apps
