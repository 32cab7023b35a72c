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

// a where it is true, else b.
double chosen(bool is, double a, double b) { return is ? a : b; }
LanePack chosen(const LanePack::Mask& is, const LanePack& a, const LanePack& b) {
  return select(is, a, b);
}

// A number with its derivatives: `known` numbers, the value first. T is double, or the numbers of
// kLanes intervals side by side. The compiler is to know how many: where it did not, searches of
// trailers took 1.3 times as long. What is summed up here stays in registers: where each summand
// was added to memory, starts of a vehicle took 1.08 times as long to relax.
template <class T, int known>
class Number {
 public:
  Number() : at_{} {}
  explicit Number(const T* from) {
#pragma GCC unroll 16
    for (int d = 0; d < known; ++d) at_[d] = from[d];
  }
  void store(T* to) const {
#pragma GCC unroll 16
    for (int d = 0; d < known; ++d) to[d] = at_[d];
  }
  const T& operator[](int d) const { return at_[d]; }
  [[nodiscard]] const T& value() const { return at_[0]; }

  // += factor x, += x y and -= x y, with derivatives. Each product is added by itself: there is one
  // way only to fuse it with its sum, so that packs and plain numbers round alike.
  template <class X>
  [[gnu::always_inline]] void add(const T& factor, const X& x) {
#pragma GCC unroll 16
    for (int d = 0; d < known; ++d) at_[d] += factor * x[d];
  }
  template <class X, class Y>
  [[gnu::always_inline]] void add_product(const X& x, const Y& y) {
    at_[0] += x[0] * y[0];
#pragma GCC unroll 16
    for (int d = 1; d < known; ++d) {
      at_[d] += x[0] * y[d];
      at_[d] += y[0] * x[d];
    }
  }
  template <class X, class Y>
  [[gnu::always_inline]] void subtract_product(const X& x, const Y& y) {
    at_[0] -= x[0] * y[0];
#pragma GCC unroll 16
    for (int d = 1; d < known; ++d) {
      at_[d] -= x[0] * y[d];
      at_[d] -= y[0] * x[d];
    }
  }
  // /= y, with the inverse of y.
  [[gnu::always_inline]] void divide(const Number& y, const T& inverse) {
    at_[0] = at_[0] * inverse;
#pragma GCC unroll 16
    for (int d = 1; d < known; ++d) at_[d] = (at_[d] - at_[0] * y[d]) * inverse;
  }
  // Its root, which is not a number unless it is larger than `least` and than zero.
  [[gnu::always_inline]] void take_root(const T& least) {
    using std::sqrt;
    const T nan(std::numeric_limits<double>::quiet_NaN());
    at_[0] = sqrt(chosen(at_[0] > least, chosen(at_[0] > T(0), at_[0], nan), nan));
    const T factor = T(0.5) / at_[0];
#pragma GCC unroll 16
    for (int d = 1; d < known; ++d) at_[d] = factor * at_[d];
  }

 private:
  T at_[known];
};

// Numbers with their derivatives, one after the other.
template <class T, int known>
class Rows {
 public:
  explicit Rows(T* data) : data_(data) {}

  T* operator[](int i) const { return data_ + i * known; }

 private:
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

// M := M + gamma G'G with gamma = trace M / trace G'G.
template <class T, int known>
void regularise(const Entries<T, known>& e) {
  Number<T, known> gamma;
  Number<T, known> trace;
  for (int i = 0; i < e.n; ++i) gamma.add(T(1), e.mass(i, i));
  for (int i = 0; i < e.k * e.n; ++i) trace.add_product(e.constraint(0, i), e.constraint(0, i));
  gamma.divide(trace, T(1) / trace.value());
  for (int i = 0; i < e.n; ++i) {
    for (int j = 0; j <= i; ++j) {
      Number<T, known> square;
      for (int l = 0; l < e.k; ++l) square.add_product(e.constraint(l, i), e.constraint(l, j));
      Number<T, known> entry(e.mass(i, j));
      entry.add_product(gamma, square);
      entry.store(e.mass(i, j));
    }
  }
}

// M := C, the lower triangle with C C' = M, by Cholesky's method, differentiated line by line.
// Where M is not positive definite to round-off, C is not a number.
template <class T, int known>
void factor(const Entries<T, known>& e) {
  // A pivot must exceed the round-off that its own row can produce.
  const T threshold(16 * e.n * std::numeric_limits<double>::epsilon());
  for (int j = 0; j < e.n; ++j) {
    Number<T, known> pivot(e.mass(j, j));
    const T least = threshold * pivot.value();
    for (int l = 0; l < j; ++l) pivot.subtract_product(e.mass(j, l), e.mass(j, l));
    pivot.take_root(least);
    pivot.store(e.mass(j, j));
    const T inverse = T(1) / pivot.value();
    for (int i = j + 1; i < e.n; ++i) {
      Number<T, known> entry(e.mass(i, j));
      for (int l = 0; l < j; ++l) entry.subtract_product(e.mass(i, l), e.mass(j, l));
      entry.divide(pivot, inverse);
      entry.store(e.mass(i, j));
    }
  }
}

// Where the numbers of one interval are put, or those of kLanes intervals side by side.
template <class T>
void put(const T& x, double* to, int i) {
  if constexpr (std::is_same_v<T, double>) {
    to[i] = x;
  } else {
    x.store(to + i * kLanes);
  }
}

// `memory` has room for the entries. Numbers that do not exist are NaN; the jacobian may be null.
template <class T, int known>
void terms_of(const TranscriptionFunctions& functions,
              const void* system,
              const double* qm,
              const T* v,
              T* memory,
              double* terms,
              double* jacobian) {
  const int n = functions.dof;
  const int k = functions.constraints;
  const auto e = entries_at<T, known>(functions, system, qm, memory);
  if (k > 0) regularise(e);
  factor(e);
  // Term `to`: sum_j a(j) v_j for j from `first` on.
  const auto set = [&](int to, int first, const auto& a) {
    Number<T, known> sum;
    for (int j = first; j < n; ++j) sum.add(v[j], a(j));
    put(sum.value(), terms, to);
    if (jacobian == nullptr) return;
    const int row = to * 2 * n;
    for (int d = 0; d < n; ++d) put(sum[1 + d], jacobian, row + d);
    for (int j = 0; j < n; ++j) put(j < first ? T(0) : a(j)[0], jacobian, row + n + j);
  };
  for (int i = 0; i < n; ++i) {
    set(i, i, [&](int j) { return e.mass(j, i); });
  }
  for (int i = 0; i < k; ++i) {
    set(n + i, 0, [&](int j) { return e.constraint(i, j); });
  }
  put(e.potential()[0], terms, n + k);
  if (jacobian == nullptr) return;
  const int row = (n + k) * 2 * n;
  for (int d = 0; d < n; ++d) put(e.potential()[1 + d], jacobian, row + d);
  for (int j = 0; j < n; ++j) put(T(0), jacobian, row + n + j);
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
  return (entry_count(functions) + n + functions.constraints) * known + 2 * n + n * n;
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
                    double* gradient,
                    double* hessian) {
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
  // l_v and g, each number with its derivatives by q.
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
  Number<T, known> l;
  l.add(T(-1), e.potential());
  for (int i = 0; i < n; ++i) {
    Number<T, known> sum;
    for (int j = 0; j < n; ++j) {
      const T* const entry = j <= i ? e.mass(i, j) : e.mass(j, i);
      sum.add(v[j], entry);
      if (j <= i) l.add(T(j < i ? 1 : 0.5) * v[i] * v[j], entry);
    }
    for (int j = 0; j < k; ++j) sum.add(-lambda[j], e.constraint(j, i));
    sum.store(momentum[i]);
  }
  for (int i = 0; i < k; ++i) {
    Number<T, known> sum;
    for (int j = 0; j < n; ++j) {
      const T* const entry = e.constraint(i, j);
      sum.add(u(j), entry);
      l.add(-lambda[i] * w(j), entry);
    }
    sum.store(g[i]);
    if (functions.gauge) g[i][0] += lambda[i];
  }
  const auto l_q = [&](int i) { return l[1 + i]; };
  const auto l_v = [&](int i) { return momentum[i][0]; };
  const auto l_vq = [&](int i, int j) { return momentum[i][1 + j]; };
  for (int i = 0; i < n; ++i) {
    put(T(0.5 * h) * l_q(i) - l_v(i), gradient, i);
    put(T(0.5 * h) * l_q(i) + l_v(i), gradient, n + i);
  }
  for (int i = 0; i < k; ++i) put(T(-h) * g[i][0], gradient, 2 * n + i);
  if (hessian == nullptr) return;
  set_hessian(functions, system, qm, v, lambda, l_qq);
  // Entry (row, column) and its mirror image.
  const auto set = [&](int row, int column, const T& value) {
    put(value, hessian, column * m + row);
    put(value, hessian, row * m + column);
  };
  for (int i = 0; i < n; ++i) {
    for (int j = 0; j < n; ++j) {
      const T position = T(0.25 * h) * l_qq[i * n + j];
      const T velocity = (j <= i ? e.mass(i, j) : e.mass(j, i))[0] / T(h);
      const T symmetric = T(0.5) * (l_vq(i, j) + l_vq(j, i));
      const T skew = T(0.5) * (l_vq(j, i) - l_vq(i, j));
      put(position - symmetric + velocity, hessian, j * m + i);
      put(position + symmetric + velocity, hessian, (n + j) * m + n + i);
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
      put(T(-h) * p, hessian, (2 * n + j) * m + 2 * n + i);
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

// Which lanes hold `rows` finite numbers. Packs have no sine of large angles (pack.h).
std::array<bool, kLanes> finite_lanes(const double* x, int rows) {
  LanePack sum(0);
  for (int i = 0; i < rows; ++i) sum += LanePack(0) * LanePack::load(x + i * kLanes);
  std::array<double, kLanes> zeros;
  sum.store(zeros.data());
  std::array<bool, kLanes> finite;
  for (int l = 0; l < kLanes; ++l) finite[l] = zeros[l] == 0;
  return finite;
}
bool all_of(const std::array<bool, kLanes>& lanes) {
  return std::all_of(lanes.begin(), lanes.end(), [](bool lane) { return lane; });
}

// Numbers of kLanes intervals side by side, `count` of each.
template <class T>
struct Lanes {
  T* data;
  int count;
};

// Calls run(arguments, results) for each interval that is not known, with its own numbers: what
// stands beside it is not to change. False where one fails; its numbers are NaN then.
template <std::size_t inputs, std::size_t outputs, class Run>
bool lane_by_lane(const std::array<bool, kLanes>& known,
                  const Lanes<const double> (&in)[inputs],
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
    if (known[l]) continue;
    for (std::size_t i = 0; i < inputs; ++i) {
      for (int a = 0; a < in[i].count; ++a) arguments[i][a] = in[i].data[a * kLanes + l];
    }
    const bool exists = run(from, to);
    good = good && exists;
    for (std::size_t i = 0; i < outputs; ++i) {
      for (int a = 0; a < out[i].count; ++a) {
        out[i].data[a * kLanes + l] =
            exists ? results[i][a] : std::numeric_limits<double>::quiet_NaN();
      }
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
    auto* const memory = scratch<double>(entry_count(functions) * length());
    terms_of<double, length()>(functions, system, qm, v, memory, terms, jacobian);
  };
  if (jacobian == nullptr) {
    run(std::integral_constant<int, 1>{});
  } else {
    with_rows(functions.dof, run);
  }
  return std::none_of(terms, terms + functions.dof, [](double r) { return std::isnan(r); });
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
    const int work = entry_count(functions) * length();
    auto* const memory = scratch<LanePack>(work + n);
    LanePack* const velocity = memory + work;
    for (int j = 0; j < n; ++j) velocity[j] = LanePack::load(v + j * kLanes);
    terms_of<LanePack, length()>(functions, system, qm, velocity, memory, terms, jacobian);
    return finite_lanes(terms, count);
  };
  std::array<bool, kLanes> good{};
  if (runs_on_packs(functions)) {
    good = slopes == 0 ? run(std::integral_constant<int, 1>{}) : with_packed_rows(n, run);
  }
  if (all_of(good)) return true;
  return lane_by_lane(
      good, {{qm, n}, {v, n}}, {{terms, count}, {jacobian, slopes}}, [&](auto in, auto out) {
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
  std::array<bool, kLanes> good{};
  if (runs_on_packs(functions)) {
    with_packed_rows(functions.dof, [&](auto length) {
      const int work = numbers_of_derivatives(functions, length());
      auto* const memory = scratch<LanePack>(work + m);
      LanePack* const at = memory + work;
      for (int i = 0; i < m; ++i) at[i] = LanePack::load(x + i * kLanes);
      derivatives_of<LanePack, length()>(functions, system, h, at, memory, gradient, hessian);
    });
    good = finite_lanes(gradient, m);
  }
  if (all_of(good)) return;
  lane_by_lane(good, {{x, m}}, {{gradient, m}, {hessian, second}}, [&](auto in, auto out) {
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
