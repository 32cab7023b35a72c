// Tapes as machine code against the interpreter: the same bits.
#include "carnot/language/native_tape.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <random>
#include <string>
#include <vector>

#include "carnot/language/expression.h"
#include "testing/tape_on.h"

namespace carnot::native_tape_test {
namespace {

using language::Block;
using language::Expression;
using language::Graph;
using language::kTapeLanes;
using language::Operation;
using language::Tape;

constexpr int kVariables = 9;

// Formulas of formulas. Parts of long ago are used again, so that there are more values than
// registers. `kinds`: 6 of them are arithmetic, 12 all.
std::vector<Expression> drawn_formulas(Graph& graph, int count, int kinds, std::mt19937_64& bits) {
  std::vector<Expression> known;
  for (int i = 0; i < kVariables; ++i) known.push_back(graph.variable(i));
  const auto any = [&]() -> Expression { return known[bits() % known.size()]; };
  const auto coefficient = [&] { return 0.25 * static_cast<double>(bits() % 9) - 1; };
  for (int i = 0; i < count; ++i) {
    const Expression a = any();
    const Expression b = any();
    const Expression c = any();
    const Expression positive = a * a + graph.number(1);
    switch (bits() % kinds) {
      case 0:
        known.push_back(graph.function(Operation::kSqrt, positive));
        break;
      case 1:
        known.push_back(b / positive);
        break;
      case 2:
        known.push_back(graph.power(positive, -2) * c);
        break;
      case 3:
        known.push_back(graph.number(coefficient()) + 0.5 * (a * b));
        break;
      case 6:
        known.push_back(graph.function(Operation::kSin, a));
        break;
      case 7:  // with its sine, where somebody wants that
        known.push_back(graph.function(Operation::kCos, a));
        break;
      case 8:
        known.push_back(graph.atan2(a, b));
        break;
      case 9:
        known.push_back(graph.function(Operation::kTanh, c));
        break;
      case 10:
        known.push_back(graph.stumpff(1, positive));
        break;
      default:
        known.push_back(0.5 * a * b - coefficient() * c + 0.25 * b);
    }
  }
  std::vector<Expression> outputs;
  for (int i = 0; i < 30; ++i) outputs.push_back(any());
  outputs.push_back(graph.number(0.5));
  return outputs;
}

// Calls equal(native, interpreted) for results of formulas at many points.
template <class Equal>
void compare(int count, int kinds, unsigned seed, const Equal& equal) {
  std::mt19937_64 bits(seed);
  Graph graph(kVariables);
  const std::vector<Expression> formulas = drawn_formulas(graph, count, kinds, bits);
  const std::array<Block, 2> inputs{Block{0, kVariables - 2}, Block{kVariables - 2, 2}};
  constexpr int kFirst = 5;  // results in the first group
  const std::array<int, 2> groups{kFirst, static_cast<int>(formulas.size()) - kFirst};
  const Tape tape(graph, inputs, formulas, groups);
  const language::TapeOn<language::WideNumber> interpreted(tape);
  std::uniform_real_distribution<double> number(-1, 1);
  for (int sample = 0; sample < 4; ++sample) {
    std::vector<double> rows(kVariables * kTapeLanes);
    for (double& x : rows) x = number(bits);
    if (sample == 3) rows[5] = INFINITY;
    const std::array<const double*, 2> in{rows.data(), &rows[(kVariables - 2) * kTapeLanes]};
    std::vector<double> native(formulas.size() * kTapeLanes, 7.0);
    std::vector<double> expected = native;
    const auto out = [&](std::vector<double>& to) {
      // Or a group that nobody wants.
      double* const others = sample == 2 ? nullptr : &to[kFirst * kTapeLanes];
      return std::array<double*, 2>{to.data(), others};
    };
    EXPECT_EQ(tape.run_rows(in, out(native)), interpreted.run_rows(in, out(expected)));
    EXPECT_TRUE(std::equal(native.begin(), native.end(), expected.begin(), equal))
        << count << " formulas, seed " << seed << ", tape of " << tape.steps() << " steps";
  }
#if defined(__x86_64__) && defined(__AVX2__) && defined(__FMA__)
  EXPECT_TRUE(interpreted.is_native());
#endif
}

TEST(NativeTape, HasTheBitsOfTheInterpreter) {
  const auto same = [](double a, double b) {
    return std::bit_cast<std::uint64_t>(a) == std::bit_cast<std::uint64_t>(b) ||
           (std::isnan(a) && std::isnan(b));
  };
  for (unsigned seed = 0; seed < 60; ++seed) {
    for (const int count : {3, 30, 300}) compare(count, 6, seed, same);
  }
}

// Functions are the interpreter's own, but the compiler may fuse other operations in them here.
TEST(NativeTape, CallsFunctions) {
  constexpr double kAmplified = 1e-10;  // round-off, by formulas of formulas
  const auto close = [](double a, double b) {
    return std::abs(a - b) <= kAmplified * (1 + std::abs(b)) || (std::isnan(a) && std::isnan(b)) ||
           a == b;
  };
  for (unsigned seed = 0; seed < 60; ++seed) {
    for (const int count : {3, 30, 100}) compare(count, 12, seed, close);
  }
}

// More values at a time than any processor has registers.
TEST(NativeTape, KeepsWhatDoesNotFitIntoRegisters) {
  constexpr int kMany = 100;
  Graph graph(kMany);
  Expression sum = graph.number(0);
  Expression product = graph.number(1);
  for (int i = 0; i < kMany; ++i) sum = sum + graph.variable(i) * graph.variable(kMany - 1 - i);
  for (int i = 0; i < kMany; ++i) {
    product = product * (graph.variable(i) + sum * graph.variable((7 * i) % kMany));
  }
  const std::array<Block, 1> inputs{Block{0, kMany}};
  const std::array<int, 1> groups{2};
  const std::vector<Expression> formulas{sum, product};
  const Tape tape(graph, inputs, formulas, groups);
  const language::TapeOn<language::WideNumber> interpreted(tape);
  std::vector<double> rows;
  for (int i = 0; i < kMany * kTapeLanes; ++i) rows.push_back(0.1 * std::sin(1.7 * i));
  std::array<double, 2 * kTapeLanes> native{};
  std::array<double, 2 * kTapeLanes> expected{};
  EXPECT_TRUE(tape.run_rows(std::array<const double*, 1>{rows.data()},
                            std::array<double*, 1>{native.data()}));
  EXPECT_TRUE(interpreted.run_rows(std::array<const double*, 1>{rows.data()},
                                   std::array<double*, 1>{expected.data()}));
  EXPECT_EQ(native, expected);
}

}  // namespace
}  // namespace carnot::native_tape_test
