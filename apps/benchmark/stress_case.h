// The hard cases of `carnot stress --suite`: what is hard, the law that holds all the same, by how
// much it is missed, and by how much a naive method misses it.
#pragma once

#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "carnot/flow/reports.h"

namespace carnot::apps {

// What allowances are multiples of.
inline constexpr double kUnitRoundOff = std::numeric_limits<double>::epsilon();

struct StressCase {
  std::string group;
  std::string name;
  std::string law;
  double figure = 0;  // how far from the law; NaN where nothing was found
  double bound = 0;   // how far is allowed
  std::string naive;  // what else one might do
  double naive_figure = 0;

  [[nodiscard]] bool holds() const { return figure <= bound; }  // false for NaN
};

struct SuiteOptions {
  bool brief = false;  // fewer steps and fewer cases: some seconds
  int threads = 0;     // 0: all cores
};

// The groups. Each takes up to a second in brief form; the long one takes minutes in full. Empty
// where `progress` says to stop.
std::vector<StressCase> unstable_cases(const SuiteOptions& options, const Progress& progress);
std::vector<StressCase> long_cases(const SuiteOptions& options, const Progress& progress);
std::vector<StressCase> stiff_cases(const SuiteOptions& options, const Progress& progress);
std::vector<StressCase> index_cases(const SuiteOptions& options, const Progress& progress);
std::vector<StressCase> boundary_cases(const SuiteOptions& options, const Progress& progress);

// At which straight lines of the vehicle part from their neighbours: both positive rates, the
// larger first. See stress_unstable.cc.
std::pair<double, double> rates_of_line(double alpha, double beta, double length);

// When a trajectory of the vehicle has left its circle by 0.1, with 53, 64 or 113 bits.
double departure_from_circle(int bits);

}  // namespace carnot::apps
