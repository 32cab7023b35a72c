// What `carnot benchmark` measured, and times at equal error.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "benchmark/benchmark_clock.h"
#include "benchmark/benchmark_contest.h"
#include "benchmark/benchmark_reference.h"

namespace carnot::apps {

struct BenchmarkRow {
  std::string scene;
  std::string method;
  std::string mode;
  bool peer = false;
  bool automatic = false;
  double step_or_tolerance = 0;
  double error = 0;        // max-norm of (q, p)(T) minus the reference
  double seconds = 0;      // median CPU time of one trajectory, with the choice of the step
  double evaluations = 0;  // of the right-hand side, per trajectory
  double energy_drift = 0;
};

// A contestant that did not arrive.
struct BenchmarkFailure {
  std::string scene;
  std::string method;
  std::string mode;
  double step_or_tolerance = 0;
  std::string message;
};

struct BenchmarkScene {
  BenchmarkProblem problem;
  BenchmarkReference reference;
  std::vector<BenchmarkRow> rows;
  std::vector<BenchmarkFailure> failures;
};

// Fills the rows. Returns false when stopped.
bool run_contest(const std::vector<Contestant>& contestants,
                 const TimingOptions& timing,
                 const Progress& progress,
                 BenchmarkScene& scene);

// The rows of one method with one way to choose its steps; its curve in work and precision.
struct BenchmarkCurve {
  std::string method;
  std::string mode;
  bool peer = false;
  bool automatic = false;
  std::vector<BenchmarkRow> rows;

  // "gauss16", "gauss16, steps given", "gauss16, batch".
  [[nodiscard]] std::string title() const;
};

// Curves and rows in the order of the rows given.
std::vector<BenchmarkCurve> benchmark_curves(const std::vector<BenchmarkRow>& rows);

// Time for an error: on the rows that no other row of the curve beats in both, straight lines in
// logarithms. Nothing outside of them.
std::optional<double> seconds_at(const BenchmarkCurve& curve, double error);

// The errors that tables tell times for.
inline constexpr double kBenchmarkErrors[] = {1e-4, 1e-6, 1e-8, 1e-10, 1e-12};

// Time of the contrast over that of the curve at the same error: above 1 the curve is faster.
std::optional<double> speed_ratio(const std::vector<BenchmarkCurve>& curves,
                                  const BenchmarkCurve& curve,
                                  double error);

}  // namespace carnot::apps
