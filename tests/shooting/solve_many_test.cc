#include "carnot/shooting/solve_many.h"

#include <gtest/gtest.h>

#include <atomic>
#include <map>
#include <stdexcept>

#include "shooting/problems.h"

namespace carnot::solve_many_test {
namespace {

// Sideways by i / 10, but for one that cannot be asked.
ManyProblems problems(long count) {
  return {count, [](long i) {
            if (i == 7) throw std::invalid_argument("seven");
            return test::vehicle({0, 0, 0, 0}, {0, 0.1 * static_cast<double>(i), 0, 0});
          }};
}

ManyOptions options(int threads, long chunk) {
  ManyOptions options;
  options.each.samples = 0;
  options.threads = threads;
  options.chunk = chunk;
  return options;
}

std::map<long, GeodesicReport> solve(const ManyOptions& options, long count) {
  std::map<long, GeodesicReport> all;
  EXPECT_TRUE(solve_many(
      problems(count), options, [&](long first, std::span<const GeodesicReport> reports) {
        for (const GeodesicReport& report : reports) all[first++] = report;
        return true;
      }));
  return all;
}

TEST(SolveMany, IsTheSameAsOneByOneOnAnyNumberOfThreads) {
  constexpr long kCount = 11;
  const auto one = solve(options(1, 4), kCount);
  const auto many = solve(options(3, 2), kCount);
  ASSERT_EQ(one.size(), kCount);
  ASSERT_EQ(many.size(), kCount);
  for (const auto& [i, report] : one) {
    const GeodesicReport& other = many.at(i);
    EXPECT_EQ(report.reason, other.reason);
    if (i == 7) {
      EXPECT_EQ(report.reason, Reason::kIrregularEnd);
      EXPECT_EQ(report.message, "seven");
      continue;
    }
    const GeodesicReport alone = find_geodesics(problems(kCount).at(i), options(1, 1).each);
    ASSERT_FALSE(report.geodesics.empty());
    EXPECT_EQ(report.geodesics[0].p0, other.geodesics.at(0).p0);
    EXPECT_EQ(report.geodesics[0].p0, alone.geodesics.at(0).p0);
    EXPECT_EQ(report.geodesics[0].conjugate_times, alone.geodesics.at(0).conjugate_times);
  }
}

TEST(SolveMany, SkipsWhatIsNotWanted) {
  ManyOptions some = options(2, 2);
  std::atomic<int> asked{0};
  some.next = [&] { return asked++ == 0 ? 1L : -1L; };
  const auto solved = solve(some, 5);
  ASSERT_EQ(solved.size(), 2U);
  EXPECT_TRUE(solved.contains(2) && solved.contains(3));
}

TEST(SolveMany, StopsWhenTold) {
  ManyOptions stopped = options(2, 1);
  stopped.progress = [](double fraction) { return fraction < 0.2; };
  long sunk = 0;
  EXPECT_FALSE(solve_many(problems(20), stopped, [&](long, auto) { return ++sunk > 0; }));
  EXPECT_LT(sunk, 20);
  sunk = 0;
  EXPECT_FALSE(solve_many(problems(6), options(2, 1), [&](long, auto) { return ++sunk < 2; }));
  EXPECT_EQ(sunk, 2);
}

TEST(SolveMany, HandsOnWhatTheCallerThrows) {
  const auto full = [](long, auto) -> bool { throw std::runtime_error("full"); };
  EXPECT_THROW(solve_many(problems(4), options(2, 1), full), std::runtime_error);
  ManyProblems broken{3, [](long) -> BoundaryValueProblem { throw std::runtime_error("gone"); }};
  EXPECT_THROW(solve_many(broken, options(2, 1), [](long, auto) { return true; }),
               std::runtime_error);
  EXPECT_THROW(solve_many(problems(1), options(1, 0), [](long, auto) { return true; }),
               std::invalid_argument);
}

}  // namespace
}  // namespace carnot::solve_many_test
