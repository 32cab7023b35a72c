// The interpreter of tapes on registers of every width that this machine has, not only the widest.
#include "carnot/language/tape_machine.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <limits>
#include <string>
#include <vector>
#include <xsimd/xsimd.hpp>

#include "carnot/language/expression.h"
#include "testing/tape_on.h"

namespace carnot::tape_machine_test {
namespace {

using language::Block;
using language::Expression;
using language::Graph;
using language::kTapeLanes;
using language::Operation;
using language::Tape;

constexpr double kEps = std::numeric_limits<double>::epsilon();

template <class V>
class TapeMachineTest : public ::testing::Test {};

using Registers = ::testing::Types<double
#if XSIMD_WITH_SSE2
                                   ,
                                   xsimd::batch<double, xsimd::sse2>
#endif
#if XSIMD_WITH_AVX
                                   ,
                                   xsimd::batch<double, xsimd::avx>
#endif
#if XSIMD_WITH_AVX2
                                   ,
                                   xsimd::batch<double, xsimd::avx2>
#endif
                                   >;

struct RegisterNames {
  template <class V>
  static std::string GetName(int i) {
    return "register" + std::to_string(i) + "_of_" + std::to_string(pack_lane::Ops<V>::kSize);
  }
};
TYPED_TEST_SUITE(TapeMachineTest, Registers, RegisterNames);

TYPED_TEST(TapeMachineTest, ComputesTheFormulas) {
  Graph graph(3);
  const Expression x = graph.variable(0);
  const Expression y = graph.variable(1);
  const Expression z = graph.variable(2);
  const auto f = [&](Operation operation, const Expression& a) {
    return graph.function(operation, a);
  };
  const Expression square = x * x + graph.number(1);
  const std::vector<Expression> formulas{f(Operation::kSin, x) * y + f(Operation::kCos, x) * z,
                                         y / square - 2 * (z / square),
                                         graph.power(y, 3) - x,
                                         f(Operation::kSqrt, square),
                                         f(Operation::kExp, y),
                                         f(Operation::kTanh, z),
                                         graph.atan2(y, z),
                                         graph.stumpff(1, square),
                                         graph.number(3),
                                         x};
  const std::array<Block, 1> inputs{Block{0, 3}};
  const std::array<int, 1> groups{static_cast<int>(formulas.size())};
  const Tape tape(graph, inputs, formulas, groups);
  const language::TapeOn<TypeParam> machine(tape);
  std::vector<double> rows;
  for (int i = 0; i < 3 * kTapeLanes; ++i) rows.push_back(std::sin(1.7 * i));
  std::vector<double> out(formulas.size() * kTapeLanes);
  EXPECT_TRUE(machine.run_rows(std::array<const double*, 1>{rows.data()},
                               std::array<double*, 1>{out.data()}));
  for (int l = 0; l < kTapeLanes; ++l) {
    const std::array<double, 3> at{rows[l], rows[kTapeLanes + l], rows[2 * kTapeLanes + l]};
    for (std::size_t i = 0; i < formulas.size(); ++i) {
      const double expected = graph.evaluate(formulas[i], at);
      // Sines of packs are good to 2 ulp, sums of them to a few.
      EXPECT_NEAR(out[i * kTapeLanes + l], expected, 16 * kEps * (1 + std::abs(expected)))
          << "formula " << i << " lane " << l;
    }
  }
  rows[5] = std::nan("");
  EXPECT_FALSE(machine.run_rows(std::array<const double*, 1>{rows.data()},
                                std::array<double*, 1>{out.data()}));
}

}  // namespace
}  // namespace carnot::tape_machine_test
