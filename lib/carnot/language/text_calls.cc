#include "carnot/language/text_calls.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <limits>

#include "carnot/language/text_points.h"
#include "carnot/language/text_row_newton.h"
#include "carnot/system/packed_iteration.h"

namespace carnot::language {
namespace {

// y by Newton's method: warm from y, or cold where it is zero.
RateStatus solve(const TextSystem& s, const double& t, const double* z, double* y) {
  const int m = s.algebraic;
  TextUnknowns x = Eigen::Map<const Eigen::VectorXd>(y, m);
  const TextEquations equations = equations_at(s, at(s, t, z));
  const bool cold = (x.array() == 0).all();
  const RateStatus status = cold ? stationary_cold_start(equations, x)
                                 : StationaryNewton(equations).solve(Pursuit::kBranch, x);
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

// Where y is not warm: from the scene's guess.
void solve_from_guess(const TextSystem& s,
                      const Groups& rows,
                      const RowNewton::Lanes& warm,
                      RowNewton& newton,
                      double* y,
                      RowNewton::Lanes& solved) {
  std::array<double, RowFactor::kMost * kLanes> found;
  s.guess.run_rows(rows, std::array<double*, 1>{found.data()});
  RowNewton::Lanes cold;
  for (int l = 0; l < kLanes; ++l) cold[l] = 1 - warm[l];
  cold = newton.solve(Pursuit::kAnyNearby, cold, found.data());
  for (int k = 0; k < s.algebraic * kLanes; ++k) {
    if (cold[k % kLanes] == 1) y[k] = found[k];
  }
  for (int l = 0; l < kLanes; ++l) solved[l] += cold[l];
}

// y at all points: side by side where Newton's method comes to an end there, else one by one.
bool solve_rows(const TextSystem& s, const double* t, const double* z, double* y) {
  const int m = s.algebraic;
  RowNewton::Lanes solved{};
  RowNewton::Lanes warm{};
  for (int k = 0; k < m * kLanes; ++k) {
    if (y[k] != 0) warm[k % kLanes] = 1;
  }
  if (RowNewton::fits(m)) {
    const Groups rows = rows_at(s, t, z, y);
    RowNewton newton(s.hessian, rows, m);
    const auto count = std::count(warm.begin(), warm.end(), 1.0);
    if (count > 0) solved = newton.solve(Pursuit::kBranch, warm, y);
    if (s.has_guess && count < kLanes) solve_from_guess(s, rows, warm, newton, y, solved);
  }
  std::array<double, 2 * kMostDof> point;
  std::array<double, kMostMultipliers> solution;
  for (int l = 0; l < kLanes; ++l) {
    if (solved[l] == 1) continue;
    for (int k = 0; k < 2 * s.dof; ++k) point[k] = z[k * kLanes + l];
    for (int k = 0; k < m; ++k) solution[k] = y[k * kLanes + l];
    if (solve(s, t[l], point.data(), solution.data()) != RateStatus::kOk) return false;
    for (int k = 0; k < m; ++k) y[k * kLanes + l] = solution[k];
  }
  return true;
}

bool all_in_chart(const TextSystem& s, const double* z) {
  if (!s.has_chart) return true;
  std::array<double, kMostDof> q;
  for (int l = 0; l < kLanes; ++l) {
    for (int k = 0; k < s.dof; ++k) q[k] = z[k * kLanes + l];
    if (!regular_chart(s, q.data())) return false;
  }
  return true;
}

bool nonlinear_rates(
    const TextSystem& s, const double* t, const double* z, double* y, double* z_dot) {
  return all_in_chart(s, z) && solve_rows(s, t, z, y) &&
         s.rate.run_rows(rows_at(s, t, z, y), std::array<double*, 3>{z_dot, nullptr, nullptr});
}

bool rates(const void* opaque, const double* t, const double* z, double* y, double* z_dot) {
  const TextSystem& s = system_of(opaque);
  if (s.linear) {
    std::array<double, kMostChecks * kLanes> checks;
    const bool finite = s.rate.run_rows(rows_at(s, t, z, kIdle.data()),
                                        std::array<double*, 3>{z_dot, y, checks.data()});
    return finite && all_pass(s.rate_checks.size(), checks.data());
  }
  return nonlinear_rates(s, t, z, y, z_dot);
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
      : s_(s), data_(data), stride_(s.rate.slots() * sizeof(Register)) {}

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
      *reinterpret_cast<Register*>(memory_.data() + pass * stride_ + slot * sizeof(Register)) =
          Ops::register_of(Ops::load(row + pass * Ops::kSize));
    }
  }
  [[nodiscard]] Lane at(int pass, std::uint32_t slot) const {
    return Ops::of(*reinterpret_cast<const Register*>(memory_.data() + pass * stride_ +
                                                      slot * sizeof(Register)));
  }

  // Whether all points pass all checks, and the rates are finite.
  [[nodiscard]] bool all_are_rates() const {
    const std::uint32_t* const slots = s_.rate.outputs(0).data();
    typename Ops::Bools good(true);
    // Two sums, so that the additions need not wait for each other.
    Lane even(0.0);
    Lane odd(0.0);
    for (int pass = 0; pass < kPasses; ++pass) {
      for (const std::uint32_t slot : s_.rate.outputs(2))
        good = good & (at(pass, slot) > Lane(0.0));
      for (int k = 0; k < kSize; k += 2) {
        even += Lane(0.0) * at(pass, slots[k]);
        odd += Lane(0.0) * at(pass, slots[k + 1]);
      }
    }
    return Ops::all(good & (even + odd == Lane(0.0)));
  }

  double sweep(double* change) {
    const int* const inputs = s_.rate_slots.data();
    const double moved = move_stages<kSize, kLanes>(data_, change, [&](int k, const Pack<kLanes>&) {
      if (inputs[k] >= 0) put(data_.stages + k * kLanes, inputs[k]);
    });
    if (inputs[kSize] >= 0) put(data_.time, inputs[kSize]);
    for (int pass = 0; pass < kPasses; ++pass) s_.rate.execute(memory_.data() + pass * stride_);
    if (!all_are_rates()) return kNaN;
    const std::uint32_t* const slots = s_.rate.outputs(0).data();
    for (int pass = 0; pass < kPasses; ++pass) {
      const int first = pass * Ops::kSize;
      const Lane weight = Ops::load(data_.weights + first);
      for (int k = 0; k < kSize; ++k) {
        Ops::store(weight * at(pass, slots[k]), data_.increments + k * kLanes + first);
      }
      double* y = data_.algebraic + first;
      for (const std::uint32_t slot : s_.rate.outputs(1)) {
        Ops::store(at(pass, slot), y);
        y += kLanes;
      }
    }
    return moved;
  }

  const TextSystem& s_;
  const StageData& data_;
  std::size_t stride_;
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

std::vector<int> slots_of_rate(const TextSystem& system) {
  std::vector<int> slots(2 * system.dof + 1, -1);
  for (const Tape::Run& run : system.rate.inputs()) {
    for (std::uint32_t i = 0; i < run.count; ++i) {
      const int slot = static_cast<int>(run.slot + i);
      if (run.group == 0) slots[2 * system.dof] = slot;
      if (run.group == 1) slots[run.row + i] = slot;
      if (run.group == 2) slots[system.dof + run.row + i] = slot;
    }
  }
  return slots;
}

}  // namespace

void connect_calls(TextSystem& system) {
  system.rate_slots = slots_of_rate(system);
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
  connect_dynamics(system);
}

}  // namespace carnot::language
