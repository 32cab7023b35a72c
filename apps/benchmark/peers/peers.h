// The contestants of `carnot benchmark --peers`.
#pragma once

#include <vector>

#include "benchmark/benchmark_contest.h"

namespace carnot::apps {

std::vector<Contestant> peer_contestants(const BenchmarkProblem& problem,
                                         const BenchmarkLadder& ladder);

}  // namespace carnot::apps
