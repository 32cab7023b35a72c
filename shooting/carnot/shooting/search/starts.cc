#include "carnot/shooting/search/starts.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <random>

#include "carnot/shooting/linear/round_off.h"
#include "carnot/shooting/problem/ends.h"
#include "carnot/shooting/problem/manifold.h"
#include "carnot/shooting/search/seed_words.h"

namespace carnot::internal {
namespace {

// Whether start `i` is designed: one coordinate goes out and back and another one both ways, for
// each pair of them and with each sign. They take turns with random ones.
bool is_designed(int n, int i) {
  const int pairs = n * (n - 1) / 2;
  return i % 4 == 3 && i / 4 < 4 * pairs;
}

// How many modes the wiggle of a start has. Where a path has to go round many times there are
// hundreds of extremals, and those of least action turn more often than three modes do. Of 200
// random targets of falling-cat the least known action was missed 19 times with three modes in all
// starts; 10, 9 and 12 times with 6, 8 and 10 modes in every second one, in the same time; and 11
// times with 8 in all of them. On nine other scenes, 1,500 targets, nothing more is missed by it.
// The first starts are simple: easy problems need no others. Of 1,200 answers for random targets of
// falling-cat, with crossings, 32, 26 and 31 are missed where the first 16, 8 and 2 are simple.
constexpr int kFew = 3;
constexpr int kMany = 8;
int modes_of(int n, int i) {
  constexpr int kSimple = 8;
  return i < kSimple || i % 2 == 0 || is_designed(n, i) ? kFew : kMany;
}

// Amplitudes, modes x n, in units of the wiggle's size.
std::vector<double> amplitudes(int n, std::uint64_t seed, int i) {
  const int modes = modes_of(n, i);
  std::vector<double> a(static_cast<std::size_t>(n) * modes, 0.0);
  if (i == 0) return a;  // the straight line itself
  if (is_designed(n, i)) {
    const int number = i / 4;
    int first = 0;
    int second = 1;
    for (int skip = number / 4; skip > 0; --skip) {
      if (++second == n) second = ++first + 1;
    }
    a[first] = number % 2 == 0 ? 1 : -1;
    a[n + second] = number / 2 % 2 == 0 ? 1 : -1;
    return a;
  }
  SeedWords sequence{seed, seed >> 32U, static_cast<std::uint64_t>(i)};
  std::mt19937_64 random(sequence);
  std::normal_distribution<double> normal;
  for (int m = 0; m < modes; ++m) {
    for (int j = 0; j < n; ++j) a[m * n + j] = normal(random) / (m + 1);
  }
  return a;
}

// The problem with free coordinates of its ends where start `i` begins; the first leaves them.
BoundaryValueProblem at_start(const BoundaryValueProblem& problem,
                              std::uint64_t seed,
                              int i,
                              double size,
                              const StartScales& scales) {
  if (i == 0 || !problem.has_free_ends()) return problem;
  constexpr std::uint64_t kEnds = 1;  // apart from the numbers of the wiggle
  std::seed_seq sequence{seed, seed >> 32U, static_cast<std::uint64_t>(i), kEnds};
  std::mt19937_64 random(sequence);
  std::vector<double> sizes = scales.per_metre;
  for (double& x : sizes) x *= size;
  return with_ends_moved(problem, sizes, random);
}

// How far the wiggle of an angle may go, in radians. Where there are lengths, a path that turns far
// on its way drives far astray: with 3 rad 28 of 240 targets of vehicle, trailer1 and trailer2
// whose coordinates go up to 15 are missed and 10 not solved, with 1 rad 5 and none. Where each
// coordinate is an angle, what is far away is an angle, too, and a path may have to begin the wrong
// way round. Of 1,200 answers for random targets of falling-cat 28 are missed where all wiggles
// keep to 1 rad, 18 of them without a warning: most starts lead to one extremal, and the search
// ends soon. With a full turn for simple wiggles 12 are missed and 2 without a warning. With a full
// turn for all of them 11 and 1, but of 24 seeds 16 find the hard target of the test, and not 21.
double largest_turn(const Dynamics& dynamics, int modes) {
  constexpr double kSmall = 1;
  return modes == kFew && has_only_angles(dynamics) ? 2 * std::numbers::pi : kSmall;
}

// The straight line plus sum_m a_m sin(m pi s), in units of `size`.
Path wiggled_line(const BoundaryValueProblem& problem,
                  int intervals,
                  double size,
                  const StartScales& scales,
                  const std::vector<double>& a) {
  const int n = problem.dynamics.dof;
  const int modes = static_cast<int>(a.size()) / n;
  const double most = largest_turn(problem.dynamics, modes);
  Path path;
  path.intervals = intervals;
  path.dof = n;
  path.q.resize(static_cast<std::size_t>(intervals + 1) * n);
  std::vector<double> sines(modes);
  for (int node = 0; node <= intervals; ++node) {
    const double s = static_cast<double>(node) / intervals;
    const bool end = node == 0 || node == intervals;
    for (int m = 0; m < modes; ++m) sines[m] = std::sin((m + 1) * std::numbers::pi * s);
    for (int j = 0; j < n; ++j) {
      double largest = size * scales.per_metre[j];
      if (problem.dynamics.info.configuration[j].period > 0) largest = std::min(largest, most);
      double wiggle = 0;
      for (int m = 0; m < modes && !end; ++m) {
        wiggle += a[m * n + j] * sines[m];
      }
      const double line = node == intervals
                              ? problem.to[j]
                              : problem.from[j] + s * (problem.to[j] - problem.from[j]);
      path.configuration(node)[j] = line + largest * wiggle;
    }
    if (!end) (void)bring_to_manifold(problem.dynamics, path.configuration(node));
  }
  return path;
}

// The penalty rho of a path that goes about `unit` far.
//
// The straight line violates the constraints, and with rho = 10 (unit / violation)^2 it costs half
// the action of such a path to collapse to it. With a third of that rho, paths to near targets
// collapse.
//
// Paths to far targets do not collapse, and what is more than they need only makes the valleys
// steeper that they have to follow. Default searches to 100 targets with positions up to 15 take
// 7.3, 10.7 and 14.6 s with at least 1, 3 and 10 for vehicle; to 100 with all coordinates up to 15,
// 70 s with 3 and 93 s with 10. Of 600 answers for falling-cat, which has hundreds of extremals, 11
// miss the least action with 1, and 3 with 3; of 1,200, 11 with 3 and 12 with 10.
double penalty_against_collapse(const StartScales& scales, double unit) {
  constexpr double kLeast = 3;
  constexpr double kCollapse = 10;
  const bool violates = scales.violation > kConstraintRoundOff * scales.distance;
  if (!violates) return kCollapse;
  const double collapse = unit / scales.violation;
  return std::max(kLeast, kCollapse * collapse * collapse);
}

}  // namespace

Start make_start(const BoundaryValueProblem& problem, std::uint64_t seed, int i, int intervals) {
  return make_start(problem, start_scales(problem), seed, i, intervals);
}

Start make_start(const BoundaryValueProblem& asked,
                 const StartScales& scales,
                 std::uint64_t seed,
                 int i,
                 int intervals) {
  constexpr double kMaxPenalty = 1e6;  // beyond this the least squares lose their digits
  constexpr std::array kFactors{1.0, 0.6, 2.0};
  constexpr std::array kPenalties{1.0, 2.5, 1.0};
  constexpr std::array kOuter{2, 2, 1};  // one update leaves paths loose: saddles are found too
  constexpr int kOuterStiff = 4;
  constexpr double kStiff = 100;
  constexpr double kShrink = 0.7;  // of a wiggle that leaves the chart
  const int n = asked.dynamics.dof;
  const double ratio = scales.distance / scales.radian;
  const bool against = scales.violation > 0.1 * scales.distance && ratio < 0.5;
  const std::array exponents{1.0 / 3, 0.5, against ? 1.0 / 3 : 1.0};
  const double unit = scales.radian * std::pow(ratio, exponents[i % 3]);
  double size = unit * kFactors[i / 3 % 3];
  const std::vector<double> a = amplitudes(n, seed, i);
  const BoundaryValueProblem problem = at_start(asked, seed, i, size, scales);

  Start start;
  start.path = wiggled_line(problem, intervals, size, scales, a);
  if (!in_one_chart(problem.dynamics, start.path) &&
      in_one_chart(problem.dynamics, wiggled_line(problem, intervals, 0, scales, a))) {
    do {
      size *= kShrink;
      start.path = wiggled_line(problem, intervals, size, scales, a);
    } while (!in_one_chart(problem.dynamics, start.path));
  }
  const double penalty = penalty_against_collapse(scales, unit) * kPenalties[i / 9 % 3];
  start.relaxation.caution = i % 2 == 0 ? 1e-4 : 1e-2;
  start.relaxation.penalty = std::min(penalty, kMaxPenalty);
  start.relaxation.outer_iterations = penalty > kStiff ? kOuterStiff : kOuter[i / 9 % 3];
  return start;
}

}  // namespace carnot::internal
