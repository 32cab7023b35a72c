// Where the trajectories of `carnot benchmark` end, to more than twenty digits.
//
// Gauss's method of order 24 in quadruple precision, on the scene's own formulas, with N and with
// 2N steps: what both agree on is what is known.
#pragma once

#include <string>
#include <vector>

#include "benchmark/benchmark_trajectory.h"
#include "carnot/dynamics.h"

namespace carnot::apps {

struct BenchmarkReference {
  std::vector<std::string> digits;  // (q, p) at the end, decimal
  double agreement = 0;             // max-norm of the difference of the two runs
  // high + low is the value to twice the precision of double.
  std::vector<double> high;
  std::vector<double> low;

  // Max-norm of z - (q, p); infinite where z is not finite.
  [[nodiscard]] double error(const double* z) const;
};

inline constexpr double kReferenceAgreement = 1e-22;

// Integrates. Throws std::runtime_error when stopped, or when the runs do not agree.
BenchmarkReference compute_reference(const BenchmarkTrajectory& trajectory,
                                     const Progress& progress);

// high and low from the digits. Throws std::runtime_error when they are no finite numbers.
void read_digits(BenchmarkReference& reference);

}  // namespace carnot::apps
