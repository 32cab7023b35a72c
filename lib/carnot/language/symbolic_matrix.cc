#include "carnot/language/symbolic_matrix.h"

#include <algorithm>
#include <cmath>

#include "carnot/numerics/round_off.h"

namespace carnot::language {

SymbolicMatrix identity(Graph& graph, int size) {
  SymbolicMatrix result(graph, size, size);
  for (int i = 0; i < size; ++i) result(i, i) = graph.number(1);
  return result;
}

SymbolicMatrix transposed(Graph& graph, const SymbolicMatrix& a) {
  SymbolicMatrix result(graph, a.columns, a.rows);
  for (int i = 0; i < a.rows; ++i) {
    for (int j = 0; j < a.columns; ++j) result(j, i) = a(i, j);
  }
  return result;
}

SymbolicMatrix product(Graph& graph, const SymbolicMatrix& a, const SymbolicMatrix& b) {
  SymbolicMatrix result(graph, a.rows, b.columns);
  for (int i = 0; i < a.rows; ++i) {
    for (int j = 0; j < b.columns; ++j) {
      SymbolicVector terms;
      for (int l = 0; l < a.columns; ++l) terms.push_back(a(i, l) * b(l, j));
      result(i, j) = graph.sum(terms);
    }
  }
  return result;
}

SymbolicVector product(Graph& graph, const SymbolicMatrix& a, const SymbolicVector& x) {
  SymbolicVector result;
  for (int i = 0; i < a.rows; ++i) {
    SymbolicVector terms;
    for (int j = 0; j < a.columns; ++j) terms.push_back(a(i, j) * x[j]);
    result.push_back(graph.sum(terms));
  }
  return result;
}

SymbolicVector transposed_product(Graph& graph, const SymbolicMatrix& a, const SymbolicVector& x) {
  return product(graph, transposed(graph, a), x);
}

Expression dot(Graph& graph, const SymbolicVector& a, const SymbolicVector& b) {
  SymbolicVector terms;
  for (std::size_t i = 0; i < a.size(); ++i) terms.push_back(a[i] * b[i]);
  return graph.sum(terms);
}

SymbolicCholesky::SymbolicCholesky(Graph& graph, const SymbolicMatrix& a)
    : graph_(&graph), lower_(identity(graph, a.rows)) {
  const int n = a.rows;
  if (n == 2 && !a(1, 0).is_zero()) {
    factor_two(a);
    return;
  }
  const auto threshold = pivot_round_off<double>(n);
  SymbolicVector pivots;
  for (int j = 0; j < n; ++j) {
    SymbolicVector terms{a(j, j)};
    for (int k = 0; k < j; ++k) terms.push_back(-(lower_(j, k) * lower_(j, k) * pivots[k]));
    pivots.push_back(graph.sum(terms));
    slack_.push_back(j == 0 ? pivots[0] : pivots[j] - threshold * a(j, j));
    if (pivots[j].is_zero()) {  // it says so; a division by zero would not
      inverses_.push_back(graph.number(1));
      continue;
    }
    inverses_.push_back(graph.power(pivots[j], -1));
    for (int i = j + 1; i < n; ++i) {
      SymbolicVector sum{a(i, j)};
      for (int k = 0; k < j; ++k) sum.push_back(-(lower_(i, k) * lower_(j, k) * pivots[k]));
      lower_(i, j) = graph.sum(sum) * inverses_[j];
    }
  }
}

void SymbolicCholesky::factor_two(const SymbolicMatrix& a) {
  const Expression product = a(0, 0) * a(1, 1);
  const Expression determinant = product - a(1, 0) * a(1, 0);
  slack_ = {a(0, 0), determinant - pivot_round_off<double>(2) * product};
  // Where it vanishes the check says so; a division by zero would not.
  const Expression inverse =
      determinant.is_zero() ? graph_->number(1) : graph_->whole(graph_->power(determinant, -1));
  adjugate_.emplace(*graph_, 2, 2);
  (*adjugate_)(0, 0) = a(1, 1) * inverse;
  (*adjugate_)(1, 1) = a(0, 0) * inverse;
  (*adjugate_)(0, 1) = -(a(1, 0) * inverse);
  (*adjugate_)(1, 0) = (*adjugate_)(0, 1);
}

SymbolicVector SymbolicCholesky::solve(const SymbolicVector& b) const {
  if (adjugate_) return product(*graph_, *adjugate_, b);
  SymbolicVector x = b;
  const int n = lower_.rows;
  for (int i = 1; i < n; ++i) {
    SymbolicVector terms{x[i]};
    for (int k = 0; k < i; ++k) terms.push_back(-(lower_(i, k) * x[k]));
    x[i] = graph_->sum(terms);
  }
  for (int i = 0; i < n; ++i) x[i] = x[i] * inverses_[i];
  for (int i = n - 2; i >= 0; --i) {
    SymbolicVector terms{x[i]};
    for (int k = i + 1; k < n; ++k) terms.push_back(-(lower_(k, i) * x[k]));
    x[i] = graph_->sum(terms);
  }
  return x;
}

void SymbolicCholesky::add_checks(RateStatus status, std::vector<Check>& checks) const {
  for (const Expression& slack : slack_) {
    if (slack.is_constant() && slack.coefficient > 0) continue;
    checks.push_back({slack, status});
  }
}

bool SymbolicCholesky::always_positive() const {
  return std::all_of(slack_.begin(), slack_.end(), [](const Expression& slack) {
    return slack.is_constant() && slack.coefficient > 0;
  });
}

SymbolicVector gradient(Graph& graph, const Expression& f, int first, int count) {
  SymbolicVector result;
  for (int i = 0; i < count; ++i) result.push_back(graph.derivative(f, first + i));
  return result;
}

SymbolicMatrix jacobian(Graph& graph, const SymbolicVector& a, int first, int count) {
  SymbolicMatrix result(graph, static_cast<int>(a.size()), count);
  for (int i = 0; i < result.rows; ++i) {
    for (int j = 0; j < count; ++j) result(i, j) = graph.derivative(a[i], first + j);
  }
  return result;
}

namespace {

// The velocities as linear functions of fewer and fewer free ones: v = B w at any time.
class Elimination {
 public:
  Elimination(Graph& graph, const SymbolicMatrix& constraints)
      : graph_(graph), rows_(constraints), frame_(identity(graph, constraints.columns)) {
    for (int i = 0; i < rows_.rows; ++i) open_.push_back(i);
    free_.assign(static_cast<std::size_t>(rows_.columns), true);
  }

  std::optional<SymbolicMatrix> run(std::vector<Check>& checks) {
    while (!open_.empty()) {
      if (!constant_pivot() && !single(checks) && !pair(checks) && !quadruple(checks)) {
        return std::nullopt;
      }
    }
    const int left = static_cast<int>(std::count(free_.begin(), free_.end(), true));
    SymbolicMatrix result(graph_, frame_.rows, left);
    int to = 0;
    for (int j = 0; j < frame_.columns; ++j) {
      if (!free_[j]) continue;
      for (int i = 0; i < frame_.rows; ++i) result(i, to) = frame_(i, j);
      ++to;
    }
    return result;
  }

 private:
  int entries(int row) const {
    int count = 0;
    for (int j = 0; j < rows_.columns; ++j) count += rows_(row, j).is_zero() ? 0 : 1;
    return count;
  }

  // Column j of B and of the rows becomes what w_j = sum of factors[l] w_l makes of it: others take
  // their part, and j is free no more.
  void replace(int j, const SymbolicVector& factors) {
    for (SymbolicMatrix* m : {&frame_, &rows_}) {
      for (int i = 0; i < m->rows; ++i) {
        const Expression entry = (*m)(i, j);
        if (entry.is_zero()) continue;
        for (int l = 0; l < m->columns; ++l) {
          if (l == j || factors[l].is_zero()) continue;
          (*m)(i, l) = graph_.sum(SymbolicVector{(*m)(i, l), entry * factors[l]});
        }
        (*m)(i, j) = graph_.number(0);
      }
    }
    free_[j] = false;
  }

  // The row with the fewest entries of those with a constant one.
  bool constant_pivot() {
    int best_row = -1;
    int best_column = -1;
    for (const int row : open_) {
      if (best_row >= 0 && entries(row) >= entries(best_row)) continue;
      int column = -1;
      for (int j = 0; j < rows_.columns; ++j) {
        const Expression& e = rows_(row, j);
        if (!e.is_constant() || e.is_zero()) continue;
        if (column < 0 || std::abs(e.coefficient) > std::abs(rows_(row, column).coefficient)) {
          column = j;
        }
      }
      if (column < 0) continue;
      best_row = row;
      best_column = column;
    }
    if (best_row < 0) return false;
    const double pivot = rows_(best_row, best_column).coefficient;
    SymbolicVector factors(static_cast<std::size_t>(rows_.columns), graph_.number(0));
    for (int l = 0; l < rows_.columns; ++l) {
      if (l != best_column) factors[l] = (-1 / pivot) * rows_(best_row, l);
    }
    std::erase(open_, best_row);
    replace(best_column, factors);
    return true;
  }

  // An open row, its entries that are not zero, and their columns.
  struct Row {
    int index = -1;
    std::vector<int> columns;
    SymbolicVector entries;
  };
  std::optional<Row> row_of(int count) const {
    const auto found = std::find_if(
        open_.begin(), open_.end(), [&](int candidate) { return entries(candidate) == count; });
    if (found == open_.end()) return std::nullopt;
    Row row{*found, {}, {}};
    for (int j = 0; j < rows_.columns; ++j) {
      if (rows_(*found, j).is_zero()) continue;
      row.columns.push_back(j);
      row.entries.push_back(rows_(*found, j));
    }
    return row;
  }

  // Where the entries of a row vanish together the constraints lose rank.
  void close(const Row& row, std::vector<Check>& checks) {
    const Expression size = dot(graph_, row.entries, row.entries);
    if (!size.is_constant()) checks.push_back({size, RateStatus::kConstraintRank});
    std::erase(open_, row.index);
  }

  using Basis = std::vector<SymbolicVector>;

  // The velocities of `columns` become linear functions of one less: w = sum of u_l basis[l]. The
  // last column is free no more.
  void span_by(const std::vector<int>& columns, const Basis& basis) {
    for (SymbolicMatrix* m : {&frame_, &rows_}) {
      for (int i = 0; i < m->rows; ++i) {
        SymbolicVector entries;
        for (const int j : columns) entries.push_back((*m)(i, j));
        for (std::size_t l = 0; l < basis.size(); ++l) {
          (*m)(i, columns[l]) = dot(graph_, entries, basis[l]);
        }
        (*m)(i, columns.back()) = graph_.number(0);
      }
    }
    free_[columns.back()] = false;
  }

  // a w = 0.
  bool single(std::vector<Check>& checks) {
    const auto row = row_of(1);
    if (!row) return false;
    close(*row, checks);
    span_by(row->columns, {});
    return true;
  }

  bool pair(std::vector<Check>& checks) {
    const auto row = row_of(2);
    if (!row) return false;
    close(*row, checks);
    span_by(row->columns, {{-row->entries[1], row->entries[0]}});
    return true;
  }

  // The entries that other open rows than this one would have in its columns.
  long entries_with(const Basis& basis, const Row& than) {
    long count = 0;
    for (const int row : open_) {
      if (row == than.index) continue;
      SymbolicVector entries;
      for (const int j : than.columns) entries.push_back(rows_(row, j));
      count += std::count_if(basis.begin(), basis.end(), [&](const SymbolicVector& w) {
        return !dot(graph_, entries, w).is_zero();
      });
    }
    return count;
  }

  // With the row as a quaternion r, what is orthogonal to it is spanned by i r, j r and k r, and by
  // r i, r j and r k. The former have zeros in rows of rates in space, the latter in those of rates
  // in the body. Without zeros there is no use in it: the saddle of a mass that is constant and
  // diagonal is the faster one (an ellipsoid, by a quarter).
  bool quadruple(std::vector<Check>& checks) {
    const auto row = row_of(4);
    if (!row) return false;
    const Expression& a = row->entries[0];
    const Expression& b = row->entries[1];
    const Expression& c = row->entries[2];
    const Expression& d = row->entries[3];
    const Basis left{{-b, a, -d, c}, {-c, d, a, -b}, {-d, -c, b, a}};
    const Basis right{{-b, a, d, -c}, {-c, -d, a, b}, {-d, c, -b, a}};
    const long with_left = entries_with(left, *row);
    const long with_right = entries_with(right, *row);
    const long full = static_cast<long>(left.size() * (open_.size() - 1));
    if (std::min(with_left, with_right) == full) return false;
    close(*row, checks);
    span_by(row->columns, with_right < with_left ? right : left);
    return true;
  }

  Graph& graph_;
  SymbolicMatrix rows_;
  SymbolicMatrix frame_;
  std::vector<int> open_;
  std::vector<bool> free_;
};

}  // namespace

std::optional<SymbolicMatrix> frame_of(Graph& graph,
                                       const SymbolicMatrix& constraints,
                                       std::vector<Check>& checks) {
  return Elimination(graph, constraints).run(checks);
}

}  // namespace carnot::language
