#include "carnot/transcription/midpoint_transcription.h"

#include <cmath>
#include <vector>

#include "carnot/numerics/round_off.h"

namespace carnot {
namespace {

// Numbers with their derivatives: one row of `width` doubles each, the value first.
class Rows {
 public:
  Rows(double* data, int width) : data_(data), width_(width) {}

  // Row i.
  double* operator[](int i) const { return data_ + i * width_; }
  [[nodiscard]] int width() const { return width_; }

 private:
  double* data_;
  int width_;
};

// M, G and V of a scene at a point.
struct Entries {
  int n;
  int k;
  Rows rows;

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

Entries entries_at(const TranscriptionFunctions& functions,
                   const void* system,
                   const double* q,
                   bool slopes,
                   double* memory) {
  const int n = functions.dof;
  functions.entries(system, q, slopes, memory);
  return {n, functions.constraints, Rows(memory, slopes ? n + 1 : 1)};
}

// Adds a x, and a (x y) with derivatives, to `sum`.
void add(double a, const double* x, int width, double* sum) {
  for (int d = 0; d < width; ++d) sum[d] += a * x[d];
}
void add_product(double a, const double* x, const double* y, int width, double* sum) {
  sum[0] += a * x[0] * y[0];
  for (int d = 1; d < width; ++d) sum[d] += a * (x[d] * y[0] + x[0] * y[d]);
}

// M := M + gamma G'G with gamma = trace M / trace G'G. `work` has three rows.
void regularise(const Entries& e, const Rows& work) {
  const int width = e.rows.width();
  double* const mass_trace = work[0];
  double* const square_trace = work[1];
  double* const square = work[2];
  for (int d = 0; d < 2 * width; ++d) mass_trace[d] = 0;  // and square_trace
  for (int i = 0; i < e.n; ++i) add(1, e.mass(i, i), width, mass_trace);
  for (int i = 0; i < e.k; ++i) {
    for (int j = 0; j < e.n; ++j) {
      add_product(1, e.constraint(i, j), e.constraint(i, j), width, square_trace);
    }
  }
  double* const gamma = mass_trace;
  const double inverse = 1 / square_trace[0];
  gamma[0] *= inverse;
  for (int d = 1; d < width; ++d) gamma[d] = (gamma[d] - gamma[0] * square_trace[d]) * inverse;
  for (int i = 0; i < e.n; ++i) {
    for (int j = 0; j <= i; ++j) {
      for (int d = 0; d < width; ++d) square[d] = 0;
      for (int l = 0; l < e.k; ++l) {
        add_product(1, e.constraint(l, i), e.constraint(l, j), width, square);
      }
      add_product(1, gamma, square, width, e.mass(i, j));
    }
  }
}

// M := C, the lower triangle with C C' = M, by Cholesky's method; differentiated line by line.
// False where M is not positive definite to round-off.
bool factor(const Entries& e) {
  const int width = e.rows.width();
  const double threshold = pivot_round_off<double>(e.n);
  for (int j = 0; j < e.n; ++j) {
    double* const pivot = e.mass(j, j);
    const double diagonal = pivot[0];
    for (int l = 0; l < j; ++l) add_product(-1, e.mass(j, l), e.mass(j, l), width, pivot);
    if (!(pivot[0] > threshold * diagonal) || !(pivot[0] > 0)) return false;
    pivot[0] = std::sqrt(pivot[0]);
    const double inverse = 1 / pivot[0];
    for (int d = 1; d < width; ++d) pivot[d] *= 0.5 * inverse;
    for (int i = j + 1; i < e.n; ++i) {
      double* const entry = e.mass(i, j);
      for (int l = 0; l < j; ++l) add_product(-1, e.mass(i, l), e.mass(j, l), width, entry);
      entry[0] *= inverse;
      for (int d = 1; d < width; ++d) entry[d] = (entry[d] - entry[0] * pivot[d]) * inverse;
    }
  }
  return true;
}

}  // namespace

bool midpoint_terms(const TranscriptionFunctions& functions,
                    const void* system,
                    const double* qm,
                    const double* v,
                    double* terms,
                    double* jacobian) {
  const int n = functions.dof;
  const int k = functions.constraints;
  const int count = entry_count(functions);
  const bool slopes = jacobian != nullptr;
  const int width = slopes ? n + 1 : 1;
  double* const memory = scratch((count + 3) * width);
  const Entries e = entries_at(functions, system, qm, slopes, memory);
  if (k > 0) regularise(e, Rows(memory + count * width, width));
  if (!factor(e)) return false;
  for (int d = 0; slopes && d < (n + k + 1) * 2 * n; ++d) jacobian[d] = 0;
  // Adds a_j v_j to term `to`.
  const auto add_velocity = [&](const double* a, int j, int to) {
    terms[to] += a[0] * v[j];
    if (!slopes) return;
    double* const by_q = jacobian + to * 2 * n;
    add(v[j], a + 1, n, by_q);
    by_q[n + j] = a[0];
  };
  for (int i = 0; i < n + k; ++i) terms[i] = 0;
  for (int i = 0; i < n; ++i) {
    for (int j = i; j < n; ++j) add_velocity(e.mass(j, i), j, i);
  }
  for (int i = 0; i < k; ++i) {
    for (int j = 0; j < n; ++j) add_velocity(e.constraint(i, j), j, n + i);
  }
  terms[n + k] = e.potential()[0];
  if (slopes) add(1, e.potential() + 1, n, jacobian + (n + k) * 2 * n);
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
void discrete_lagrangian(const TranscriptionFunctions& functions,
                         const void* system,
                         double h,
                         const double* x,
                         double* gradient,
                         double* hessian) {
  const int n = functions.dof;
  const int k = functions.constraints;
  const int m = 2 * n + k;
  const int count = entry_count(functions);
  const int width = n + 1;
  double* next = scratch(count * width + 4 * n + k + (2 * n + k) * n);
  const auto take = [&](int size) {
    double* const taken = next;
    next += size;
    return taken;
  };
  double* const memory = take(count * width);
  double* const qm = take(n);
  double* const v = take(n);
  double* const l_q = take(n);
  double* const l_v = take(n);
  double* const g = take(k);
  double* const l_qq = take(n * n);
  double* const l_vq = take(n * n);
  double* const g_q = take(k * n);
  const double* const lambda = x + 2 * n;
  for (int i = 0; i < n; ++i) {
    qm[i] = 0.5 * (x[i] + x[n + i]);
    v[i] = (x[n + i] - x[i]) / h;
  }
  // With a gauge g = G (v - lambda) + lambda.
  const auto w = [&](int j) { return functions.gauge ? v[j] - 0.5 * lambda[j] : v[j]; };
  const auto u = [&](int j) { return functions.gauge ? v[j] - lambda[j] : v[j]; };
  const Entries e = entries_at(functions, system, qm, true, memory);
  for (int i = 0; i < n; ++i) l_q[i] = -e.potential()[1 + i];
  for (int i = 0; i < n; ++i) l_v[i] = 0;
  for (int i = 0; i < n * n; ++i) l_vq[i] = 0;
  for (int i = 0; i < n; ++i) {
    for (int j = 0; j <= i; ++j) {
      const double* const entry = e.mass(i, j);
      add((j < i ? 1 : 0.5) * v[i] * v[j], entry + 1, n, l_q);
      l_v[i] += entry[0] * v[j];
      add(v[j], entry + 1, n, l_vq + i * n);
      if (j == i) continue;
      l_v[j] += entry[0] * v[i];
      add(v[i], entry + 1, n, l_vq + j * n);
    }
  }
  for (int i = 0; i < k; ++i) {
    g[i] = functions.gauge ? lambda[i] : 0;
    for (int d = 0; d < n; ++d) g_q[i * n + d] = 0;
    for (int j = 0; j < n; ++j) {
      const double* const entry = e.constraint(i, j);
      add(-lambda[i] * w(j), entry + 1, n, l_q);
      l_v[j] -= lambda[i] * entry[0];
      add(-lambda[i], entry + 1, n, l_vq + j * n);
      g[i] += entry[0] * u(j);
      add(u(j), entry + 1, n, g_q + i * n);
    }
  }
  for (int i = 0; i < n; ++i) {
    gradient[i] = 0.5 * h * l_q[i] - l_v[i];
    gradient[n + i] = 0.5 * h * l_q[i] + l_v[i];
  }
  for (int i = 0; i < k; ++i) gradient[2 * n + i] = -h * g[i];
  if (hessian == nullptr) return;
  functions.hessian(system, qm, v, lambda, l_qq);
  // Entry (row, column) and its mirror image.
  const auto set = [&](int row, int column, double value) {
    hessian[column * m + row] = hessian[row * m + column] = value;
  };
  for (int i = 0; i < n; ++i) {
    for (int j = 0; j < n; ++j) {
      const double position = 0.25 * h * l_qq[i * n + j];
      const double velocity = (j <= i ? e.mass(i, j) : e.mass(j, i))[0] / h;
      const double symmetric = 0.5 * (l_vq[i * n + j] + l_vq[j * n + i]);
      const double skew = 0.5 * (l_vq[j * n + i] - l_vq[i * n + j]);
      hessian[j * m + i] = position - symmetric + velocity;
      hessian[(n + j) * m + n + i] = position + symmetric + velocity;
      set(i, n + j, position + skew - velocity);
    }
  }
  for (int i = 0; i < k; ++i) {
    for (int j = 0; j < n; ++j) {
      const double position = 0.5 * h * g_q[i * n + j];
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

void gauged_multipliers(const TranscriptionFunctions& functions,
                        const void* system,
                        const double* q,
                        const double* p,
                        double* lambda) {
  const Entries e = entries_at(functions, system, q, false, scratch(entry_count(functions)));
  for (int i = 0; i < e.k; ++i) {
    lambda[i] = 0;
    for (int j = 0; j < e.n; ++j) lambda[i] -= e.constraint(i, j)[0] * p[j];
  }
}

}  // namespace carnot
