// Tapes against the graph that they are made of: at one point, and at many side by side.
#include "carnot/language/tape.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <random>
#include <string>
#include <thread>
#include <vector>

namespace carnot::tape_test {
namespace {

using language::Block;
using language::Expression;
using language::Graph;
using language::kTapeLanes;
using language::Operation;
using language::Tape;

constexpr double kEps = std::numeric_limits<double>::epsilon();
constexpr int kVariables = 5;

// All operations, shared parts, constants, results that are variables, and results twice.
std::vector<Expression> formulas(Graph& graph) {
  const auto v = [&](int i) { return graph.variable(i); };
  const auto f = [&](Operation operation, const Expression& a) {
    return graph.function(operation, a);
  };
  const Expression s = f(Operation::kSin, v(0) - v(1));
  const Expression c = f(Operation::kCos, v(0) - v(1));
  const Expression square = graph.power(v(2), 2) + graph.number(1);
  std::vector<Expression> all{s * v(2) + c * v(3),
                              f(Operation::kSin, v(4)),
                              f(Operation::kCos, 2 * v(4)),
                              v(1) / square,
                              v(3) / square + v(4) / square,
                              f(Operation::kSqrt, square),
                              f(Operation::kExp, -square),
                              f(Operation::kLog, square),
                              f(Operation::kSinh, v(0)),
                              f(Operation::kCosh, v(1)),
                              f(Operation::kTanh, v(2)),
                              f(Operation::kAsin, 0.5 * v(0)),
                              f(Operation::kAcos, 0.5 * v(1)),
                              f(Operation::kAtan, v(3) - v(2)),
                              graph.atan2(v(0), v(1)),
                              graph.stumpff(0, square),
                              graph.stumpff(3, square),
                              graph.power(v(0), 5) - 3 * graph.power(v(1), 3) * v(2),
                              graph.number(0),
                              graph.number(2.5),
                              v(3),
                              v(3),
                              -v(4),
                              graph.power(square, -3) * v(0)};
  all.push_back(graph.whole(all[0]) * all[1] - 2 * graph.whole(all[0]));
  return all;
}

class TapeTest : public ::testing::Test {
 protected:
  TapeTest() : formulas_(formulas(graph_)) {
    const std::array<Block, 2> inputs{Block{0, 3}, Block{3, 2}};
    const std::array<int, 2> groups{4, static_cast<int>(formulas_.size()) - 4};
    tape_ = Tape(graph_, inputs, formulas_, groups);
  }

  // Rows of points; lane l of row i.
  static std::vector<double> points(unsigned seed) {
    std::mt19937_64 bits(seed);
    std::uniform_real_distribution<double> number(-1, 1);
    std::vector<double> rows(kVariables * kTapeLanes);
    for (double& x : rows) x = number(bits);
    return rows;
  }

  Graph graph_{kVariables};
  std::vector<Expression> formulas_;
  Tape tape_;
};

// A term of a product rounds once more or less; sines of packs are good to 2 ulp.
constexpr double kRoundOff = 16 * kEps;

TEST_F(TapeTest, ComputesTheFormulas) {
  for (unsigned seed = 1; seed <= 20; ++seed) {
    const std::vector<double> rows = points(seed);
    std::array<double, kVariables> x;
    for (int i = 0; i < kVariables; ++i) x[i] = rows[i * kTapeLanes];
    std::vector<double> out(formulas_.size());
    EXPECT_TRUE(tape_.run(std::array<const double*, 2>{x.data(), x.data() + 3},
                          std::array<double*, 2>{out.data(), out.data() + 4}));
    for (std::size_t i = 0; i < out.size(); ++i) {
      const double expected = graph_.evaluate(formulas_[i], x);
      EXPECT_NEAR(out[i], expected, kRoundOff * (1 + std::abs(expected))) << "formula " << i;
    }
  }
}

TEST_F(TapeTest, ComputesManyPointsSideBySide) {
  const std::vector<double> rows = points(7);
  std::vector<double> out(formulas_.size() * kTapeLanes);
  EXPECT_TRUE(
      tape_.run_rows(std::array<const double*, 2>{rows.data(), rows.data() + 3 * kTapeLanes},
                     std::array<double*, 2>{out.data(), out.data() + 4 * kTapeLanes}));
  for (int l = 0; l < kTapeLanes; ++l) {
    std::array<double, kVariables> x;
    for (int i = 0; i < kVariables; ++i) x[i] = rows[i * kTapeLanes + l];
    for (std::size_t i = 0; i < formulas_.size(); ++i) {
      const double expected = graph_.evaluate(formulas_[i], x);
      EXPECT_NEAR(out[i * kTapeLanes + l], expected, kRoundOff * (1 + std::abs(expected)))
          << "formula " << i << " lane " << l;
    }
  }
}

TEST_F(TapeTest, GroupsThatNobodyWantsMayBeMissing) {
  std::vector<double> x = points(3);
  std::vector<double> out(formulas_.size(), -7.0);
  EXPECT_TRUE(tape_.run(std::array<const double*, 2>{x.data(), x.data() + 3},
                        std::array<double*, 2>{out.data(), nullptr}));
  EXPECT_NE(out[0], -7.0);
  EXPECT_EQ(out[4], -7.0);
}

TEST_F(TapeTest, SaysWhereAResultIsNotFinite) {
  std::vector<double> rows = points(4);
  rows[2 * kTapeLanes + 5] = std::numeric_limits<double>::infinity();
  std::vector<double> out(formulas_.size() * kTapeLanes);
  const std::array<double*, 2> to{out.data(), out.data() + 4 * kTapeLanes};
  EXPECT_FALSE(
      tape_.run_rows(std::array<const double*, 2>{rows.data(), rows.data() + 3 * kTapeLanes}, to));
}

// The same bits on every run, whoever runs beside.
TEST_F(TapeTest, ThreadsDoNotDisturbEachOther) {
  constexpr int kThreads = 4;
  const std::vector<double> rows = points(5);
  const auto result = [&] {
    std::vector<double> out(formulas_.size() * kTapeLanes);
    for (int i = 0; i < 200; ++i) {
      (void)tape_.run_rows(std::array<const double*, 2>{rows.data(), rows.data() + 3 * kTapeLanes},
                           std::array<double*, 2>{out.data(), out.data() + 4 * kTapeLanes});
    }
    return out;
  };
  const std::vector<double> expected = result();
  std::vector<std::vector<double>> results(kThreads);
  std::vector<std::thread> threads;
  for (int i = 0; i < kThreads; ++i) threads.emplace_back([&, i] { results[i] = result(); });
  for (std::thread& thread : threads) thread.join();
  for (const auto& other : results) EXPECT_EQ(other, expected);
}

// More results at a time than a call takes of the stack.
TEST(LongTape, HasRoomForManySlots) {
  constexpr int kMany = 600;
  Graph graph(1);
  const Expression x = graph.variable(0);
  std::vector<Expression> all;
  for (int i = 0; i < kMany; ++i) {
    all.push_back(graph.function(Operation::kTanh, x + graph.number(i)));
  }
  const std::array<Block, 1> inputs{Block{0, 1}};
  const std::array<int, 1> groups{kMany};
  const Tape tape(graph, inputs, all, groups);
  EXPECT_GE(tape.slots(), kMany);
  std::array<double, kTapeLanes> at{0, 1, 2, 3, 4, 5, 6, 7};
  std::vector<double> out(kMany * kTapeLanes);
  EXPECT_TRUE(
      tape.run_rows(std::array<const double*, 1>{at.data()}, std::array<double*, 1>{out.data()}));
  for (int i = 0; i < kMany; ++i) {
    for (int l = 0; l < kTapeLanes; ++l) {
      EXPECT_NEAR(out[i * kTapeLanes + l], std::tanh(l + i), kRoundOff);
    }
  }
}

}  // namespace
}  // namespace carnot::tape_test
