#include "carnot/language/text_calls.h"

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <limits>

#include "carnot/language/text_newton.h"
#include "carnot/numerics/jacobi_rotations.h"
#include "carnot/numerics/round_off.h"
#include "carnot/scene/chart.h"
#include "carnot/system/packed_iteration.h"

namespace carnot::language {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
constexpr int kLanes = kErasedLanes;
static_assert(kLanes == kTapeLanes);
constexpr int kMostChecks = 64;
constexpr int kMostMultipliers = 2 * kMostDof;
// Numbers that nobody reads: of groups that a tape depends on for results that are not wanted.
constexpr std::array<double, kMostCoordinates * kLanes> kIdle{};

using Groups = TextEquations::Groups;
using Vector = Eigen::VectorXd;
using Matrix = Eigen::MatrixXd;

const TextBound& bound(const void* opaque) { return *static_cast<const TextBound*>(opaque); }
const TextSystem& system_of(const void* opaque) { return *bound(opaque).system; }

// The groups of one phase point, z = (q, p).
Groups at(const TextSystem& s, const double& t, const double* z, const double* y = kIdle.data()) {
  return {&t, z, z + s.dof, y, kIdle.data(), kIdle.data()};
}
Groups at(const double& t, const double* q, const double* p, const double* y) {
  return {&t, q, p, y, kIdle.data(), kIdle.data()};
}
Groups at_velocity(const double& t, const double* q, const double* v, const double* lambda) {
  return {&t, q, kIdle.data(), kIdle.data(), v, lambda};
}

bool all_finite(const double* x, int count) {
  double sum = 0;
  for (int i = 0; i < count; ++i) sum += 0 * x[i];
  return sum == 0;
}

// The first check that fails, of values at one point.
RateStatus status_of_checks(const std::vector<RateStatus>& statuses, const double* values) {
  for (std::size_t i = 0; i < statuses.size(); ++i) {
    if (values[i] > 0) continue;
    return std::isfinite(values[i]) ? statuses[i] : RateStatus::kNotFinite;
  }
  return RateStatus::kOk;
}

bool regular_chart(const TextSystem& s, const double* q) {
  if (!s.has_chart) return true;
  double value = 0;
  const double t = 0;
  const std::array<double*, 1> out{&value};
  s.chart.run(at(t, q, kIdle.data(), kIdle.data()), out);
  return std::abs(value) > kNearSingularChart;
}

TextEquations equations_at(const TextSystem& s, const Groups& groups) {
  const int m = s.algebraic;
  TextEquations equations(s.linear ? s.hessian : s.equations, s.hessian, groups, s.dof, m, m, true);
  if (s.has_guess && !s.linear) equations.begin_at(s.guess);
  return equations;
}

// y by Newton's method: warm from y, or cold where it is zero.
RateStatus solve(const TextSystem& s, const double& t, const double* z, double* y) {
  const int m = s.algebraic;
  TextUnknowns x = Eigen::Map<const Vector>(y, m);
  const TextEquations equations = equations_at(s, at(s, t, z));
  const bool cold = (x.array() == 0).all();
  const RateStatus status =
      cold ? stationary_cold_start(equations, x) : StationaryNewton(equations).solve(true, x);
  if (status == RateStatus::kOk) std::copy_n(x.data(), m, y);
  return status;
}

RateStatus rate(const void* opaque, double t, const double* z, double* y, double* z_dot) {
  const TextSystem& s = system_of(opaque);
  if (!s.linear && !regular_chart(s, z)) return RateStatus::kChart;
  std::array<double, 2 * kMostDof> out;
  if (s.linear) {
    std::array<double, kMostMultipliers> solution;
    std::array<double, kMostChecks> checks;
    const std::array<double*, 3> groups{out.data(), solution.data(), checks.data()};
    s.rate.run(at(s, t, z), groups);
    const RateStatus status = status_of_checks(s.rate_checks, checks.data());
    if (status != RateStatus::kOk) return status;
    if (!all_finite(out.data(), 2 * s.dof)) return RateStatus::kNotFinite;
    std::copy_n(solution.data(), s.algebraic, y);
  } else {
    std::array<double, kMostMultipliers> solution;
    std::copy_n(y, s.algebraic, solution.data());
    const RateStatus status = solve(s, t, z, solution.data());
    if (status != RateStatus::kOk) return status;
    const std::array<double*, 3> groups{out.data(), nullptr, nullptr};
    s.rate.run(at(s, t, z, solution.data()), groups);
    if (!all_finite(out.data(), 2 * s.dof)) return RateStatus::kNotFinite;
    std::copy_n(solution.data(), s.algebraic, y);
  }
  std::copy_n(out.data(), 2 * s.dof, z_dot);
  return RateStatus::kOk;
}

// d(z')/dz = (0 I; -I 0) S, S = H_zz - H_zy H_yy^-1 H_yz.
RateStatus newton_jacobian(
    const TextSystem& s, const double& t, const double* z, const double* y, double* jacobian) {
  constexpr int kSize = 2 * kMostDof;
  const int size = 2 * s.dof;
  const int m = s.algebraic;
  std::array<double, kMostMultipliers> slopes;
  std::array<double, kMostMultipliers * kMostMultipliers> h_yy;
  std::array<double, kMostMultipliers * kSize> h_yz;
  std::array<double, kSize * kSize> h_zz;
  const Groups point = at(s, t, z, y);
  s.hessian.run(point, std::array<double*, 2>{slopes.data(), h_yy.data()});
  s.jacobian.run(point, std::array<double*, 2>{h_yz.data(), h_zz.data()});
  TextSquare a(m, m);
  for (int i = 0; i < m; ++i) {
    for (int j = 0; j < m; ++j) a(i, j) = h_yy[i * m + j];
  }
  const TextEquations::Factor factor(a);
  if (!factor.regular()) return RateStatus::kNotIndexOne;
  for (int c = 0; c < size; ++c) {
    TextUnknowns column(m);
    for (int i = 0; i < m; ++i) column[i] = h_yz[i * size + c];
    const TextUnknowns y_z = factor.solve(column);
    for (int r = 0; r < size; ++r) {
      double sum = h_zz[r * size + c];
      for (int i = 0; i < m; ++i) sum -= h_yz[i * size + r] * y_z[i];
      jacobian[c * size + (r < s.dof ? r + s.dof : r - s.dof)] = r < s.dof ? -sum : sum;
    }
  }
  return all_finite(jacobian, size * size) ? RateStatus::kOk : RateStatus::kNotFinite;
}

RateStatus jacobian(const void* opaque, double t, const double* z, const double* y, double* out) {
  const TextSystem& s = system_of(opaque);
  if (!s.linear) {
    return regular_chart(s, z) ? newton_jacobian(s, t, z, y, out) : RateStatus::kChart;
  }
  const int size = 2 * s.dof;
  std::array<double, 4 * kMostDof * kMostDof> rows;
  std::array<double, kMostChecks> checks;
  s.jacobian.run(at(s, t, z), std::array<double*, 2>{rows.data(), checks.data()});
  const RateStatus status = status_of_checks(s.rate_checks, checks.data());
  if (status != RateStatus::kOk) return status;
  for (int r = 0; r < size; ++r) {
    for (int c = 0; c < size; ++c) out[c * size + r] = rows[r * size + c];
  }
  return all_finite(out, size * size) ? RateStatus::kOk : RateStatus::kNotFinite;
}

// Whether all the points of rows pass all checks.
bool all_pass(std::size_t checks, const double* values) {
  using P = Pack<kLanes>;
  bool pass = true;
  for (std::size_t i = 0; i < checks; ++i) {
    pass = pass && all(P::load(values + i * kLanes) > P(0.0));
  }
  return pass;
}

Groups rows_at(const TextSystem& s, const double* t, const double* z, const double* y) {
  return {t, z, z + s.dof * kLanes, y, kIdle.data(), kIdle.data()};
}

bool rates(const void* opaque, const double* t, const double* z, double* y, double* z_dot) {
  const TextSystem& s = system_of(opaque);
  if (s.linear) {
    std::array<double, kMostChecks * kLanes> checks;
    const bool finite = s.rate.run_rows(rows_at(s, t, z, kIdle.data()),
                                        std::array<double*, 3>{z_dot, y, checks.data()});
    return finite && all_pass(s.rate_checks.size(), checks.data());
  }
  const int size = 2 * s.dof;
  std::array<double, 2 * kMostDof> point;
  std::array<double, 2 * kMostDof> out;
  std::array<double, kMostMultipliers> solution;
  for (int l = 0; l < kLanes; ++l) {
    for (int k = 0; k < size; ++k) point[k] = z[k * kLanes + l];
    for (int k = 0; k < s.algebraic; ++k) solution[k] = y[k * kLanes + l];
    if (rate(opaque, t[l], point.data(), solution.data(), out.data()) != RateStatus::kOk) {
      return false;
    }
    for (int k = 0; k < size; ++k) z_dot[k * kLanes + l] = out[k];
    for (int k = 0; k < s.algebraic; ++k) y[k * kLanes + l] = solution[k];
  }
  return true;
}

bool jacobians(
    const void* opaque, const double* t, const double* z, const double* weights, double* out) {
  const TextSystem& s = system_of(opaque);
  if (!s.linear) return false;
  const int count = 4 * s.dof * s.dof;
  std::array<double, kMostChecks * kLanes> checks;
  const bool finite = s.jacobian.run_rows(rows_at(s, t, z, kIdle.data()),
                                          std::array<double*, 2>{out, checks.data()});
  if (!finite || !all_pass(s.rate_checks.size(), checks.data())) return false;
  using P = Pack<kLanes>;
  const P weight = P::load(weights);
  for (int k = 0; k < count; ++k) (weight * P::load(out + k * kLanes)).store(out + k * kLanes);
  return true;
}

// The iteration on the tape of a linear system without a copy on the way: rows of the stages go
// right into its slots, and rates right into the increments.
template <int dof>
class TapeIteration {
 public:
  static constexpr int kSize = 2 * dof;
  using Lane = pack_lane::Widest<kLanes>::type;
  using Ops = pack_lane::Ops<Lane>;
  using Register = typename Ops::Register;
  static constexpr int kPasses = kLanes / Ops::kSize;  // registers for a row
  static constexpr std::size_t kRoom = 32768;          // bytes on the stack

  static bool fits(const TextSystem& s) {
    return kPasses * s.rate.slots() * sizeof(Register) <= kRoom;
  }

  TapeIteration(const TextSystem& s, const StageData& data)
      : s_(s), data_(data), stride_(s.rate.slots() * sizeof(Register)) {
    slots_.fill(-1);
    for (const Tape::Run& run : s.rate.inputs()) {
      for (std::uint32_t i = 0; i < run.count; ++i) {
        const int slot = static_cast<int>((run.slot + i) * sizeof(Register));
        if (run.group == 1) slots_[run.row + i] = slot;
        if (run.group == 2) slots_[dof + run.row + i] = slot;
        if (run.group == 0) time_ = slot;
      }
    }
  }

  StageReport run(const IterationLimits<double>& limits) {
    StageReport report;
    report.end = iterate_stages<double, kSize>(
        limits,
        [&](double* change) {
          ++report.sweeps;
          return sweep(change);
        },
        [&] { return scale_of_stages<kSize, kLanes>(data_); });
    return report;
  }

 private:
  // A row of numbers into a slot of each pass.
  void put(const double* row, int slot) {
    for (int pass = 0; pass < kPasses; ++pass) {
      *reinterpret_cast<Register*>(memory_.data() + pass * stride_ + slot) =
          Ops::register_of(Ops::load(row + pass * Ops::kSize));
    }
  }
  [[nodiscard]] Lane at(int pass, std::uint32_t slot) const {
    return Ops::of(*reinterpret_cast<const Register*>(memory_.data() + pass * stride_ +
                                                      slot * sizeof(Register)));
  }

  double sweep(double* change) {
    const double moved = move_stages<kSize, kLanes>(data_, change, [&](int k, const Pack<kLanes>&) {
      if (slots_[k] >= 0) put(data_.stages + k * kLanes, slots_[k]);
    });
    if (time_ >= 0) put(data_.time, time_);
    bool good = true;
    for (int pass = 0; pass < kPasses; ++pass) {
      s_.rate.execute(memory_.data() + pass * stride_);
      for (const std::uint32_t slot : s_.rate.outputs(2)) {
        good = good && Ops::all(at(pass, slot) > Lane(0.0));
      }
      const Lane weight = Ops::load(data_.weights + pass * Ops::kSize);
      Lane even(0.0);
      Lane odd(0.0);
      const std::uint32_t* const slots = s_.rate.outputs(0).data();
      for (int k = 0; k < kSize; k += 2) {
        const Lane a = weight * at(pass, slots[k]);
        const Lane b = weight * at(pass, slots[k + 1]);
        even += Lane(0.0) * a;
        odd += Lane(0.0) * b;
        rates_[pass][k] = Ops::register_of(a);
        rates_[pass][k + 1] = Ops::register_of(b);
      }
      good = good && Ops::all(even + odd == Lane(0.0));
      double* y = data_.algebraic + pass * Ops::kSize;
      for (const std::uint32_t slot : s_.rate.outputs(1)) {
        Ops::store(at(pass, slot), y);
        y += kLanes;
      }
    }
    if (!good) return kNaN;
    // Not before all of them are known to exist.
    for (int pass = 0; pass < kPasses; ++pass) {
      for (int k = 0; k < kSize; ++k) {
        Ops::store(Ops::of(rates_[pass][k]), data_.increments + k * kLanes + pass * Ops::kSize);
      }
    }
    return moved;
  }

  const TextSystem& s_;
  const StageData& data_;
  std::size_t stride_;
  std::array<int, kSize> slots_;
  int time_ = -1;
  Register rates_[kPasses][kSize];
  alignas(64) std::array<std::byte, kRoom> memory_;
};

template <int dof>
StageReport iterate(const void* opaque,
                    const StageData& data,
                    const IterationLimits<double>& limits) {
  const TextSystem& s = system_of(opaque);
  if (s.linear && TapeIteration<dof>::fits(s)) return TapeIteration<dof>(s, data).run(limits);
  return iterate_with<2 * dof, kLanes>(
      [&](double* z_dot) { return rates(opaque, data.time, data.stages, data.algebraic, z_dot); },
      data,
      limits);
}

double hamiltonian(
    const void* opaque, double t, const double* q, const double* p, const double* y) {
  double h = kNaN;
  system_of(opaque).point.run(at(t, q, p, y),
                              std::array<double*, 4>{&h, nullptr, nullptr, nullptr});
  return h;
}

RateStatus find_multipliers(const void* opaque,
                            double t,
                            const double* q,
                            const double* p,
                            const double* y,
                            double* lambda) {
  const TextSystem& s = system_of(opaque);
  std::array<double, kMostChecks> checks;
  s.lambda.run(at(t, q, p, y), std::array<double*, 2>{lambda, checks.data()});
  return status_of_checks(s.lambda_checks, checks.data());
}

// |g| / max(1, |v|), with the largest entry as |v|; `stride` between the numbers.
double relative_constraint(const TextSystem& s, const double* g, const double* v, int stride) {
  double square = 0;
  double size = 1;
  for (int i = 0; i < s.constraint_count; ++i) square += g[i * stride] * g[i * stride];
  for (int i = 0; i < s.dof; ++i) size = std::max(size, std::abs(v[i * stride]));
  return std::sqrt(square) / size;
}

void measure(const void* opaque,
             int count,
             const double* t,
             const double* weights,
             const double* z,
             const double* dq,
             const double* y,
             PointMeasures* out) {
  const TextSystem& s = system_of(opaque);
  const int n = s.dof;
  std::array<double, kMostDof * kLanes> v;
  for (int k = 0; k < n; ++k) {
    for (int l = 0; l < kLanes; ++l) v[k * kLanes + l] = dq[k * kLanes + l] / weights[l];
  }
  std::array<double, kLanes> h;
  std::array<double, kLanes> power;
  std::array<double, kLanes> speed;
  std::array<double, kMostMultipliers * kLanes> g;
  Groups rows = rows_at(s, t, z, y);
  rows[4] = v.data();
  s.point.run_rows(rows, std::array<double*, 4>{h.data(), power.data(), speed.data(), g.data()});
  for (int l = 0; l < count; ++l) {
    double work = 0;
    for (int k = 0; k < n; ++k) work += z[(n + k) * kLanes + l] * v[k * kLanes + l];
    out[l].lagrangian = work - h[l];
    out[l].speed = s.metric ? std::sqrt(speed[l]) : kNaN;
    out[l].power = s.autonomous ? 0 : power[l];
    out[l].constraint = relative_constraint(s, g.data() + l, v.data() + l, kLanes);
  }
}

// max of |h| and |Dh v| over max(1, |v|), of which the first alone is the second's `position`.
struct OffManifold {
  double position = 0;
  double velocity = 0;  // |Dh v|
};

OffManifold off_manifold(const TextSystem& s, const double& t, const double* q, const double* v) {
  std::array<double, kMostDof> h;
  std::array<double, kMostDof * kMostDof> dh;
  s.holonomic.run(at(t, q, kIdle.data(), kIdle.data()),
                  std::array<double*, 2>{h.data(), dh.data()});
  OffManifold off;
  for (int i = 0; i < s.holonomic_count; ++i) {
    double rate = 0;
    for (int j = 0; j < s.dof; ++j) rate += dh[i * s.dof + j] * v[j];
    off.position = std::max(off.position, std::abs(h[i]));
    off.velocity = std::max(off.velocity, std::abs(rate));
  }
  return off;
}

double largest(const double* x, int count) {
  double most = 0;
  for (int i = 0; i < count; ++i) most = std::max(most, std::abs(x[i]));
  return most;
}

NodeMeasures measure_node(const void* opaque, double t, const double* z, double* y) {
  const TextSystem& s = system_of(opaque);
  NodeMeasures out;
  out.hamiltonian = kNaN;
  std::array<double, 2 * kMostDof> z_dot;
  if (rate(opaque, t, z, y, z_dot.data()) != RateStatus::kOk) return out;
  std::array<double, kMostMultipliers> g;
  Groups point = at(s, t, z, y);
  point[4] = z_dot.data();
  s.point.run(point, std::array<double*, 4>{&out.hamiltonian, nullptr, nullptr, g.data()});
  out.constraint = relative_constraint(s, g.data(), z_dot.data(), 1);
  if (s.holonomic_count > 0) {
    const OffManifold off = off_manifold(s, t, z, z_dot.data());
    const double size = std::max(1.0, largest(z_dot.data(), s.dof));
    out.holonomic = std::max(off.position, off.velocity / size);
  }
  return out;
}

void branch(const void* opaque, double* y) {
  const std::vector<double>& branch = bound(opaque).branch;
  std::copy(branch.begin(), branch.end(), y);
}

// ---- of Dynamics

Regularity regularity_of(const TextSquare& a) {
  const TextEquations::Factor factor(a);
  const int m = static_cast<int>(a.rows());
  TextSquare inverse(m, m);
  for (int i = 0; i < m; ++i) {
    inverse.col(i) = factor.solve(TextUnknowns(TextUnknowns::Unit(m, i)));
  }
  const auto norm = [](const TextSquare& x) { return x.cwiseAbs().colwise().sum().maxCoeff(); };
  const double condition =
      inverse.allFinite() ? norm(a) * norm(inverse) : std::numeric_limits<double>::infinity();
  return {factor.determinant(), condition};
}

// F_xx of equations at x.
TextSquare hessian_at(const TextEquations& equations, const TextUnknowns& x) {
  const int size = equations.size();
  TextUnknowns residual(size);
  TextSquare hessian(size, size);
  equations.linearize(x, residual, hessian);
  return hessian;
}

Regularity regularity(const void* opaque, double t, const double* q, const double* p) {
  const TextSystem& s = system_of(opaque);
  const int m = s.algebraic;
  if (m == 0) return {1, 1};
  std::vector<double> z(q, q + s.dof);
  z.insert(z.end(), p, p + s.dof);
  std::vector<double> y = bound(opaque).branch;
  std::vector<double> z_dot(z.size());
  (void)rate(opaque, t, z.data(), y.data(), z_dot.data());
  const Groups groups = at(s, t, z.data());
  return regularity_of(hessian_at({s.hessian, s.hessian, groups, s.dof, m, m, true},
                                  Eigen::Map<const Vector>(y.data(), m)));
}

double chart(const void* opaque, const double* q) {
  double value = 0;
  const double t = 0;
  system_of(opaque).chart.run(at(t, q, kIdle.data(), kIdle.data()), std::array<double*, 1>{&value});
  return value;
}

double norm(const double* x, int count) { return Eigen::Map<const Vector>(x, count).norm(); }

// v <- the nearest velocity with g(t, q, v) = 0, by Gauss-Newton steps of least norm; as
// LagrangianSystem::project().
bool project(const TextSystem& s, const double& t, const double* q, Vector& v) {
  constexpr int kMaxIterations = 50;
  const int n = s.dof;
  const int k = s.constraint_count;
  if (k == 0) return true;
  const double resolution = 4 * std::numeric_limits<double>::epsilon();
  Vector x = v;
  double last = std::numeric_limits<double>::max();
  for (int iteration = 0; iteration < kMaxIterations; ++iteration) {
    Vector g(k);
    Matrix columns(n, k);  // the rows of G, one after the other
    s.constraint.run(at_velocity(t, q, x.data(), kIdle.data()),
                     std::array<double*, 2>{g.data(), columns.data()});
    if (!(g.allFinite() && columns.allFinite())) return false;
    if ((g.array() == 0).all()) {
      v = x;
      return true;
    }
    const TextSquare gram = columns.transpose().lazyProduct(columns);
    const TextEquations::Factor factor(gram);
    if (!factor.regular()) return false;
    const Vector step = -columns.lazyProduct(Vector(factor.solve(g)));
    const double size = step.norm();
    x += step;
    const double few = resolution * x.norm();
    if (size <= few || (size <= 16 * few && size >= last)) {
      v = x;
      return true;
    }
    last = size;
  }
  return false;
}

double velocity_momentum(
    const void* opaque, double t, const double* q, double* q_dot, const double* lambda, double* p) {
  const TextSystem& s = system_of(opaque);
  const int n = s.dof;
  Vector v = Eigen::Map<const Vector>(q_dot, n);
  const double size = v.norm();
  std::vector<double> g(static_cast<std::size_t>(s.constraint_count));
  bool found = true;
  if (s.linear) {
    std::array<double, kMostChecks> checks;
    std::array<double, kMostDof> projected;
    s.projected.run(at_velocity(t, q, q_dot, lambda),
                    std::array<double*, 3>{projected.data(), g.data(), checks.data()});
    found = status_of_checks(s.projected_checks, checks.data()) == RateStatus::kOk;
    std::copy_n(projected.data(), n, v.data());
  } else {
    s.constraint.run(at_velocity(t, q, q_dot, lambda), std::array<double*, 2>{g.data(), nullptr});
    found = project(s, t, q, v);
  }
  if (!found) v.setConstant(kNaN);
  s.momentum.run(at_velocity(t, q, v.data(), lambda), std::array<double*, 1>{p});
  std::copy_n(v.data(), n, q_dot);
  if (!v.allFinite()) return kNaN;
  const double violated = norm(g.data(), s.constraint_count);
  return violated == 0 ? 0 : violated / size;
}

// Least squares and least norm with A, as numerics/pseudo_inverse.h.
class TextPseudoInverse {
 public:
  explicit TextPseudoInverse(const Matrix& a)
      : w_(a), v_(Matrix::Identity(a.cols(), a.cols())), square_(a.cols()) {
    const int rows = static_cast<int>(a.rows());
    const int cols = static_cast<int>(a.cols());
    static_cast<void>(orthogonalise_columns(rows, cols, w_.data(), v_.data()));
    for (int j = 0; j < cols; ++j) square_[j] = w_.col(j).squaredNorm();
    const double largest = square_.maxCoeff();
    const double round_off = (rows + cols) * std::numeric_limits<double>::epsilon();
    for (int j = 0; j < cols; ++j) {
      if (square_[j] <= round_off * round_off * largest) square_[j] = 0;
    }
  }
  [[nodiscard]] Vector solve(const Vector& b) const {
    Vector x = Vector::Zero(v_.rows());
    for (int j = 0; j < square_.size(); ++j) {
      if (square_[j] != 0) x += (w_.col(j).dot(b) / square_[j]) * v_.col(j);
    }
    return x;
  }
  [[nodiscard]] Vector solve_transposed(const Vector& c) const {
    Vector y = Vector::Zero(w_.rows());
    for (int j = 0; j < square_.size(); ++j) {
      if (square_[j] != 0) y += (v_.col(j).dot(c) / square_[j]) * w_.col(j);
    }
    return y;
  }

 private:
  Matrix w_;
  Matrix v_;
  Vector square_;
};

// With R = L L', u = L'^-1 w costs |w|^2/2: the velocities of w are F L'^-1, and p is the least
// with F'p = R u + r, r the linear part of the cost.
bool linear_control_momentum(
    const TextSystem& s, const double& t, const double* q, Vector& v, double& violated, Vector& p) {
  const int n = s.dof;
  const int c = s.controls_count;
  Matrix frame(n, c);
  Vector drift(n);
  Matrix weight(c, c);
  Vector linear(c);
  s.controls.run(at(t, q, kIdle.data(), kIdle.data()),
                 std::array<double*, 4>{frame.data(), drift.data(), weight.data(), linear.data()});
  Matrix lower = Matrix::Zero(c, c);
  for (int j = 0; j < c; ++j) {
    for (int i = j; i < c; ++i) {
      double sum = weight(i, j);
      for (int k = 0; k < j; ++k) sum -= lower(i, k) * lower(j, k);
      lower(i, j) = i == j ? std::sqrt(sum) : sum / lower(j, j);
    }
  }
  // B = F L'^-1 and L^-1 r, column by column.
  for (int j = 0; j < c; ++j) {
    for (int k = 0; k < j; ++k) {
      frame.col(j) -= lower(j, k) * frame.col(k);
      linear[j] -= lower(j, k) * linear[k];
    }
    frame.col(j) /= lower(j, j);
    linear[j] /= lower(j, j);
  }
  const TextPseudoInverse inverse(frame);
  const Vector wanted = v;
  const Vector w = inverse.solve(wanted - drift);
  v = drift + frame.lazyProduct(w);
  p = inverse.solve_transposed(w + linear);
  violated = (wanted - v).norm();
  if (violated > 0) violated /= std::max(wanted.norm(), drift.norm());
  return v.allFinite() && p.allFinite();
}

// u by Gauss-Newton from zero; as OptimalControl::general_momentum().
bool general_control_momentum(
    const TextSystem& s, const double& t, const double* q, Vector& v, double& violated, Vector& p) {
  constexpr int kMaxIterations = 50;
  constexpr int kMaxHalvings = 30;
  const int n = s.dof;
  const int c = s.controls_count;
  Matrix jacobian(n, c);
  Vector slope(c);
  const auto velocity = [&](const Vector& u) {
    Vector f(n);
    s.dynamics.run(at(t, q, kIdle.data(), u.data()),
                   std::array<double*, 3>{f.data(), jacobian.data(), slope.data()});
    return f;
  };
  const Vector wanted = v;
  Vector u = Vector::Zero(c);
  const double rest = velocity(u).norm();
  // The guess for p = v.
  if (s.has_guess) {
    s.guess.run(at(t, q, wanted.data(), kIdle.data()), std::array<double*, 1>{u.data()});
  }
  v = velocity(u);
  bool falling = true;
  for (int iteration = 0; iteration < kMaxIterations && falling; ++iteration) {
    v = velocity(u);
    const Vector step = TextPseudoInverse(jacobian).solve(wanted - v);
    double length = 1;
    falling = false;
    for (int halving = 0; halving < kMaxHalvings && !falling; ++halving, length *= 0.5) {
      const Vector trial = u + length * step;
      const Vector reached = velocity(trial);
      falling = (wanted - reached).norm() < (wanted - v).norm();
      if (!falling) continue;
      u = trial;
      v = reached;
    }
  }
  v = velocity(u);
  p = TextPseudoInverse(jacobian).solve_transposed(slope);
  violated = (wanted - v).norm();
  if (violated > 0) violated /= std::max(wanted.norm(), rest);
  const Vector left = jacobian.transpose().lazyProduct(p) - slope;
  return v.allFinite() &&
         left.norm() <= std::sqrt(std::numeric_limits<double>::epsilon()) * slope.norm();
}

double control_momentum(const void* opaque,
                        double t,
                        const double* q,
                        double* q_dot,
                        const double* /*lambda*/,
                        double* p_out) {
  const TextSystem& s = system_of(opaque);
  Vector v = Eigen::Map<const Vector>(q_dot, s.dof);
  Vector p = Vector::Constant(s.dof, kNaN);
  double violated = kNaN;
  bool found = regular_chart(s, q);
  found = found && (s.linear ? linear_control_momentum(s, t, q, v, violated, p)
                             : general_control_momentum(s, t, q, v, violated, p));
  if (!found) {
    v.setConstant(kNaN);
    violated = kNaN;
  }
  std::copy_n(v.data(), s.dof, q_dot);
  std::copy_n(p.data(), s.dof, p_out);
  return violated;
}

// As GeneralizedHamiltonian::admissible_momentum().
double generalized_momentum(
    const void* opaque, double t, const double* q, double* q_dot, const double* lambda, double* p) {
  constexpr double kRegular = 1e8;  // at this condition half of the digits are left
  const TextSystem& s = system_of(opaque);
  const int n = s.dof;
  const int m = s.algebraic;
  const Groups groups{&t, q, kIdle.data(), kIdle.data(), q_dot, lambda};
  const TextEquations legendre(s.legendre, s.legendre, groups, n, n + m, n + m, false);
  const TextEquations held(s.held, s.held, groups, n, n + m, n + m, false);
  TextUnknowns x(n + m);
  for (int i = 0; i < n; ++i) x[i] = q_dot[i];
  for (int i = 0; i < m; ++i) x[n + i] = lambda[i];
  const bool regular = regularity_of(hessian_at(legendre, x)).condition < kRegular;
  const TextEquations& equations = regular ? legendre : held;
  bool found = StationaryNewton(equations).solve(true, x) == RateStatus::kOk;
  found = found || stationary_cold_start(equations, x) == RateStatus::kOk;
  std::copy_n(x.data(), n, p);
  double violated = 0;
  if (found && !regular) {
    std::vector<double> z(q, q + n);
    z.insert(z.end(), p, p + n);
    std::vector<double> y(lambda, lambda + m);
    if (m > 0) {
      TextUnknowns at_lambda(m);
      for (int i = 0; i < m; ++i) at_lambda[i] = lambda[i];
      violated = equations_at(s, at(s, t, z.data())).residual(at_lambda).norm();
      const double size = norm(q_dot, n);
      if (size > 0) violated /= size;
    }
    std::vector<double> z_dot(z.size());
    found = rate(opaque, t, z.data(), y.data(), z_dot.data()) == RateStatus::kOk;
    if (found) std::copy_n(z_dot.data(), n, q_dot);
  }
  if (found) return violated;
  std::fill_n(q_dot, n, kNaN);
  return kNaN;
}

// The solution whose multipliers are nearest to lambda; as LagrangianSystem::branch().
RateStatus nearest_branch(
    const TextSystem& s, const double& t, const double* z, const Vector& lambda, TextUnknowns& y) {
  const int n = s.dof;
  const int k = s.multipliers;
  const TextEquations equations = equations_at(s, at(s, t, z));
  TextUnknowns found(s.algebraic);
  RateStatus result = stationary_cold_start(equations, found);
  if (result == RateStatus::kOk) y = found;
  if (k == 0) return result;
  const auto distance = [&](const TextUnknowns& x) {
    return (x.tail(k) - lambda).cwiseAbs().maxCoeff();
  };
  double nearest =
      result == RateStatus::kOk ? distance(y) : std::numeric_limits<double>::infinity();
  const auto search = [&](const Vector& centre) {
    constexpr std::array kOffsets{0.0, 0.01, -0.01, 0.1, -0.1, 0.3, -0.3, 1.0, -1.0, 3.0, -3.0};
    const double size = 1 + centre.cwiseAbs().maxCoeff();
    for (int moved = 0; moved < k; ++moved) {
      for (const double offset : kOffsets) {
        // v at fixed multipliers, then both.
        std::vector<double> start(static_cast<std::size_t>(n + k), 0.0);
        for (int i = 0; i < k; ++i) start[n + i] = centre[i] + (i == moved ? offset * size : 0);
        TextEquations at_fixed(
            s.hessian, s.hessian, at(s, t, z, start.data()), n, s.algebraic, n, true);
        if (s.has_guess && !s.linear) at_fixed.begin_at(s.guess);
        TextUnknowns v(n);
        RateStatus status = stationary_cold_start(at_fixed, v);
        if (status == RateStatus::kOk) {
          for (int i = 0; i < n; ++i) start[i] = v[i];
          found = Eigen::Map<const Vector>(start.data(), n + k);
          status = StationaryNewton(equations).solve(false, found);
        }
        if (status == RateStatus::kOk && distance(found) < nearest) {
          nearest = distance(found);
          y = found;
        }
        if (result != RateStatus::kOk) result = status;
      }
    }
  };
  const Vector cold = found.tail(k);
  const bool cold_found = result == RateStatus::kOk;
  search(lambda);
  if (cold_found) search(cold);
  return result;
}

std::shared_ptr<const void> on_branch(
    const void* opaque, double t, const double* q, const double* p, const double* lambda) {
  const TextSystem& s = system_of(opaque);
  std::vector<double> z(q, q + s.dof);
  z.insert(z.end(), p, p + s.dof);
  const Vector wanted = Eigen::Map<const Vector>(lambda, s.multipliers);
  TextUnknowns y = TextUnknowns::Zero(s.algebraic);
  RateStatus status = RateStatus::kOk;
  if (s.kind == Formulation::Kind::kLagrangian) {
    status = nearest_branch(s, t, z.data(), wanted, y);
  } else if (s.algebraic > 0) {
    y = wanted;
    const TextEquations equations = equations_at(s, at(s, t, z.data()));
    status = (y.array() == 0).all() ? stationary_cold_start(equations, y)
                                    : StationaryNewton(equations).solve(true, y);
  }
  if (status != RateStatus::kOk) return nullptr;
  auto other = std::make_shared<TextBound>(bound(opaque));
  other->branch.assign(y.data(), y.data() + s.algebraic);
  return other;
}

// ---- of holonomic constraints

HolonomicResiduals holonomic_residuals(const void* opaque, double t, const double* z) {
  const TextSystem& s = system_of(opaque);
  std::vector<double> y = bound(opaque).branch;
  std::array<double, 2 * kMostDof> z_dot{};
  const bool moves = rate(opaque, t, z, y.data(), z_dot.data()) == RateStatus::kOk;
  const OffManifold off = off_manifold(s, t, z, z_dot.data());
  HolonomicResiduals residuals;
  residuals.position = off.position;
  if (moves) {
    const double size = largest(z_dot.data(), s.dof);
    residuals.velocity = size > 0 ? off.velocity / size : 0;
  }
  return residuals;
}

// q by Gauss-Newton steps of least norm, as project_configuration(); then p + Dh'mu.
bool project_on_manifold(const void* opaque, double t, double* z) {
  constexpr int kMaxIterations = 50;
  const TextSystem& s = system_of(opaque);
  const int n = s.dof;
  const int l = s.holonomic_count;
  Vector q = Eigen::Map<const Vector>(z, n);
  Vector h(l);
  Matrix columns(n, l);  // the rows of Dh, one after the other
  const auto evaluate = [&] {
    s.holonomic.run(at(t, q.data(), kIdle.data(), kIdle.data()),
                    std::array<double*, 2>{h.data(), columns.data()});
  };
  double smallest = std::numeric_limits<double>::max();
  bool found = false;
  for (int iteration = 0; iteration < kMaxIterations && !found; ++iteration) {
    evaluate();
    const TextSquare gram = columns.transpose().lazyProduct(columns);
    const TextEquations::Factor factor(gram);
    if (!factor.regular()) return false;
    const Vector correction = columns.lazyProduct(Vector(factor.solve(h)));
    const double change = correction.cwiseAbs().maxCoeff();
    const double resolution = std::numeric_limits<double>::epsilon() * q.cwiseAbs().maxCoeff();
    found =
        change <= resolution || (!(change < smallest) && change <= kStalledRoundOff * resolution);
    smallest = std::min(smallest, change);
    if (!found) q -= correction;
  }
  if (!found) return false;
  std::copy_n(q.data(), n, z);
  Vector mu(l);
  if (!s.forces.run(at(s, t, z), std::array<double*, 2>{mu.data(), nullptr})) return false;
  const Vector pushed = columns.lazyProduct(mu);
  for (int i = 0; i < n; ++i) z[n + i] += pushed[i];
  return true;
}

// I - A'(A A')^-1 A, where the rows of A are those of (Dh, 0) and of d mu/dz.
bool tangent_projector(const void* opaque, double t, const double* z, double* projector) {
  const TextSystem& s = system_of(opaque);
  const int n = s.dof;
  const int l = s.holonomic_count;
  Vector h(l);
  Matrix dh(n, l);
  Vector mu(l);
  Matrix slopes(2 * n, l);
  s.holonomic.run(at(s, t, z), std::array<double*, 2>{h.data(), dh.data()});
  if (!s.forces.run(at(s, t, z), std::array<double*, 2>{mu.data(), slopes.data()})) return false;
  TextSquare gram(2 * l, 2 * l);
  Matrix columns = Matrix::Zero(2 * n, 2 * l);
  columns.topLeftCorner(n, l) = dh;
  columns.rightCols(l) = slopes;
  gram = columns.transpose().lazyProduct(columns);
  const TextEquations::Factor factor(gram);
  if (!factor.regular()) return false;
  Eigen::Map<Matrix> p(projector, 2 * n, 2 * n);
  p.setIdentity();
  for (int i = 0; i < 2 * n; ++i) {
    const Vector row = columns.row(i).transpose();
    p.col(i) -= columns.lazyProduct(Vector(factor.solve(row)));
  }
  return p.allFinite();
}

// ---- of the transcription

void entries(const void* opaque, const double* q, bool slopes, double* out) {
  const TextSystem& s = system_of(opaque);
  const double t = 0;
  const Tape& tape = slopes ? s.slopes : s.entries;
  tape.run(at(t, q, kIdle.data(), kIdle.data()), std::array<double*, 1>{out});
}

void lagrangian_hessian(
    const void* opaque, const double* q, const double* v, const double* lambda, double* l_qq) {
  const double t = 0;
  system_of(opaque).lagrangian_hessian.run(at_velocity(t, q, v, lambda),
                                           std::array<double*, 1>{l_qq});
}

}  // namespace

void connect_calls(TextSystem& system) {
  using Iterate = StageReport (*)(const void*, const StageData&, const IterationLimits<double>&);
  constexpr std::array<Iterate, kMostDof> kIterate{iterate<1>,
                                                   iterate<2>,
                                                   iterate<3>,
                                                   iterate<4>,
                                                   iterate<5>,
                                                   iterate<6>,
                                                   iterate<7>,
                                                   iterate<8>,
                                                   iterate<9>,
                                                   iterate<10>,
                                                   iterate<11>,
                                                   iterate<12>};
  assert(1 <= system.dof && system.dof <= kMostDof);
  assert(system.rate_checks.size() <= kMostChecks);
  system.functions = {system.dof,
                      system.algebraic,
                      system.multipliers,
                      system.linear,
                      rate,
                      jacobian,
                      rates,
                      jacobians,
                      kIterate[system.dof - 1],
                      hamiltonian,
                      find_multipliers,
                      measure,
                      measure_node,
                      branch};
  system.transcription = {system.dof, system.transcribed, false, entries, lagrangian_hessian};
  Dynamics::Calls& calls = system.calls;
  if (system.has_chart) calls.chart = chart;
  if (system.holonomic_count > 0) {
    calls.holonomic_residuals = holonomic_residuals;
    calls.project_on_manifold = project_on_manifold;
    calls.tangent_projector = tangent_projector;
  }
  switch (system.kind) {
    case Formulation::Kind::kVelocityConstraints:
      calls.momentum = velocity_momentum;
      break;
    case Formulation::Kind::kLagrangian:
      calls.momentum = velocity_momentum;
      calls.regularity = regularity;
      calls.branch = on_branch;
      break;
    case Formulation::Kind::kOptimalControl:
      calls.momentum = control_momentum;
      calls.regularity = regularity;
      break;
    case Formulation::Kind::kGeneralizedHamiltonian:
      calls.momentum = generalized_momentum;
      calls.regularity = regularity;
      calls.branch = on_branch;
      break;
  }
}

}  // namespace carnot::language
