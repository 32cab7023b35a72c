// Formulas in their normal form: what is the same, derivatives against differences, what is
// refused.
#include "carnot/language/expression.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <limits>
#include <random>
#include <string>
#include <vector>

namespace carnot::expression_test {
namespace {

using language::Expression;
using language::Graph;
using language::Operation;

constexpr double kEps = std::numeric_limits<double>::epsilon();

class ExpressionTest : public ::testing::Test {
 protected:
  Graph graph_{4};
  Expression x_ = graph_.variable(0);
  Expression y_ = graph_.variable(1);
  Expression z_ = graph_.variable(2);

  Expression sin(const Expression& a) { return graph_.function(Operation::kSin, a); }
  Expression cos(const Expression& a) { return graph_.function(Operation::kCos, a); }
  Expression sqrt(const Expression& a) { return graph_.function(Operation::kSqrt, a); }
  Expression number(double x) { return graph_.number(x); }
  static bool same(const Expression& a, const Expression& b) {
    return a.coefficient == b.coefficient && (a.node == b.node || a.is_zero());
  }
};

TEST_F(ExpressionTest, EqualFormulasAreOneNode) {
  EXPECT_TRUE(same(x_ + x_, 2 * x_));
  EXPECT_TRUE((x_ * y_ - y_ * x_).is_zero());
  EXPECT_TRUE(same(x_ * y_ / x_, y_));
  EXPECT_TRUE(same(graph_.power(x_, 2) * x_, graph_.power(x_, 3)));
  EXPECT_TRUE(same(sin(-x_), -sin(x_)));
  EXPECT_TRUE(same(cos(-x_), cos(x_)));
  EXPECT_TRUE(same(sin(y_ - x_), -sin(x_ - y_)));
  EXPECT_TRUE(same(graph_.power(sqrt(x_), 2), x_));
  EXPECT_TRUE(same(graph_.power(sqrt(x_), 5), graph_.power(x_, 2) * sqrt(x_)));
  EXPECT_TRUE(same(graph_.power(x_, 0.5), sqrt(x_)));
  EXPECT_TRUE(same(x_ * y_ + x_ * z_, x_ * (y_ + z_)));
}

TEST_F(ExpressionTest, ConstantsAreFolded) {
  EXPECT_TRUE((number(2) * number(3) + number(1)).is(7));
  EXPECT_TRUE(sin(number(0)).is(0));
  EXPECT_TRUE(cos(x_ - x_).is(1));
  EXPECT_TRUE((x_ / x_).is(1));
  EXPECT_TRUE(graph_.power(x_, 0).is(1));
  EXPECT_TRUE(graph_.atan2(number(1), number(1)).is(std::atan2(1, 1)));
}

TEST_F(ExpressionTest, TheoremsOfSinesAndCosines) {
  const Expression s = sin(x_);
  const Expression c = cos(x_);
  EXPECT_TRUE((s * s + c * c).is(1));
  EXPECT_TRUE(same(3 * y_ * s * s + 3 * y_ * c * c, 3 * y_));
  EXPECT_TRUE(same(s * cos(y_) - c * sin(y_), sin(x_ - y_)));
  EXPECT_TRUE(same(s * cos(y_) + c * sin(y_), sin(x_ + y_)));
  EXPECT_TRUE(same(c * cos(y_) + s * sin(y_), cos(x_ - y_)));
  EXPECT_TRUE(same(c * cos(y_) - s * sin(y_), cos(x_ + y_)));
  EXPECT_TRUE(same(sin(x_ + y_) - s * cos(y_), c * sin(y_)));
  EXPECT_TRUE(same(cos(x_ - y_) - c * cos(y_), s * sin(y_)));
  // What a chain of trailers makes.
  EXPECT_TRUE(same(sin(x_ - z_) - cos(y_ - z_) * sin(x_ - y_), cos(x_ - y_) * sin(y_ - z_)));
  // Other factors, and other signs, are left alone.
  EXPECT_FALSE((2 * s * s + c * c).is_constant());
  EXPECT_FALSE((s * s - c * c).is_constant());
}

TEST_F(ExpressionTest, TheCosineOfARootIsSmoothAtZero) {
  const Expression r = sqrt(graph_.power(x_, 2) + graph_.power(y_, 2));
  const std::array<double, 4> origin{};
  for (const Expression& e : {cos(r), sin(r) / r}) {
    EXPECT_EQ(graph_.evaluate(e, origin), 1);
    const Expression slope = graph_.derivative(e, 0);
    EXPECT_EQ(graph_.evaluate(slope, origin), 0);
    const double second = graph_.evaluate(graph_.derivative(slope, 0), origin);
    EXPECT_NEAR(second, e.node == cos(r).node ? -1 : -1.0 / 3, kEps);
  }
}

// Random formulas without poles, roots or logarithms of what may be negative.
class RandomFormula {
 public:
  RandomFormula(Graph& graph, unsigned seed) : graph_(graph), bits_(seed) {}

  Expression make(int depth) {
    const int kind = depth == 0 ? pick(2) : pick(12);
    if (kind == 0) return graph_.number(pick(7) - 3);
    if (kind == 1) return graph_.variable(pick(4));
    const Expression a = make(depth - 1);
    const Expression positive = graph_.number(1) + a * a;
    switch (kind) {
      case 2:
      case 3:
        return a + make(depth - 1);
      case 4:
        return a - make(depth - 1);
      case 5:
      case 6:
        return a * make(depth - 1);
      case 7:
        return make(depth - 1) / positive;
      case 8:
        return graph_.function(Operation::kSqrt, positive);
      case 9:
        return graph_.function(Operation::kLog, positive);
      case 10:
        return graph_.atan2(a, positive);
      default: {
        constexpr std::array kFunctions{
            Operation::kSin, Operation::kCos, Operation::kTanh, Operation::kAtan};
        return graph_.function(kFunctions[pick(4)], a);
      }
    }
  }

 private:
  int pick(int count) { return static_cast<int>(bits_() % static_cast<unsigned>(count)); }
  Graph& graph_;
  std::mt19937 bits_;
};

// Against central differences with an error of h^4; h = 1e-3 leaves 1e-11 of truncation and
// round-off each, in derivatives of size one.
TEST(RandomExpressions, DerivativesAgreeWithDifferences) {
  constexpr double kStep = 1e-3;
  constexpr double kTolerance = 1e-7;  // fifth derivatives of nested formulas are large
  for (unsigned seed = 1; seed <= 200; ++seed) {
    Graph graph(4);
    const Expression e = RandomFormula(graph, seed).make(4);
    std::array<double, 4> at{0.3, -0.7, 0.9, 0.2};
    for (int v = 0; v < 4; ++v) {
      const double slope = graph.evaluate(graph.derivative(e, v), at);
      const auto value = [&](double step) {
        std::array<double, 4> moved = at;
        moved[v] += step;
        return graph.evaluate(e, moved);
      };
      const double near = (value(kStep) - value(-kStep)) / (2 * kStep);
      const double far = (value(2 * kStep) - value(-2 * kStep)) / (4 * kStep);
      const double difference = (4 * near - far) / 3;
      EXPECT_NEAR(slope, difference, kTolerance * (1 + std::abs(slope)))
          << "seed " << seed << " variable " << v;
    }
  }
}

TEST(RandomExpressions, SubstitutionIsComposition) {
  for (unsigned seed = 1; seed <= 100; ++seed) {
    Graph graph(4);
    RandomFormula random(graph, seed);
    const Expression e = random.make(3);
    const std::vector<Expression> inner{random.make(2), random.make(2)};
    std::array<double, 4> at{0.3, -0.7, 0.9, 0.2};
    const double composed = graph.evaluate(graph.substitute(e, 1, inner), at);
    std::array<double, 4> moved = at;
    moved[1] = graph.evaluate(inner[0], at);
    moved[2] = graph.evaluate(inner[1], at);
    const double expected = graph.evaluate(e, moved);
    EXPECT_NEAR(composed, expected, 1e4 * kEps * (1 + std::abs(expected))) << seed;
    EXPECT_FALSE(graph.depends(graph.substitute(e, 1, std::vector{graph.number(2)}), 1, 1)) << seed;
  }
}

TEST_F(ExpressionTest, RefusesWhatIsNotFinite) {
  EXPECT_THROW(number(std::nan("")), language::NotFinite);
  EXPECT_THROW(graph_.function(Operation::kLog, number(-1)), language::NotFinite);
  EXPECT_THROW(number(1e308) * number(1e308) + x_, language::NotFinite);
}

TEST(Expressions, GrowOnlySoFar) {
  Graph graph(2, 100);
  const Expression x = graph.variable(0);
  Expression e = x;
  const auto grow = [&] {
    for (int i = 1; i < 200; ++i) e = graph.function(Operation::kTanh, e + graph.number(i));
  };
  EXPECT_THROW(grow(), language::TooLarge);
}

TEST_F(ExpressionTest, AWholeIsNotTakenApart) {
  const Expression whole = graph_.whole(x_ * y_);
  EXPECT_FALSE(same(whole * x_, graph_.power(x_, 2) * y_));
  const std::array<double, 4> at{2, 3, 5, 7};
  EXPECT_EQ(graph_.evaluate(whole * x_, at), 12);
  EXPECT_EQ(graph_.evaluate(graph_.derivative(whole * x_, 0), at), 12);
}

}  // namespace
}  // namespace carnot::expression_test
