// Long runs, and what round-off becomes in them.
//
// Where nothing in a step is rounded the same way every time, errors of H make a random walk: after
// N steps they are of the size eps sqrt(N) (Brouwer, Astron. J. 46, 1937). What a step is rounded
// by is carried along for that; a loop that forgets it loses digits sooner. A holonomic constraint
// that is kept by RATTLE is kept at the last step as at the first; kept as Dh q' = 0 only, it
// drifts.
#include <algorithm>
#include <cmath>
#include <limits>

#include "benchmark/benchmark_energy.h"
#include "benchmark/stress_case.h"
#include "catalogue/scene_choice.h"
#include "catalogue/text_entry.h"
#include "text/progress_bar.h"
#include "text/text_table.h"

namespace carnot::apps {
namespace {

constexpr const char* kLongRunsGroup = "long runs";

// The largest |h(q)| of a rod that goes to and fro, 25 steps each way: else it falls for ever. NaN
// where a step fails, or when stopped.
double drift_of_skate(const Dynamics& dynamics, long steps, const Progress& progress) {
  constexpr double kStep = 0.1;
  constexpr long kStroke = 25;
  constexpr long kLook = 10000;
  const double length = kStep * kStroke;
  std::vector<double> z{-0.3, -0.4, 0.3, 0.4, 0.5, 0, 0.2, 0.8};
  double largest = 0;
  for (long done = 0; done < steps; done += 2 * kStroke) {
    const bool looks = done % kLook == 0 && progress;
    if (looks && !progress(static_cast<double>(done) / static_cast<double>(steps))) {
      return std::nan("");
    }
    if (!dynamics.flow(StepPlan::equal(0, length, kStroke), z).completed()) return std::nan("");
    largest = std::max(largest, dynamics.holonomic_residuals(length, z).position);
    if (!dynamics.flow(StepPlan::equal(length, -length, kStroke), z).completed()) {
      return std::nan("");
    }
  }
  return largest;
}

StressCase skate_case(long steps, const Progress& progress) {
  return {kLongRunsGroup,
          "rod-skate, " + text_number(static_cast<double>(steps)) + " steps of RATTLE",
          "the rod keeps its length",
          drift_of_skate(find_scene("rod-skate").make({}, "rattle"), steps, progress),
          64 * kUnitRoundOff,  // to which its equation is solved
          "the same of its velocity, by DOP853",
          drift_of_skate(program_text_entry("rod-skate").make({}, "dop853"), steps, progress)};
}

double slope_of(const EnergyGrowth& first, const EnergyGrowth& last) {
  return std::log(last.drift / first.drift) /
         std::log(static_cast<double>(last.steps) / static_cast<double>(first.steps));
}

// `kept` and `lost`: the rows with and without what steps are rounded by, up to the same steps.
StressCase growth_case(const std::vector<EnergyGrowth>& kept, const EnergyGrowth& lost) {
  // A step rounds every entry of (q, p) by half an eps of its increment, which is a part of it.
  constexpr double kOfAStep = 1;
  const EnergyGrowth& last = kept.back();
  const double walk = kUnitRoundOff * std::sqrt(static_cast<double>(last.steps));
  return {kLongRunsGroup,
          last.scene + ", " + text_number(static_cast<double>(last.steps)) + " steps, slope " +
              text_number(slope_of(kept.front(), last), 2),
          "|H - H0| over eps sqrt(N) H0",
          last.drift / walk,
          kOfAStep,
          "forgetting what steps are rounded by",
          lost.drift / walk};
}

}  // namespace

std::vector<StressCase> long_cases(const SuiteOptions& options, const Progress& progress) {
  constexpr double kGrowth = 0.7;  // of the work
  EnergyOptions energy;
  energy.steps = options.brief ? 10000 : 10000000;
  energy.threads = options.threads;
  const std::vector<EnergyGrowth> growth = energy_growth(energy, part_of(progress, 0, kGrowth));
  if (growth.empty()) return {};
  std::vector<StressCase> cases;
  std::vector<EnergyGrowth> kept;
  for (const EnergyGrowth& row : growth) {
    if (row.compensated) kept.push_back(row);
    if (!row.compensated || row.steps < energy.steps) continue;
    const auto lost = std::find_if(growth.begin(), growth.end(), [&](const EnergyGrowth& other) {
      return !other.compensated && other.scene == row.scene && other.steps == row.steps;
    });
    cases.push_back(growth_case(kept, *lost));
    kept.clear();
  }
  cases.push_back(skate_case(energy.steps, part_of(progress, kGrowth, 1 - kGrowth)));
  if (progress && !progress(1)) return {};
  return cases;
}

}  // namespace carnot::apps
