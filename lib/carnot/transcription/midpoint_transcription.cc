#include "carnot/transcription/midpoint_transcription.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <vector>

#include "carnot/numerics/round_off.h"

namespace carnot {
namespace {

// Numbers with their derivatives: a row of `known` doubles each, the value first. The compiler is
// to know the length: where it did not, searches of trailers took 1.3 times as long.
template <int known>
class Rows {
 public:
  explicit Rows(double* data) : data_(data) {}

  // Row i.
  double* operator[](int i) const { return data_ + i * length(); }
  [[nodiscard]] static constexpr int length() { return known; }

  void clear(double* row) const {
    for (int d = 0; d < length(); ++d) row[d] = 0;
  }
  // sum += a x, and sum += a x y, with derivatives. The rows are different ones.
  void add(double a, const double* __restrict x, double* __restrict sum) const {
    for (int d = 0; d < length(); ++d) sum[d] += a * x[d];
  }
  void add_product(double a, const double* x, const double* y, double* __restrict sum) const {
    const double by_x = a * y[0];
    const double by_y = a * x[0];
    for (int d = 0; d < length(); ++d) sum[d] += by_x * x[d] + by_y * (y[d] * kSlopes[d]);
  }
  // x /= y.
  void divide(double* __restrict x, const double* __restrict y) const {
    const double inverse = 1 / y[0];
    const double ratio = x[0] * inverse;
    for (int d = 0; d < length(); ++d) x[d] = (x[d] - ratio * (y[d] * kSlopes[d])) * inverse;
  }
  void take_root(double* x) const {
    const double factor = 0.5 / std::sqrt(x[0]);
    for (int d = 0; d < length(); ++d) x[d] = factor * (x[d] + x[d] * (1 - kSlopes[d]));
  }

 private:
  // Leaves the value out. Rows are written as a whole: where one number of a row is written alone,
  // the processor waits before it can load the row again.
  static constexpr auto kSlopes = [] {
    std::array<double, known> factors;
    factors.fill(1);
    factors[0] = 0;
    return factors;
  }();

  double* data_;
};

// M, G and V of a scene at a point.
template <int known>
struct Entries {
  int n;
  int k;
  Rows<known> rows;

  // M_ij for j <= i, G_ij and V.
  [[nodiscard]] double* mass(int i, int j) const { return rows[i * (i + 1) / 2 + j]; }
  [[nodiscard]] double* constraint(int i, int j) const { return rows[n * (n + 1) / 2 + i * n + j]; }
  [[nodiscard]] double* potential() const { return rows[n * (n + 1) / 2 + k * n]; }
};

// Memory for a call, one for each thread: it is asked for by the million.
double* scratch(int count) {
  thread_local std::vector<double> memory;
  if (memory.size() < static_cast<std::size_t>(count)) memory.resize(count);
  return memory.data();
}

// The entries with slopes, or without: length 1.
template <int known>
Entries<known> entries_at(const TranscriptionFunctions& functions,
                          const void* system,
                          const double* q,
                          double* memory) {
  functions.entries(system, q, {}, known > 1, memory);
  return {functions.dof, functions.constraints, Rows<known>(memory)};
}

// M := M + gamma G'G with gamma = trace M / trace G'G. `work` has three rows.
template <int known>
void regularise(const Entries<known>& e, double* work) {
  const Rows<known>& rows = e.rows;
  double* const gamma = work;
  double* const trace = work + rows.length();
  double* const square = trace + rows.length();
  rows.clear(gamma);
  rows.clear(trace);
  for (int i = 0; i < e.n; ++i) rows.add(1, e.mass(i, i), gamma);
  for (int i = 0; i < e.k; ++i) {
    for (int j = 0; j < e.n; ++j) {
      rows.add_product(1, e.constraint(i, j), e.constraint(i, j), trace);
    }
  }
  rows.divide(gamma, trace);
  for (int i = 0; i < e.n; ++i) {
    for (int j = 0; j <= i; ++j) {
      rows.clear(square);
      for (int l = 0; l < e.k; ++l) {
        rows.add_product(1, e.constraint(l, i), e.constraint(l, j), square);
      }
      rows.add_product(1, gamma, square, e.mass(i, j));
    }
  }
}

// M := C, the lower triangle with C C' = M, by Cholesky's method, differentiated line by line.
// False where M is not positive definite to round-off.
template <int known>
bool factor(const Entries<known>& e) {
  const Rows<known>& rows = e.rows;
  // A pivot must exceed the round-off that its own row can produce.
  const double threshold = 16 * e.n * std::numeric_limits<double>::epsilon();
  for (int j = 0; j < e.n; ++j) {
    double* const pivot = e.mass(j, j);
    const double diagonal = pivot[0];
    for (int l = 0; l < j; ++l) rows.add_product(-1, e.mass(j, l), e.mass(j, l), pivot);
    if (!(pivot[0] > threshold * diagonal) || !(pivot[0] > 0)) return false;
    rows.take_root(pivot);
    for (int i = j + 1; i < e.n; ++i) {
      double* const entry = e.mass(i, j);
      for (int l = 0; l < j; ++l) rows.add_product(-1, e.mass(i, l), e.mass(j, l), entry);
      rows.divide(entry, pivot);
    }
  }
  return true;
}

template <int known>
bool terms_of(const TranscriptionFunctions& functions,
              const void* system,
              const double* qm,
              const double* v,
              double* terms,
              double* jacobian) {
  const int n = functions.dof;
  const int k = functions.constraints;
  const int count = entry_count(functions);
  double* const memory = scratch((count + 3) * known);
  const auto e = entries_at<known>(functions, system, qm, memory);
  if (k > 0) regularise(e, memory + count * known);
  if (!factor(e)) return false;
  for (int i = 0; i < n + k; ++i) terms[i] = 0;
  if (jacobian != nullptr) std::fill_n(jacobian, (n + k + 1) * 2 * n, 0.0);
  // Adds a v_j to term `to`.
  const auto add_velocity = [&](const double* a, int j, int to) {
    terms[to] += a[0] * v[j];
    if (jacobian == nullptr) return;
    double* const by_q = jacobian + to * 2 * n;
    for (int d = 0; d < n; ++d) by_q[d] += v[j] * a[1 + d];
    by_q[n + j] = a[0];
  };
  for (int i = 0; i < n; ++i) {
    for (int j = i; j < n; ++j) add_velocity(e.mass(j, i), j, i);
  }
  for (int i = 0; i < k; ++i) {
    for (int j = 0; j < n; ++j) add_velocity(e.constraint(i, j), j, n + i);
  }
  terms[n + k] = e.potential()[0];
  if (jacobian != nullptr) std::copy_n(e.potential() + 1, n, jacobian + (n + k) * 2 * n);
  return true;
}

// With the first derivatives of l(q, v) at fixed lambda,
//
//   l_q = v'M_q v/2 - V_q - lambda'G_q w,   l_v = M v - G'lambda,   g = G v + P lambda,
//
// where w = v, or v - lambda/2 with a gauge, P = I - G, the chain rule with d qm = (dq0 + dq1)/2
// and d v = (dq1 - dq0)/h gives
//
//   gradient   (h l_q/2 - l_v,  h l_q/2 + l_v,  -h g)
//   Hessian    in (q0, q0)  h l_qq/4 - (l_vq + l_vq')/2 + l_vv/h
//              in (q1, q1)  h l_qq/4 + (l_vq + l_vq')/2 + l_vv/h
//              in (q0, q1)  h l_qq/4 + (l_vq' - l_vq)/2 - l_vv/h
//              in (lambda, q0) and (lambda, q1)   -h g_q/2 +- G,     in (lambda, lambda)  -h P
template <int known>
void derivatives_of(const TranscriptionFunctions& functions,
                    const void* system,
                    double h,
                    const double* x,
                    double* gradient,
                    double* hessian) {
  const int n = functions.dof;
  const int k = functions.constraints;
  const int m = 2 * n + k;
  const int count = entry_count(functions);
  double* next = scratch((count + 1 + n + k) * known + 2 * n + n * n);
  const auto take = [&](int size) {
    double* const taken = next;
    next += size;
    return taken;
  };
  double* const memory = take(count * known);
  // l, l_v and g, each number in a row with its derivatives by q.
  const Rows<known> l(take(known));
  const Rows<known> momentum(take(n * known));
  const Rows<known> g(take(k * known));
  double* const qm = take(n);
  double* const v = take(n);
  double* const l_qq = take(n * n);
  const double* const lambda = x + 2 * n;
  for (int i = 0; i < n; ++i) {
    qm[i] = 0.5 * (x[i] + x[n + i]);
    v[i] = (x[n + i] - x[i]) / h;
  }
  // With a gauge g = G (v - lambda) + lambda.
  const auto w = [&](int j) { return functions.gauge ? v[j] - 0.5 * lambda[j] : v[j]; };
  const auto u = [&](int j) { return functions.gauge ? v[j] - lambda[j] : v[j]; };
  const auto e = entries_at<known>(functions, system, qm, memory);
  l.clear(l[0]);
  l.add(-1, e.potential(), l[0]);
  for (int i = 0; i < n; ++i) momentum.clear(momentum[i]);
  for (int i = 0; i < n; ++i) {
    for (int j = 0; j <= i; ++j) {
      const double* const entry = e.mass(i, j);
      l.add((j < i ? 1 : 0.5) * v[i] * v[j], entry, l[0]);
      momentum.add(v[j], entry, momentum[i]);
      if (j < i) momentum.add(v[i], entry, momentum[j]);
    }
  }
  for (int i = 0; i < k; ++i) {
    g.clear(g[i]);
    if (functions.gauge) g[i][0] = lambda[i];
    for (int j = 0; j < n; ++j) {
      const double* const entry = e.constraint(i, j);
      l.add(-lambda[i] * w(j), entry, l[0]);
      momentum.add(-lambda[i], entry, momentum[j]);
      g.add(u(j), entry, g[i]);
    }
  }
  const double* const l_q = l[0] + 1;
  const auto l_v = [&](int i) { return momentum[i][0]; };
  const auto l_vq = [&](int i, int j) { return momentum[i][1 + j]; };
  for (int i = 0; i < n; ++i) {
    gradient[i] = 0.5 * h * l_q[i] - l_v(i);
    gradient[n + i] = 0.5 * h * l_q[i] + l_v(i);
  }
  for (int i = 0; i < k; ++i) gradient[2 * n + i] = -h * g[i][0];
  if (hessian == nullptr) return;
  functions.hessian(system, qm, v, lambda, {}, l_qq);
  // Entry (row, column) and its mirror image.
  const auto set = [&](int row, int column, double value) {
    hessian[column * m + row] = hessian[row * m + column] = value;
  };
  for (int i = 0; i < n; ++i) {
    for (int j = 0; j < n; ++j) {
      const double position = 0.25 * h * l_qq[i * n + j];
      const double velocity = (j <= i ? e.mass(i, j) : e.mass(j, i))[0] / h;
      const double symmetric = 0.5 * (l_vq(i, j) + l_vq(j, i));
      const double skew = 0.5 * (l_vq(j, i) - l_vq(i, j));
      hessian[j * m + i] = position - symmetric + velocity;
      hessian[(n + j) * m + n + i] = position + symmetric + velocity;
      set(i, n + j, position + skew - velocity);
    }
  }
  for (int i = 0; i < k; ++i) {
    for (int j = 0; j < n; ++j) {
      const double position = 0.5 * h * g[i][1 + j];
      const double velocity = e.constraint(i, j)[0];
      set(2 * n + i, j, velocity - position);
      set(2 * n + i, n + j, -velocity - position);
    }
    for (int j = 0; j < k; ++j) {
      const double p = functions.gauge ? (i == j ? 1 : 0) - e.constraint(i, j)[0] : 0;
      hessian[(2 * n + j) * m + 2 * n + i] = -h * p;
    }
  }
}

// run(std::integral_constant of the length of rows for n coordinates).
template <class Run>
auto with_rows(int n, const Run& run) {
  switch (row_length(n)) {
    case 8:
      return run(std::integral_constant<int, 8>{});
    case 16:
      return run(std::integral_constant<int, 16>{});
    default:
      assert(row_length(n) == kLongestRow);
      return run(std::integral_constant<int, kLongestRow>{});
  }
}

}  // namespace

bool midpoint_terms(const TranscriptionFunctions& functions,
                    const void* system,
                    const double* qm,
                    const double* v,
                    double* terms,
                    double* jacobian) {
  if (jacobian == nullptr) return terms_of<1>(functions, system, qm, v, terms, nullptr);
  return with_rows(functions.dof, [&](auto length) {
    return terms_of<length()>(functions, system, qm, v, terms, jacobian);
  });
}

void discrete_lagrangian(const TranscriptionFunctions& functions,
                         const void* system,
                         double h,
                         const double* x,
                         double* gradient,
                         double* hessian) {
  with_rows(functions.dof, [&](auto length) {
    derivatives_of<length()>(functions, system, h, x, gradient, hessian);
  });
}

void gauged_multipliers(const TranscriptionFunctions& functions,
                        const void* system,
                        const double* q,
                        const double* p,
                        double* lambda) {
  const auto e = entries_at<1>(functions, system, q, scratch(entry_count(functions)));
  for (int i = 0; i < e.k; ++i) {
    lambda[i] = 0;
    for (int j = 0; j < e.n; ++j) lambda[i] -= e.constraint(i, j)[0] * p[j];
  }
}

}  // namespace carnot
