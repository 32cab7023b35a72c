#include "carnot/transcription/midpoint_transcription.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <memory>
#include <new>
#include <type_traits>
#include <vector>

#include "carnot/numerics/pack.h"
#include "carnot/numerics/round_off.h"

namespace carnot {
namespace {

constexpr int kLanes = kTranscriptionLanes;
using LanePack = Pack<kLanes>;

// Numbers with their derivatives: a row of `known` of them each, the value first. T is double, or
// the numbers of kLanes intervals side by side. The compiler is to know the length: where it did
// not, searches of trailers took 1.3 times as long.
template <class T, int known>
class Rows {
 public:
  explicit Rows(T* data) : data_(data) {}

  // Row i.
  T* operator[](int i) const { return data_ + i * length(); }
  [[nodiscard]] static constexpr int length() { return known; }

  void clear(T* row) const {
    for (int d = 0; d < length(); ++d) row[d] = T(0);
  }
  // sum += factor x, and sum += a x y, with derivatives. The rows are different ones.
  void add(const T& factor, const T* __restrict x, T* __restrict sum) const {
    for (int d = 0; d < length(); ++d) sum[d] += factor * x[d];
  }
  void add_product(double a, const T* x, const T* y, T* __restrict sum) const {
    const T by_x = T(a) * y[0];
    const T by_y = T(a) * x[0];
    for (int d = 0; d < length(); ++d) sum[d] += by_x * x[d] + by_y * slope(y, d);
  }
  // x /= y.
  void divide(T* __restrict x, const T* __restrict y) const {
    const T inverse = T(1) / y[0];
    const T ratio = x[0] * inverse;
    for (int d = 0; d < length(); ++d) x[d] = (x[d] - ratio * slope(y, d)) * inverse;
  }
  void take_root(T* x) const {
    using std::sqrt;
    const T factor = T(0.5) / sqrt(x[0]);
    for (int d = 0; d < length(); ++d) x[d] = factor * (x[d] + (x[d] - slope(x, d)));
  }

 private:
  // Number d of a row, without its value. Rows are written as a whole: where one number of a row is
  // written alone, the processor waits before it can load the row again.
  static T slope(const T* row, int d) { return d == 0 ? T(0) : row[d]; }

  T* data_;
};

// M, G and V of a scene at a point, or at kLanes points.
template <class T, int known>
struct Entries {
  int n;
  int k;
  Rows<T, known> rows;

  // M_ij for j <= i, G_ij and V.
  [[nodiscard]] T* mass(int i, int j) const { return rows[i * (i + 1) / 2 + j]; }
  [[nodiscard]] T* constraint(int i, int j) const { return rows[n * (n + 1) / 2 + i * n + j]; }
  [[nodiscard]] T* potential() const { return rows[n * (n + 1) / 2 + k * n]; }
};

// Memory for a call, one for each thread: it is asked for by the million.
template <class T>
T* scratch(int count) {
  constexpr std::align_val_t kAlignment{64};
  struct Free {
    void operator()(std::byte* memory) const { ::operator delete[](memory, kAlignment); }
  };
  thread_local std::unique_ptr<std::byte, Free> memory;
  thread_local std::size_t size = 0;
  if (const std::size_t wanted = count * sizeof(T); size < wanted) {
    memory.reset();
    memory.reset(new (kAlignment) std::byte[wanted]);
    size = wanted;
  }
  return reinterpret_cast<T*>(memory.get());
}

// The entries with slopes, or without: length 1.
template <class T, int known>
Entries<T, known> entries_at(const TranscriptionFunctions& functions,
                             const void* system,
                             const double* q,
                             T* memory) {
  if constexpr (std::is_same_v<T, double>) {
    functions.entries(system, q, {}, known > 1, memory);
  } else {
    functions.packed_entries(system, q, {}, known > 1, reinterpret_cast<double*>(memory));
  }
  return {functions.dof, functions.constraints, Rows<T, known>(memory)};
}

// M := M + gamma G'G with gamma = trace M / trace G'G. `work` has three rows.
template <class T, int known>
void regularise(const Entries<T, known>& e, T* work) {
  const Rows<T, known>& rows = e.rows;
  T* const gamma = work;
  T* const trace = work + rows.length();
  T* const square = trace + rows.length();
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
template <class T, int known>
bool factor(const Entries<T, known>& e) {
  const Rows<T, known>& rows = e.rows;
  // A pivot must exceed the round-off that its own row can produce.
  const T threshold(16 * e.n * std::numeric_limits<double>::epsilon());
  for (int j = 0; j < e.n; ++j) {
    T* const pivot = e.mass(j, j);
    const T diagonal = pivot[0];
    for (int l = 0; l < j; ++l) rows.add_product(-1, e.mass(j, l), e.mass(j, l), pivot);
    if (!all(pivot[0] > threshold * diagonal) || !all(pivot[0] > T(0))) return false;
    rows.take_root(pivot);
    for (int i = j + 1; i < e.n; ++i) {
      T* const entry = e.mass(i, j);
      for (int l = 0; l < j; ++l) rows.add_product(-1, e.mass(i, l), e.mass(j, l), entry);
      rows.divide(entry, pivot);
    }
  }
  return true;
}

// `memory` has room for the entries and three rows.
template <class T, int known>
bool terms_of(const TranscriptionFunctions& functions,
              const void* system,
              const double* qm,
              const T* v,
              T* memory,
              T* terms,
              T* jacobian) {
  const int n = functions.dof;
  const int k = functions.constraints;
  const int count = entry_count(functions);
  const auto e = entries_at<T, known>(functions, system, qm, memory);
  if (k > 0) regularise(e, memory + count * known);
  if (!factor(e)) return false;
  for (int i = 0; i < n + k; ++i) terms[i] = T(0);
  if (jacobian != nullptr) std::fill_n(jacobian, (n + k + 1) * 2 * n, T(0));
  // Adds a v_j to term `to`.
  const auto add_velocity = [&](const T* a, int j, int to) {
    terms[to] += a[0] * v[j];
    if (jacobian == nullptr) return;
    T* const by_q = jacobian + to * 2 * n;
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

// l_qq of one interval, or of kLanes of them.
void set_hessian(const TranscriptionFunctions& functions,
                 const void* system,
                 const double* qm,
                 const double* v,
                 const double* lambda,
                 double* l_qq) {
  functions.hessian(system, qm, v, lambda, {}, l_qq);
}
void set_hessian(const TranscriptionFunctions& functions,
                 const void* system,
                 const LanePack* qm,
                 const LanePack* v,
                 const LanePack* lambda,
                 LanePack* l_qq) {
  const auto numbers = [](const LanePack* packs) { return reinterpret_cast<const double*>(packs); };
  functions.packed_hessian(
      system, numbers(qm), numbers(v), numbers(lambda), {}, reinterpret_cast<double*>(l_qq));
}

// What derivatives_of() needs room for.
int numbers_of_derivatives(const TranscriptionFunctions& functions, int known) {
  const int n = functions.dof;
  return (entry_count(functions) + 1 + n + functions.constraints) * known + 2 * n + n * n;
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
//
// `memory` has numbers_of_derivatives() of them.
template <class T, int known>
void derivatives_of(const TranscriptionFunctions& functions,
                    const void* system,
                    double h,
                    const T* x,
                    T* memory,
                    T* gradient,
                    T* hessian) {
  const int n = functions.dof;
  const int k = functions.constraints;
  const int m = 2 * n + k;
  T* next = memory;
  const auto take = [&](int size) {
    T* const taken = next;
    next += size;
    return taken;
  };
  T* const entries = take(entry_count(functions) * known);
  // l, l_v and g, each number in a row with its derivatives by q.
  const Rows<T, known> l(take(known));
  const Rows<T, known> momentum(take(n * known));
  const Rows<T, known> g(take(k * known));
  T* const qm = take(n);
  T* const v = take(n);
  T* const l_qq = take(n * n);
  const T* const lambda = x + 2 * n;
  for (int i = 0; i < n; ++i) {
    qm[i] = T(0.5) * (x[i] + x[n + i]);
    v[i] = (x[n + i] - x[i]) / T(h);
  }
  // With a gauge g = G (v - lambda) + lambda.
  const auto w = [&](int j) { return functions.gauge ? v[j] - T(0.5) * lambda[j] : v[j]; };
  const auto u = [&](int j) { return functions.gauge ? v[j] - lambda[j] : v[j]; };
  const auto e =
      entries_at<T, known>(functions, system, reinterpret_cast<const double*>(qm), entries);
  l.clear(l[0]);
  l.add(-1, e.potential(), l[0]);
  for (int i = 0; i < n; ++i) momentum.clear(momentum[i]);
  for (int i = 0; i < n; ++i) {
    for (int j = 0; j <= i; ++j) {
      const T* const entry = e.mass(i, j);
      l.add(T(j < i ? 1 : 0.5) * v[i] * v[j], entry, l[0]);
      momentum.add(v[j], entry, momentum[i]);
      if (j < i) momentum.add(v[i], entry, momentum[j]);
    }
  }
  for (int i = 0; i < k; ++i) {
    g.clear(g[i]);
    if (functions.gauge) g[i][0] = lambda[i];
    for (int j = 0; j < n; ++j) {
      const T* const entry = e.constraint(i, j);
      l.add(-lambda[i] * w(j), entry, l[0]);
      momentum.add(-lambda[i], entry, momentum[j]);
      g.add(u(j), entry, g[i]);
    }
  }
  const T* const l_q = l[0] + 1;
  const auto l_v = [&](int i) { return momentum[i][0]; };
  const auto l_vq = [&](int i, int j) { return momentum[i][1 + j]; };
  for (int i = 0; i < n; ++i) {
    gradient[i] = T(0.5 * h) * l_q[i] - l_v(i);
    gradient[n + i] = T(0.5 * h) * l_q[i] + l_v(i);
  }
  for (int i = 0; i < k; ++i) gradient[2 * n + i] = T(-h) * g[i][0];
  if (hessian == nullptr) return;
  set_hessian(functions, system, qm, v, lambda, l_qq);
  // Entry (row, column) and its mirror image.
  const auto set = [&](int row, int column, const T& value) {
    hessian[column * m + row] = hessian[row * m + column] = value;
  };
  for (int i = 0; i < n; ++i) {
    for (int j = 0; j < n; ++j) {
      const T position = T(0.25 * h) * l_qq[i * n + j];
      const T velocity = (j <= i ? e.mass(i, j) : e.mass(j, i))[0] / T(h);
      const T symmetric = T(0.5) * (l_vq(i, j) + l_vq(j, i));
      const T skew = T(0.5) * (l_vq(j, i) - l_vq(i, j));
      hessian[j * m + i] = position - symmetric + velocity;
      hessian[(n + j) * m + n + i] = position + symmetric + velocity;
      set(i, n + j, position + skew - velocity);
    }
  }
  for (int i = 0; i < k; ++i) {
    for (int j = 0; j < n; ++j) {
      const T position = T(0.5 * h) * g[i][1 + j];
      const T velocity = e.constraint(i, j)[0];
      set(2 * n + i, j, velocity - position);
      set(2 * n + i, n + j, -velocity - position);
    }
    for (int j = 0; j < k; ++j) {
      const T p = functions.gauge ? T(i == j ? 1 : 0) - e.constraint(i, j)[0] : T(0);
      hessian[(2 * n + j) * m + 2 * n + i] = T(-h) * p;
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

// The same for rows of packs.
constexpr int kMostPacked = 8;
template <class Run>
auto with_packed_rows(int n, const Run& run) {
  static_assert(kMostPacked == 8);
  switch (n) {
    case 1:
      return run(std::integral_constant<int, 2>{});
    case 2:
      return run(std::integral_constant<int, 3>{});
    case 3:
      return run(std::integral_constant<int, 4>{});
    case 4:
      return run(std::integral_constant<int, 5>{});
    case 5:
      return run(std::integral_constant<int, 6>{});
    case 6:
      return run(std::integral_constant<int, 7>{});
    case 7:
      return run(std::integral_constant<int, 8>{});
    default:
      assert(n == kMostPacked);
      return run(std::integral_constant<int, kMostPacked + 1>{});
  }
}
bool runs_on_packs(const TranscriptionFunctions& functions) {
  return functions.packed_entries != nullptr && functions.dof <= kMostPacked;
}

// Packs have no sine of large angles (pack.h), and one interval that fails is not to spoil others.
bool all_finite(const double* x, int rows) {
  LanePack sum(0);
  for (int i = 0; i < rows; ++i) sum += LanePack(0) * LanePack::load(x + i * kLanes);
  return all(sum <= LanePack(0));
}

// Numbers of kLanes intervals side by side, `count` of each.
template <class T>
struct Lanes {
  T* data;
  int count;
};

// Calls run(arguments, results) for each interval, with its own numbers. False where one fails.
template <std::size_t inputs, std::size_t outputs, class Run>
bool lane_by_lane(const Lanes<const double> (&in)[inputs],
                  const Lanes<double> (&out)[outputs],
                  const Run& run) {
  std::array<std::vector<double>, inputs> arguments;
  std::array<std::vector<double>, outputs> results;
  std::array<const double*, inputs> from;
  std::array<double*, outputs> to;
  for (std::size_t i = 0; i < inputs; ++i) {
    arguments[i].resize(in[i].count);
    from[i] = arguments[i].data();
  }
  for (std::size_t i = 0; i < outputs; ++i) {
    results[i].resize(out[i].count);
    to[i] = results[i].data();
  }
  bool good = true;
  for (int l = 0; l < kLanes; ++l) {
    for (std::size_t i = 0; i < inputs; ++i) {
      for (int a = 0; a < in[i].count; ++a) arguments[i][a] = in[i].data[a * kLanes + l];
    }
    good = run(from, to) && good;
    for (std::size_t i = 0; i < outputs; ++i) {
      for (int a = 0; a < out[i].count; ++a) out[i].data[a * kLanes + l] = results[i][a];
    }
  }
  return good;
}

}  // namespace

bool midpoint_terms(const TranscriptionFunctions& functions,
                    const void* system,
                    const double* qm,
                    const double* v,
                    double* terms,
                    double* jacobian) {
  const auto run = [&](auto length) {
    auto* const memory = scratch<double>((entry_count(functions) + 3) * length());
    return terms_of<double, length()>(functions, system, qm, v, memory, terms, jacobian);
  };
  if (jacobian == nullptr) return run(std::integral_constant<int, 1>{});
  return with_rows(functions.dof, run);
}

bool packed_midpoint_terms(const TranscriptionFunctions& functions,
                           const void* system,
                           const double* qm,
                           const double* v,
                           double* terms,
                           double* jacobian) {
  const int n = functions.dof;
  const int count = n + functions.constraints + 1;
  const int slopes = jacobian == nullptr ? 0 : count * 2 * n;
  const auto run = [&](auto length) {
    const int work = (entry_count(functions) + 3) * length();
    auto* const memory = scratch<LanePack>(work + n + count + slopes);
    LanePack* const velocity = memory + work;
    LanePack* const values = velocity + n;
    LanePack* const by_both = values + count;
    for (int j = 0; j < n; ++j) velocity[j] = LanePack::load(v + j * kLanes);
    const bool good = terms_of<LanePack, length()>(
        functions, system, qm, velocity, memory, values, slopes > 0 ? by_both : nullptr);
    for (int i = 0; i < count; ++i) values[i].store(terms + i * kLanes);
    for (int i = 0; i < slopes; ++i) by_both[i].store(jacobian + i * kLanes);
    return good;
  };
  const bool packs = runs_on_packs(functions);
  const bool good =
      packs && (slopes == 0 ? run(std::integral_constant<int, 1>{}) : with_packed_rows(n, run));
  if (good && all_finite(terms, count) && all_finite(jacobian, slopes)) {
    return true;
  }
  return lane_by_lane(
      {{qm, n}, {v, n}}, {{terms, count}, {jacobian, slopes}}, [&](auto in, auto out) {
        return midpoint_terms(
            functions, system, in[0], in[1], out[0], slopes > 0 ? out[1] : nullptr);
      });
}

void discrete_lagrangian(const TranscriptionFunctions& functions,
                         const void* system,
                         double h,
                         const double* x,
                         double* gradient,
                         double* hessian) {
  with_rows(functions.dof, [&](auto length) {
    auto* const memory = scratch<double>(numbers_of_derivatives(functions, length()));
    derivatives_of<double, length()>(functions, system, h, x, memory, gradient, hessian);
  });
}

void packed_discrete_lagrangian(const TranscriptionFunctions& functions,
                                const void* system,
                                double h,
                                const double* x,
                                double* gradient,
                                double* hessian) {
  const int m = 2 * functions.dof + functions.constraints;
  const int second = hessian == nullptr ? 0 : m * m;
  if (runs_on_packs(functions)) {
    with_packed_rows(functions.dof, [&](auto length) {
      const int work = numbers_of_derivatives(functions, length());
      auto* const memory = scratch<LanePack>(work + 2 * m + second);
      LanePack* const at = memory + work;
      LanePack* const first = at + m;
      LanePack* const last = first + m;
      for (int i = 0; i < m; ++i) at[i] = LanePack::load(x + i * kLanes);
      derivatives_of<LanePack, length()>(
          functions, system, h, at, memory, first, second > 0 ? last : nullptr);
      for (int i = 0; i < m; ++i) first[i].store(gradient + i * kLanes);
      for (int i = 0; i < second; ++i) last[i].store(hessian + i * kLanes);
    });
    if (all_finite(gradient, m)) return;
  }
  lane_by_lane({{x, m}}, {{gradient, m}, {hessian, second}}, [&](auto in, auto out) {
    discrete_lagrangian(functions, system, h, in[0], out[0], second > 0 ? out[1] : nullptr);
    return true;
  });
}

void gauged_multipliers(const TranscriptionFunctions& functions,
                        const void* system,
                        const double* q,
                        const double* p,
                        double* lambda) {
  const auto e =
      entries_at<double, 1>(functions, system, q, scratch<double>(entry_count(functions)));
  for (int i = 0; i < e.k; ++i) {
    lambda[i] = 0;
    for (int j = 0; j < e.n; ++j) lambda[i] -= e.constraint(i, j)[0] * p[j];
  }
}

}  // namespace carnot
