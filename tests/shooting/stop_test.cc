// Work that has to end: by the clock, by its caller, and in whatever part of a search it is.
#include "carnot/shooting/problem/stop.h"

#include <gtest/gtest.h>

#include <atomic>
#include <cmath>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include "carnot/make_limit.h"
#include "carnot/shooting/find_geodesics.h"
#include "carnot/shooting/path/action_descent.h"
#include "carnot/shooting/path/discrete_newton.h"
#include "carnot/shooting/path/homotopy.h"
#include "carnot/shooting/path/refinement.h"
#include "carnot/shooting/path/relaxation.h"
#include "carnot/shooting/search/polish.h"
#include "carnot/shooting/search/starts.h"
#include "carnot/shooting/shoot/multiple_shooting.h"
#include "shooting/problems.h"
#include "shooting/tight_path.h"

namespace carnot::internal::stop_test {
namespace {

constexpr double kNever = HUGE_VAL;

// Its caller says so once it has been asked so often.
Stop after(int questions) {
  return Stop(kNever, [asked = 0, questions]() mutable { return asked++ < questions; });
}

TEST(Stop, IsNotReachedWhereNothingIsAskedFor) {
  for (const Stop& stop : {Stop(), Stop(kNever), Stop(1e9), Stop(kNever, [] { return true; })}) {
    EXPECT_FALSE(stop.reached());
    EXPECT_FALSE(stop.late() || stop.asked());
  }
  EXPECT_EQ(Stop().left(), kNever);
  EXPECT_EQ(Stop(kNever).left(), kNever);
  EXPECT_LE(Stop(100).left(), 100);
  EXPECT_GT(Stop(100).left(), 0);
}

TEST(Stop, IsReachedWhenItsTimeIsUp) {
  const Stop stop(0);
  EXPECT_EQ(stop.left(), 0);
  EXPECT_FALSE(stop.late());  // until somebody asks
  EXPECT_TRUE(stop.reached());
  EXPECT_TRUE(stop.late());
  EXPECT_FALSE(stop.asked());
}

TEST(Stop, IsOneForAllCopiesAndStaysSo) {
  const Stop stop = after(2);
  const Stop copy = stop;
  EXPECT_FALSE(stop.reached());
  EXPECT_FALSE(copy.reached());
  EXPECT_TRUE(copy.reached());
  EXPECT_TRUE(stop.asked());
  EXPECT_TRUE(stop.reached());
}

// The caller need not be ready for other threads than its own, but these hear what it said.
TEST(Stop, AsksInItsOwnThreadOnly) {
  std::atomic<int> asked{0};
  const Stop stop(kNever, [&] { return ++asked > 100; });
  const auto elsewhere = [&] {
    bool reached = false;
    std::thread([&] { reached = stop.reached(); }).join();
    return reached;
  };
  EXPECT_FALSE(elsewhere());
  EXPECT_EQ(asked, 0);
  EXPECT_TRUE(stop.reached());
  EXPECT_EQ(asked, 1);
  EXPECT_TRUE(elsewhere());
  EXPECT_TRUE(stop.reached());
  EXPECT_EQ(asked, 1);  // and is not asked again
}

TEST(Stop, IsTheCallersWhereBothAreTrue) {
  const Stop stop(0, [] { return false; });
  EXPECT_TRUE(stop.reached());
  EXPECT_TRUE(stop.asked());
  EXPECT_FALSE(stop.late());
}

TEST(Stop, KeepsWhatItsCallerThrows) {
  const Stop stop(kNever, []() -> bool { throw std::runtime_error("enough"); });
  EXPECT_NO_THROW(stop.rethrow());
  EXPECT_TRUE(stop.reached());
  EXPECT_TRUE(stop.asked());
  EXPECT_THROW(stop.rethrow(), std::runtime_error);
  EXPECT_NO_THROW(Stop().rethrow());
}

TEST(Stop, EndsRefinementWithTheGridsThatThereAre) {
  const BoundaryValueProblem problem = test::sideways();
  const Path path = test::tight_path(problem);
  RefinementOptions options;
  options.enough = 0;  // to the end
  int all = 0;
  options.stop = Stop(kNever, [&] { return ++all > 0; });
  const Refinement whole = refine(MassLadder(problem), options, path);
  ASSERT_GE(whole.finer.size(), 3U);
  bool some = false;
  for (int questions = 0; questions < all; ++questions) {
    options.stop = after(questions);
    const Refinement part = refine(MassLadder(problem), options, path);
    ASSERT_TRUE(options.stop.asked());
    EXPECT_LT(part.finer.size(), whole.finer.size());
    EXPECT_EQ(part.found, !part.finer.empty());
    for (std::size_t i = 0; i < part.finer.size(); ++i) {
      EXPECT_EQ(part.finer[i].q, whole.finer[i].q);  // whole ones only
    }
    some = some || part.found;
  }
  EXPECT_TRUE(some);
}

TEST(Stop, EndsNewtonsMethodWhereItIs) {
  const BoundaryValueProblem problem = test::sideways();
  Start start = make_start(problem, 0, 2, 32);
  relax(problem, start.relaxation, start.path);
  Path whole = start.path;
  const int all = tighten(problem, {}, whole).iterations;
  ASSERT_GE(all, 2);
  for (int questions = 0; questions < all; ++questions) {
    DiscreteNewtonOptions options;
    options.stop = after(questions);
    Path path = start.path;
    const DiscreteNewton stopped = tighten(problem, options, path);
    EXPECT_FALSE(stopped.converged);
    EXPECT_EQ(stopped.iterations, questions);
  }
}

TEST(Stop, EndsWhatIsCarriedAlong) {
  Path path;
  path.dof = 1;
  path.q = {0};
  path.lambda = {0};
  HomotopyOptions options;
  options.stop = after(3);
  double last = 0;
  const auto correct = [&](double s, Path& trial) {
    trial.q[0] = last = s;
    return true;
  };
  EXPECT_FALSE(follow(options, correct, path));
  EXPECT_GT(last, 0);
  EXPECT_LT(last, 1);
  EXPECT_EQ(path.q[0], last);
}

TEST(Stop, EndsTheDescentOfTheAction) {
  const BoundaryValueProblem problem = test::sideways();
  ActionDescentOptions options;
  options.sizes.assign(4, 1.0);
  options.rest.assign(4, 0.0);
  options.relaxation = 1;
  Path path = make_start(problem, 0, 3, 16).path;
  path.lambda.clear();
  options.stop = after(1);
  const ActionDescent stopped = reduce_action(problem, options, path);
  EXPECT_FALSE(stopped.converged);
  EXPECT_LE(stopped.iterations, 1);
}

// Whichever way it goes, and wherever it is: what is stopped has not converged, and what is not is
// as it would be without.
TEST(Stop, EndsEveryMinimiser) {
  const BoundaryValueProblem problem = test::vehicle({0, 0, 0, 0}, {2, 1, 0.5, 0.5});
  const std::vector<double> rough{2.12, -0.274, 1.167, 1.378};
  for (const std::string& minimiser : names_of_minimisers()) {
    SCOPED_TRACE(minimiser);
    ShootingOptions options;
    options.minimiser = minimiser;
    const Knots start = knots_of(problem, rough, 4, 32);
    Knots whole = start;
    ASSERT_TRUE(shoot(problem, options, whole).converged);
    for (const int questions : {0, 1, 3, 5, 8}) {
      options.stop = after(questions);
      Knots knots = start;
      testing::internal::CaptureStderr();
      const bool converged = shoot(problem, options, knots).converged;
      EXPECT_EQ(testing::internal::GetCapturedStderr(), "");
      EXPECT_FALSE(converged && options.stop.asked());
      EXPECT_TRUE(options.stop.asked()) << questions;
    }
    options.stop = after(1000000);
    Knots knots = start;
    EXPECT_TRUE(shoot(problem, options, knots).converged);
    EXPECT_EQ(knots.z, whole.z);
  }
}

TEST(Stop, LeavesNoReasonWherePolishingIsStopped) {
  const BoundaryValueProblem problem = test::sideways();
  const Path path = test::tight_path(problem);
  const MassLadder ladder(problem);
  const Refinement refined = refine_to_polish(ladder, path);
  ASSERT_TRUE(polish(ladder, {}, path, refined).extremal.has_value());
  for (const int questions : {0, 1, 2, 5, 10}) {
    const Stop stop = after(questions);
    const Outcome outcome = polish(ladder, {}, path, refined, stop);
    ASSERT_TRUE(stop.asked());
    EXPECT_FALSE(outcome.extremal.has_value());
    EXPECT_EQ(outcome.reason, Reason::kNone);
  }
}

// A round of starts takes seconds where a light axle asks for grids of thousands of intervals. So
// the caller is asked within it, more often than there are starts, and in its own thread.
TEST(Stop, IsAskedForWithinARound) {
  const BoundaryValueProblem problem = test::sideways();
  GeodesicOptions options;
  options.threads = 1;
  options.samples = 0;
  int all = 0;
  const std::thread::id owner = std::this_thread::get_id();
  options.progress = [&](double) {
    EXPECT_EQ(std::this_thread::get_id(), owner);
    return ++all > 0;
  };
  const GeodesicReport whole = find_geodesics(problem, options);
  ASSERT_EQ(whole.status, GeodesicStatus::kConverged);
  EXPECT_GT(all, 2 * whole.starts);
  options.threads = 2;
  for (const int patience : {1, 2, all / 4}) {
    int asked = 0;
    options.progress = [&](double) {
      EXPECT_EQ(std::this_thread::get_id(), owner);
      return ++asked < patience;
    };
    const GeodesicReport report = find_geodesics(problem, options);
    EXPECT_EQ(report.status, GeodesicStatus::kInterrupted) << patience << " of " << all;
    EXPECT_EQ(asked, patience);
  }
}

// A caller that throws is let out of the search, wherever it is asked, and of its threads.
TEST(Stop, LetsExceptionsOut) {
  BoundaryValueProblem problem = test::sideways();
  const Limit steering = make_limit<4>(
      "steering", [](const auto& q) { return q[3] - q[2]; }, -0.3, 0.3);
  for (const bool limited : {false, true}) {
    if (limited) problem.limits = {steering};
    for (const int threads : {1, 2}) {
      for (const int patience : {1, 2, 10, 30}) {
        int asked = 0;
        GeodesicOptions options;
        options.threads = threads;
        options.progress = [&](double) {
          if (++asked >= patience) throw std::runtime_error("enough");
          return true;
        };
        EXPECT_THROW(find_geodesics(problem, options), std::runtime_error);
        EXPECT_EQ(asked, patience);
      }
    }
  }
}

}  // namespace
}  // namespace carnot::internal::stop_test
