// Fields that several processes make together; here they are threads that meet.
#include <gtest/gtest.h>

#include <atomic>
#include <condition_variable>
#include <functional>
#include <mutex>
#include <sstream>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include "carnot/shooting/solve_field.h"
#include "shooting/field_axis.h"
#include "shooting/problems.h"

namespace carnot::field_team_test {
namespace {

using test::axis;

// Where the members of a team hand in what they say, and wait for the others.
class Table {
 public:
  explicit Table(int seats) : said_(seats) {}

  FieldTeam seat(int rank) {
    const auto exchange = [this, rank](const std::string& own) { return meet(rank, own); };
    return {rank, static_cast<int>(said_.size()), exchange};
  }

 private:
  std::vector<std::string> meet(int rank, const std::string& own) {
    std::unique_lock lock(mutex_);
    said_[rank] = own;
    if (++present_ == static_cast<int>(said_.size())) {
      heard_ = said_;
      present_ = 0;
      ++rounds_;
      everybody_.notify_all();
    } else {
      everybody_.wait(lock, [this, round = rounds_] { return rounds_ != round; });
    }
    return heard_;
  }

  std::mutex mutex_;
  std::condition_variable everybody_;
  std::vector<std::string> said_;
  std::vector<std::string> heard_;
  int present_ = 0;
  long rounds_ = 0;
};

FieldOptions quick() {
  FieldOptions options;
  options.check = 4;
  options.threads = 1;
  return options;
}

// As many slabs as pairs of layers; some points are searched after the first spread.
Field vehicles(const FieldOptions& options) {
  return solve_field(
      test::vehicle({0, 0, 0, 0}, {0, 0, 0, 0}),
      {axis(0, -0.4, 0.1, 9), axis(1, -0.4, 0.4, 3), axis(2, -1, 0.5, 5), axis(3, -1, 0.5, 5)},
      options);
}

// Calls solve(options) for each member of a team of this size.
std::vector<Field> together(int size,
                            const std::function<Field(int rank, FieldOptions options)>& solve) {
  Table table(size);
  std::vector<Field> fields(size);
  std::vector<std::thread> members;
  for (int rank = 0; rank < size; ++rank) {
    members.emplace_back([&, rank] {
      FieldOptions options = quick();
      options.team = table.seat(rank);
      fields[rank] = solve(rank, std::move(options));
    });
  }
  for (std::thread& member : members) member.join();
  return fields;
}

void expect_same(const Field& field, const Field& other) {
  ASSERT_TRUE(field.finished);
  EXPECT_EQ(field.action, other.action);
  EXPECT_EQ(field.p0, other.p0);
  EXPECT_EQ(field.error, other.error);
  EXPECT_EQ(field.label, other.label);
  EXPECT_EQ(field.reason, other.reason);
  EXPECT_EQ(field.searches, other.searches);
  EXPECT_EQ(field.pushes, other.pushes);
  EXPECT_EQ(field.improved, other.improved);
  EXPECT_EQ(field.sweeps, other.sweeps);
  EXPECT_EQ(field.unkept, other.unkept);
  EXPECT_EQ(field.triangles, other.triangles);
}

TEST(FieldTeam, MakesTheFieldOfOneProcess) {
  const Field alone = vehicles(quick());
  ASSERT_GT(alone.searches, 16);
  for (const int size : {2, 3}) {
    const auto fields =
        together(size, [](int /*rank*/, const FieldOptions& options) { return vehicles(options); });
    for (const Field& field : fields) expect_same(field, alone);
  }
}

TEST(FieldTeam, KeepsBranches) {
  FieldOptions two = quick();
  two.branches = 2;
  const Field alone = vehicles(two);
  const auto fields = together(2, [](int /*rank*/, FieldOptions options) {
    options.branches = 2;
    return vehicles(options);
  });
  for (const Field& field : fields) expect_same(field, alone);
}

// Whoever is interrupted, and whenever, all of them stop.
TEST(FieldTeam, StopsTogether) {
  for (const int patience : {1, 30, 100}) {
    std::atomic<int> asked{0};
    const auto fields = together(2, [&](int rank, FieldOptions options) {
      if (rank == 1) options.progress = [&](double) { return ++asked < patience; };
      return vehicles(options);
    });
    for (const Field& field : fields) EXPECT_FALSE(field.finished);
  }
}

// The first of them keeps the state, and tells it to the others, who may be more.
TEST(FieldTeam, GoesOnFromTheStateOfItsFirst) {
  std::vector<std::string> states;
  const auto whole = together(2, [&](int rank, FieldOptions options) {
    options.keep = [&states, rank](const auto& write) {
      EXPECT_EQ(rank, 0);
      std::ostringstream text;
      write(text);
      states.push_back(text.str());
    };
    return vehicles(options);
  });
  ASSERT_GT(states.size(), 8U);
  for (const std::size_t k : {states.size() / 3, states.size() - 2}) {
    std::istringstream text(states[k]);
    const auto fields = together(3, [&](int rank, FieldOptions options) {
      if (rank == 0) options.state = &text;
      return vehicles(options);
    });
    for (const Field& field : fields) {
      EXPECT_GT(field.resumed, 0);
      EXPECT_EQ(field.action, whole[0].action);
      EXPECT_EQ(field.p0, whole[0].p0);
    }
  }
  std::istringstream damaged(states.back().substr(1));
  std::atomic<int> refused{0};
  (void)together(2, [&](int rank, FieldOptions options) {
    if (rank == 0) options.state = &damaged;
    EXPECT_THROW(vehicles(options), DamagedState);
    ++refused;
    return Field{};
  });
  EXPECT_EQ(refused, 2);
}

// As if one of them had come to another decision, and shared once more.
TEST(FieldTeam, TellsWhereItsMembersDisagree) {
  FieldOptions options = quick();
  options.team = {0, 2, [](const std::string& own) {
                    std::string other = own;
                    ++other[0];
                    return std::vector{own, other};
                  }};
  EXPECT_THROW(vehicles(options), std::runtime_error);
}

TEST(FieldTeam, RefusesRanksBeyondItsSize) {
  FieldOptions options = quick();
  options.team.rank = 1;
  EXPECT_THROW(vehicles(options), std::invalid_argument);
  options.team.size = 2;
  EXPECT_THROW(vehicles(options), std::invalid_argument);
}

}  // namespace
}  // namespace carnot::field_team_test
