// Small matrices of expressions, and factors of them without pivots.
#pragma once

#include <optional>
#include <utility>
#include <vector>

#include "carnot/language/expression.h"
#include "carnot/system/rate_status.h"

namespace carnot::language {

struct SymbolicMatrix {
  SymbolicMatrix() = default;
  SymbolicMatrix(Graph& graph, int row_count, int column_count)
      : rows(row_count),
        columns(column_count),
        entries(static_cast<std::size_t>(row_count * column_count), graph.number(0)) {}

  Expression& operator()(int i, int j) { return entries[i * columns + j]; }
  const Expression& operator()(int i, int j) const { return entries[i * columns + j]; }

  int rows = 0;
  int columns = 0;
  std::vector<Expression> entries{};
};

using SymbolicVector = std::vector<Expression>;

SymbolicMatrix identity(Graph& graph, int size);
SymbolicMatrix transposed(Graph& graph, const SymbolicMatrix& a);
SymbolicMatrix product(Graph& graph, const SymbolicMatrix& a, const SymbolicMatrix& b);
SymbolicVector product(Graph& graph, const SymbolicMatrix& a, const SymbolicVector& x);
SymbolicVector transposed_product(Graph& graph, const SymbolicMatrix& a, const SymbolicVector& x);
Expression dot(Graph& graph, const SymbolicVector& a, const SymbolicVector& b);

// What must be greater than zero for a formula to mean anything, and what is wrong where it is not.
struct Check {
  Expression value;
  RateStatus status = RateStatus::kOk;
};

// A = L D L' of a symmetric matrix that is to be positive definite: straight-line, in the form of
// numerics/cholesky.h. Two by two, the inverse is the adjugate over the determinant: one division.
// Only what is at or below the diagonal of `a` is read.
class SymbolicCholesky {
 public:
  SymbolicCholesky(Graph& graph, const SymbolicMatrix& a);

  [[nodiscard]] SymbolicVector solve(const SymbolicVector& b) const;
  // That the pivots are positive to round-off, but for those that are constants and are.
  void add_checks(RateStatus status, std::vector<Check>& checks) const;
  // Whether they are, at every point: no pivot depends on one.
  [[nodiscard]] bool always_positive() const;

 private:
  // That of two rows.
  void factor_two(const SymbolicMatrix& a);

  Graph* graph_;
  std::optional<SymbolicMatrix> adjugate_;  // over the determinant, of two rows
  SymbolicMatrix lower_;
  SymbolicVector inverses_;
  SymbolicVector slack_;  // each pivot minus what would be round-off
};

// d f / d (block), n of them.
SymbolicVector gradient(Graph& graph, const Expression& f, int first, int count);
// d a_i / d (block).
SymbolicMatrix jacobian(Graph& graph, const SymbolicVector& a, int first, int count);

// B with G B = 0, as many columns as G leaves free, by elimination. A row with a constant entry
// gives the velocity of its column, and a row of one entry says that a velocity is zero. A row of
// two entries (a, b) leaves (-b, a), and a row of four, a quaternion r, leaves i r, j r and k r, or
// r i, r j and r k. Rows that are orthogonal whatever the attitude, such as the rates of a body and
// the norm of its quaternion, have one entry each then. Nothing where no such row is left. Where
// the entries of a row vanish together, which `checks` tell, G loses rank.
std::optional<SymbolicMatrix> frame_of(Graph& graph,
                                       const SymbolicMatrix& constraints,
                                       std::vector<Check>& checks);

}  // namespace carnot::language
