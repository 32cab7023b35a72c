// Frames of constraints by elimination: what they leave free is orthogonal to every row, and
// nothing is lost.
#include "carnot/language/symbolic_matrix.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>
#include <optional>
#include <random>
#include <vector>

#include "carnot/numerics/jacobi_rotations.h"

namespace carnot::symbolic_matrix_test {
namespace {

using language::Check;
using language::Expression;
using language::Graph;
using language::SymbolicMatrix;
using language::SymbolicVector;

class FrameTest : public ::testing::Test {
 protected:
  static constexpr int kVariables = 6;

  Graph graph_{kVariables};
  Expression w_ = graph_.variable(0);
  Expression x_ = graph_.variable(1);
  Expression y_ = graph_.variable(2);
  Expression z_ = graph_.variable(3);

  // Rows of q' that vanish with the rates of a body about its own axes, about the axes of space,
  // and with the rate of |q|^2.
  const std::vector<SymbolicVector> body_{
      {-x_, w_, z_, -y_}, {-y_, -z_, w_, x_}, {-z_, y_, -x_, w_}};
  const std::vector<SymbolicVector> space_{
      {-x_, w_, -z_, y_}, {-y_, z_, w_, -x_}, {-z_, -y_, x_, w_}};
  const SymbolicVector norm_{w_, x_, y_, z_};

  SymbolicMatrix matrix(const std::vector<SymbolicVector>& rows) {
    SymbolicMatrix m(graph_, static_cast<int>(rows.size()), static_cast<int>(rows[0].size()));
    for (int i = 0; i < m.rows; ++i) {
      for (int j = 0; j < m.columns; ++j) m(i, j) = rows[i][j];
    }
    return m;
  }

  // The entries at a point, column by column.
  std::vector<double> at(const std::array<double, kVariables>& point, const SymbolicMatrix& m) {
    std::vector<double> values;
    for (int j = 0; j < m.columns; ++j) {
      for (int i = 0; i < m.rows; ++i) values.push_back(graph_.evaluate(m(i, j), point));
    }
    return values;
  }

  static double norm(const std::vector<double>& x) {
    return std::sqrt(std::inner_product(x.begin(), x.end(), x.begin(), 0.0));
  }

  // Of a matrix with this many columns.
  static std::vector<double> singular_values(std::vector<double> a, int columns) {
    const int rows = static_cast<int>(a.size()) / columns;
    std::vector<double> turned(columns * columns);
    EXPECT_TRUE(orthogonalise_columns(rows, columns, a.data(), turned.data()));
    std::vector<double> sizes;
    for (auto column = a.begin(); column != a.end(); column += rows) {
      sizes.push_back(norm({column, column + rows}));
    }
    return sizes;
  }

  // As many columns as G leaves free, independent, with G B = 0, wherever the checks hold.
  void expect_frame(const std::vector<SymbolicVector>& rows) {
    constexpr double kZero = 100 * std::numeric_limits<double>::epsilon();  // of sums of products
    constexpr double kIndependent = 1e-3;
    const SymbolicMatrix g = matrix(rows);
    std::vector<Check> checks;
    const auto frame = language::frame_of(graph_, g, checks);
    ASSERT_TRUE(frame);
    ASSERT_EQ(frame->columns, g.columns - g.rows);
    std::mt19937_64 random(3);
    std::normal_distribution<double> normal;
    for (int trial = 0; trial < 20; ++trial) {
      std::array<double, kVariables> point;
      for (double& value : point) value = normal(random);
      const std::vector<double> b = at(point, *frame);
      const std::vector<double> values = at(point, g);
      std::vector<double> products;
      for (int i = 0; i < g.rows; ++i) {
        for (int j = 0; j < frame->columns; ++j) {
          double sum = 0;
          for (int k = 0; k < g.columns; ++k) {
            sum += values[k * g.rows + i] * b[j * frame->rows + k];
          }
          products.push_back(sum);
        }
      }
      EXPECT_LE(norm(products), kZero * norm(values) * norm(b));
      const std::vector<double> sizes = singular_values(b, frame->columns);
      const auto [least, most] = std::minmax_element(sizes.begin(), sizes.end());
      EXPECT_GT(*least, kIndependent * *most);
      for (const Check& check : checks) EXPECT_GT(graph_.evaluate(check.value, point), 0);
    }
    // At the origin all these rows vanish.
    const std::array<double, kVariables> origin{};
    bool told = false;
    for (const Check& check : checks) told = told || !(graph_.evaluate(check.value, origin) > 0);
    EXPECT_TRUE(told);
  }
};

TEST_F(FrameTest, OfAttitudesAsQuaternions) {
  for (const auto& rates : {body_, space_}) {
    for (const SymbolicVector& rate : rates) {
      expect_frame({rate, norm_});
      expect_frame({norm_, rate});
    }
    expect_frame({rates[0], rates[1], norm_});
    expect_frame({rates[2], norm_, rates[0]});
    expect_frame({rates[0], rates[1]});
  }
}

TEST_F(FrameTest, OfABallThatRolls) {
  const Expression none = graph_.number(0);
  const Expression one = graph_.number(1);
  const auto row = [&](const Expression& x, const Expression& y, const SymbolicVector& rest) {
    return SymbolicVector{x, y, rest[0], rest[1], rest[2], rest[3]};
  };
  expect_frame({row(none, one, space_[0]),
                row(-one, none, space_[1]),
                row(none, none, space_[2]),
                row(none, none, norm_)});
}

TEST_F(FrameTest, OfPairs) { expect_frame({{x_, y_, graph_.number(0)}}); }

// A row of four alone, and rows of three, are left to multipliers.
TEST_F(FrameTest, IsNotLookedForWhereItIsNoUse) {
  std::vector<Check> checks;
  EXPECT_FALSE(language::frame_of(graph_, matrix({norm_}), checks));
  EXPECT_FALSE(language::frame_of(graph_, matrix({{x_, y_, z_}}), checks));
  EXPECT_TRUE(checks.empty());
}

}  // namespace
}  // namespace carnot::symbolic_matrix_test
