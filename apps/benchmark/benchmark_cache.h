// References of `carnot benchmark` in the user's cache directory: they take seconds to make.
//
// $XDG_CACHE_HOME/carnot, or ~/.cache/carnot; one file per trajectory. What is there is used only
// if it was made by this version for the same scene, parameters, start and time. A directory that
// cannot be written, or none at all, only costs the time to compute again.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "benchmark/benchmark_reference.h"

namespace carnot::apps {

// Nothing when the environment names no directory.
std::optional<std::filesystem::path> cache_directory();

// From the cache, or computed and then kept there. Throws like compute_reference().
BenchmarkReference cached_reference(const BenchmarkTrajectory& trajectory,
                                    const Progress& progress);

}  // namespace carnot::apps
