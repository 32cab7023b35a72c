// Starts side by side: each becomes what it becomes alone, and what the plain method makes of it.
#include "carnot/shooting/path/newton_lanes.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "carnot/shooting/path/relaxation.h"
#include "carnot/shooting/search/relaxed_start.h"
#include "carnot/shooting/search/starts.h"
#include "shooting/problems.h"

namespace carnot::internal::newton_lanes_test {
namespace {

constexpr int kStarts = 21;  // more than lanes, and no multiple of them
constexpr int kIntervals = 16;

// Constraints with M regular and singular, with dependent rows, with a potential, with a free end,
// and in coordinates that end.
std::vector<BoundaryValueProblem> problems() {
  BoundaryValueProblem free_end = test::vehicle({0, 0, 0, 0}, {2, 1, 0.5, 0.5});
  free_end.free_to = {false, false, true, true};
  return {test::sideways(),
          test::vehicle({0, 0, 0, 0}, {3, -2, 1, -2}),
          free_end,
          test::engel({1, 0.5, -0.3, 0.2}),
          test::bicycle({0.4, 0.3, 0.2, 0.1}),
          test::oscillator({1, 0}, {0, 1}, 1)};
}

std::vector<Start> starts_of(const BoundaryValueProblem& problem) {
  std::vector<Start> starts;
  for (int i = 0; i < kStarts; ++i) starts.push_back(make_start(problem, 0, i, kIntervals));
  return starts;
}

std::vector<Relaxation> relax_together(const BoundaryValueProblem& problem,
                                       std::vector<Start>& starts) {
  std::vector<RelaxationTask> tasks;
  for (Start& start : starts) tasks.push_back({start.relaxation, &start.path, {}});
  relax(problem, tasks);
  std::vector<Relaxation> results;
  for (const RelaxationTask& task : tasks) results.push_back(task.result);
  return results;
}

std::vector<Path> relaxed_paths(const BoundaryValueProblem& problem) {
  std::vector<Start> starts = starts_of(problem);
  relax_together(problem, starts);
  std::vector<Path> paths;
  for (const Start& start : starts) paths.push_back(start.path);
  return paths;
}

std::vector<TighteningTask> tighten_together(const BoundaryValueProblem& problem,
                                             std::vector<Path>& paths) {
  std::vector<TighteningTask> tasks;
  for (Path& path : paths) tasks.push_back({&path, {}});
  tighten(problem, {}, tasks);
  return tasks;
}

TEST(RelaxationLanes, RelaxEachPathAsIfItWereAlone) {
  for (const BoundaryValueProblem& problem : problems()) {
    std::vector<Start> together = starts_of(problem);
    std::vector<Start> alone = together;
    const std::vector<Relaxation> results = relax_together(problem, together);
    for (int i = 0; i < kStarts; ++i) {
      const Relaxation own = relax(problem, alone[i].relaxation, alone[i].path);
      EXPECT_EQ(own.iterations, results[i].iterations);
      EXPECT_EQ(own.action, results[i].action);
      EXPECT_EQ(together[i].path.q, alone[i].path.q);
      EXPECT_EQ(together[i].path.lambda, alone[i].path.lambda);
    }
  }
}

// One path has a number that is none: it is left as it is, and the others do not notice.
TEST(RelaxationLanes, LeaveOutWhatHasNoTerms) {
  const BoundaryValueProblem problem = test::sideways();
  std::vector<Start> together = starts_of(problem);
  std::vector<Start> alone = together;
  together[3].path.q[20] = std::numeric_limits<double>::quiet_NaN();
  const std::vector<Relaxation> results = relax_together(problem, together);
  EXPECT_EQ(results[3].iterations, 0);
  EXPECT_FALSE(results[3].feasible);
  relax_together(problem, alone);
  for (int i = 0; i < kStarts; ++i) {
    if (i != 3) {
      EXPECT_EQ(together[i].path.q, alone[i].path.q);
    }
  }
}

// Newton's steps are those of the plain method up to round-off. Some paths are far from a solution,
// and theirs part after a while: either comes to nothing, or to a solution of its own.
TEST(NewtonLanes, AgreeWithThePlainMethod) {
  constexpr double kSame = 1e-7;  // of the path; the residual is 1e-9 of the momenta
  for (const BoundaryValueProblem& problem : problems()) {
    std::vector<Path> plain = relaxed_paths(problem);
    std::vector<Path> together = plain;
    const std::vector<TighteningTask> tasks = tighten_together(problem, together);
    int converged = 0;
    int plainly = 0;
    int both = 0;
    int same = 0;
    int as_soon = 0;
    for (int i = 0; i < kStarts; ++i) {
      const DiscreteNewton own = tighten(problem, {}, plain[i]);
      const DiscreteNewton& result = tasks[i].result;
      for (const double x : together[i].q) EXPECT_TRUE(std::isfinite(x));
      EXPECT_TRUE(std::isfinite(result.residual));
      plainly += own.converged ? 1 : 0;
      if (!result.converged) continue;
      ++converged;
      double size = 0;
      for (const double p : together[i].p) size = std::max(size, std::abs(p));
      for (const double left : residual_of(problem, together[i])) {
        EXPECT_LE(std::abs(left), 1e-6 * size);
      }
      if (!own.converged) continue;
      ++both;
      double apart = 0;
      double largest = 0;
      for (std::size_t j = 0; j < together[i].q.size(); ++j) {
        apart = std::max(apart, std::abs(together[i].q[j] - plain[i].q[j]));
        largest = std::max(largest, std::abs(plain[i].q[j]));
      }
      same += apart <= kSame * largest ? 1 : 0;
      as_soon += result.iterations == own.iterations ? 1 : 0;
    }
    EXPECT_GT(both, 0);
    EXPECT_NEAR(converged, plainly, 1);
    EXPECT_GE(same, both - 1);
    EXPECT_GE(as_soon, both - 2);
  }
}

TEST(NewtonLanes, TightenEachPathAsIfItWereAlone) {
  for (const BoundaryValueProblem& problem : problems()) {
    std::vector<Path> alone = relaxed_paths(problem);
    std::vector<Path> together = alone;
    const std::vector<TighteningTask> tasks = tighten_together(problem, together);
    for (int i = 0; i < kStarts; ++i) {
      TighteningTask own{&alone[i], {}};
      tighten(problem, {}, {&own, 1});
      EXPECT_EQ(own.result.converged, tasks[i].result.converged);
      EXPECT_EQ(own.result.iterations, tasks[i].result.iterations);
      EXPECT_EQ(own.result.residual, tasks[i].result.residual);
      EXPECT_EQ(alone[i].q, together[i].q);
      EXPECT_EQ(alone[i].lambda, together[i].lambda);
      EXPECT_EQ(alone[i].p, together[i].p);
    }
  }
}

// How many threads there are decides how starts are packed, and nothing else.
TEST(RelaxedStarts, DoNotDependOnTheNumberOfThreads) {
  std::vector<StartDraw> draws;
  for (int i = 0; i < kStarts; ++i) draws.push_back({i, i / 8 % 2 == 0 ? kIntervals : 32});
  for (const BoundaryValueProblem& problem : problems()) {
    const MassLadder ladder(problem);
    std::vector<std::vector<RelaxedStart>> found;
    for (const int threads : {1, 2, 5}) {
      RelaxedStartOptions options;
      options.threads = threads;
      found.push_back(relaxed_starts(ladder, std::nullopt, options, draws));
    }
    for (int i = 0; i < kStarts; ++i) {
      for (const std::vector<RelaxedStart>& other : found) {
        EXPECT_EQ(other[i].found, found[0][i].found);
        EXPECT_EQ(other[i].stiffness, found[0][i].stiffness);
        EXPECT_EQ(other[i].residual, found[0][i].residual);
        EXPECT_EQ(other[i].path.q, found[0][i].path.q);
      }
    }
  }
}

// Starts of different rungs or grids do not go side by side; each is in one pack.
TEST(RelaxedStarts, ArePackedByGridAndRung) {
  std::vector<Start> starts(40);
  for (std::size_t i = 0; i < starts.size(); ++i) {
    starts[i].path.intervals = i % 3 == 0 ? 32 : 16;
    starts[i].path.rung = i % 2 == 0 ? 1 : 0;
  }
  for (const int threads : {1, 2, 16, 100}) {
    std::vector<int> times(starts.size(), 0);
    for (const StartPack& pack : packs_of(starts, threads)) {
      ASSERT_FALSE(pack.empty());
      for (const std::size_t i : pack) {
        ++times[i];
        EXPECT_EQ(starts[i].path.intervals, starts[pack[0]].path.intervals);
        EXPECT_EQ(starts[i].path.rung, starts[pack[0]].path.rung);
      }
    }
    EXPECT_EQ(std::count(times.begin(), times.end(), 1), std::ssize(times));
  }
}

}  // namespace
}  // namespace carnot::internal::newton_lanes_test
