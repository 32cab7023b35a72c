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

template <int dof>
StageReport iterate(const void* opaque,
                    const StageData& data,
                    const IterationLimits<double>& limits) {
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
  connect_dynamics(system);
}

}  // namespace carnot::language
