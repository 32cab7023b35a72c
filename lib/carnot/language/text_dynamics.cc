// The calls of a Dynamics from text that are made now and then: momenta of velocities, branches,
// holonomic constraints, the transcription.
#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "carnot/language/text_calls.h"
#include "carnot/language/text_points.h"
#include "carnot/numerics/pseudo_inverse.h"
#include "carnot/numerics/round_off.h"
#include "carnot/system/mass_norm.h"

namespace carnot::language {
namespace {

using Vector = Eigen::VectorXd;
using Matrix = Eigen::MatrixXd;

// a x and a'b by loops. Products of Eigen are summed in one order or another by how memory happens
// to be aligned, and a result must not depend on that.
template <class A>
Vector product(const A& a, const Vector& x) {
  Vector sum = Vector::Zero(a.rows());
  for (Eigen::Index j = 0; j < a.cols(); ++j) {
    for (Eigen::Index i = 0; i < a.rows(); ++i) sum[i] += a(i, j) * x[j];
  }
  return sum;
}
TextSquare gram_of(const Matrix& a, const Matrix& b) {
  TextSquare gram = TextSquare::Zero(a.cols(), a.cols());
  for (Eigen::Index j = 0; j < a.cols(); ++j) {
    for (Eigen::Index k = 0; k < a.cols(); ++k) {
      for (Eigen::Index i = 0; i < a.rows(); ++i) gram(j, k) += a(i, j) * b(i, k);
    }
  }
  return gram;
}

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
  (void)s.functions.rate(opaque, t, z.data(), y.data(), z_dot.data());
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

// The masses of mass_norm.h at (t, q, v).
Vector counted_masses(const TextSystem& s, const double& t, const double* q, const Vector& v) {
  Vector masses(s.dof);
  s.masses.run(at_velocity(t, q, v.data(), kIdle.data()), std::array<double*, 1>{masses.data()});
  for (double& mass : masses) mass = counted_mass(mass);
  return masses;
}

// v <- the nearest velocity with g(t, q, v) = 0 in the norm of `masses`, by Gauss-Newton steps; as
// LagrangianSystem::project().
bool project(
    const TextSystem& s, const double& t, const double* q, const Vector& masses, Vector& v) {
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
    const Matrix weighted = masses.cwiseInverse().asDiagonal() * columns;
    const TextEquations::Factor factor(gram_of(weighted, columns));
    if (!factor.regular()) return false;
    const Vector step = -product(weighted, factor.solve(g));
    const double size = mass_norm(masses, step);
    x += step;
    const double few = resolution * mass_norm(masses, x);
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
  const Vector given = v;
  const Vector masses = counted_masses(s, t, q, v);
  if (!project(s, t, q, masses, v)) v.setConstant(kNaN);
  s.momentum.run(at_velocity(t, q, v.data(), lambda), std::array<double*, 1>{p});
  std::copy_n(v.data(), n, q_dot);
  return relative_move(masses, given, v);
}

using TextPseudoInverse = PseudoInverse<double, Eigen::Dynamic, Eigen::Dynamic>;

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
  v = drift + product(frame, w);
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
  const Vector left = product(jacobian.transpose(), p) - slope;
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
  bool found = StationaryNewton(equations).solve(Pursuit::kBranch, x) == RateStatus::kOk;
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
    found = s.functions.rate(opaque, t, z.data(), y.data(), z_dot.data()) == RateStatus::kOk;
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
          status = StationaryNewton(equations).solve(Pursuit::kAny, found);
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
                                    : StationaryNewton(equations).solve(Pursuit::kBranch, y);
  }
  if (status != RateStatus::kOk) return nullptr;
  auto other = std::make_shared<TextBound>(bound(opaque));
  other->branch.assign(y.data(), y.data() + s.algebraic);
  return other;
}

// ---- of holonomic constraints

void holonomic(
    const void* opaque, double t, const double* z, double* h, double* dh, double* q_dot) {
  const TextSystem& s = system_of(opaque);
  s.holonomic.run(at(t, z, kIdle.data(), kIdle.data()), std::array<double*, 2>{h, dh});
  std::vector<double> y = bound(opaque).branch;
  std::array<double, 2 * kMostDof> z_dot{};
  if (s.functions.rate(opaque, t, z, y.data(), z_dot.data()) == RateStatus::kOk) {
    std::copy_n(z_dot.data(), s.dof, q_dot);
  } else {
    std::fill_n(q_dot, s.dof, kNaN);
  }
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
    const TextSquare gram = gram_of(columns, columns);
    const TextEquations::Factor factor(gram);
    if (!factor.regular()) return false;
    const Vector correction = product(columns, factor.solve(h));
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
  if (!s.forces.run(at(s, t, z), std::array<double*, 1>{mu.data()})) return false;
  const Vector pushed = product(columns, mu);
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
  Matrix slopes(2 * n, l);
  s.holonomic.run(at(s, t, z), std::array<double*, 2>{h.data(), dh.data()});
  if (!s.slopes_of_forces.run(at(s, t, z), std::array<double*, 1>{slopes.data()})) return false;
  TextSquare gram(2 * l, 2 * l);
  Matrix columns = Matrix::Zero(2 * n, 2 * l);
  columns.topLeftCorner(n, l) = dh;
  columns.rightCols(l) = slopes;
  gram = gram_of(columns, columns);
  const TextEquations::Factor factor(gram);
  if (!factor.regular()) return false;
  Eigen::Map<Matrix> p(projector, 2 * n, 2 * n);
  p.setIdentity();
  for (int i = 0; i < 2 * n; ++i) {
    const Vector row = columns.row(i).transpose();
    p.col(i) -= product(columns, factor.solve(row));
  }
  return p.allFinite();
}

// ---- of the transcription

// The units of a gauge as the tapes take them: in the place of momenta and of the time, which do
// not occur there.
struct UnitInputs {
  std::array<double, kMostDof> per_unit;
  double weight;

  UnitInputs(const GaugeUnits& units, int n) : weight(units.weight) {
    for (int j = 0; j < n; ++j) per_unit[j] = units.q != nullptr ? 1 / units.q[j] : 1;
  }
};

void entries(
    const void* opaque, const double* q, const GaugeUnits& units, bool slopes, double* out) {
  const TextSystem& s = system_of(opaque);
  const UnitInputs in(units, s.dof);
  const Tape& tape = slopes ? s.slopes : s.entries;
  tape.run(at(in.weight, q, in.per_unit.data(), kIdle.data()), std::array<double*, 1>{out});
  if (!slopes) return;
  // From the last row to the first, since they come to stand further apart.
  const int known = 1 + s.dof;
  const int length = row_length(s.dof);
  for (int row = entry_count(s.transcription) - 1; row >= 0; --row) {
    if (row > 0) {
      std::copy_backward(out + row * known, out + (row + 1) * known, out + row * length + known);
    }
    std::fill(out + row * length + known, out + (row + 1) * length, 0.0);
  }
}

void lagrangian_hessian(const void* opaque,
                        const double* q,
                        const double* v,
                        const double* lambda,
                        const GaugeUnits& units,
                        double* l_qq) {
  const TextSystem& s = system_of(opaque);
  const UnitInputs in(units, s.dof);
  s.lagrangian_hessian.run(Groups{&in.weight, q, in.per_unit.data(), kIdle.data(), v, lambda},
                           std::array<double*, 1>{l_qq});
}

// The same for points side by side.
struct PackedUnitInputs {
  std::array<double, kMostDof * kLanes> per_unit;
  std::array<double, kLanes> weight;

  PackedUnitInputs(const GaugeUnits& units, int n) {
    const UnitInputs one(units, n);
    weight.fill(one.weight);
    for (int j = 0; j < n; ++j) std::fill_n(&per_unit[j * kLanes], kLanes, one.per_unit[j]);
  }
};

void packed_entries(
    const void* opaque, const double* q, const GaugeUnits& units, bool slopes, double* out) {
  const TextSystem& s = system_of(opaque);
  const PackedUnitInputs in(units, s.dof);
  const Tape& tape = slopes ? s.slopes : s.entries;
  tape.run_rows(
      Groups{in.weight.data(), q, in.per_unit.data(), kIdle.data(), kIdle.data(), kIdle.data()},
      std::array<double*, 1>{out});
}

void packed_hessian(const void* opaque,
                    const double* q,
                    const double* v,
                    const double* lambda,
                    const GaugeUnits& units,
                    double* l_qq) {
  const TextSystem& s = system_of(opaque);
  const PackedUnitInputs in(units, s.dof);
  s.lagrangian_hessian.run_rows(
      Groups{in.weight.data(), q, in.per_unit.data(), kIdle.data(), v, lambda},
      std::array<double*, 1>{l_qq});
}

}  // namespace

void connect_dynamics(TextSystem& system) {
  static_assert(kLanes == kTranscriptionLanes);
  system.transcription = {system.dof,
                          system.transcribed,
                          false,
                          entries,
                          lagrangian_hessian,
                          packed_entries,
                          packed_hessian};
  Dynamics::Calls& calls = system.calls;
  if (system.has_chart) calls.chart = chart;
  if (system.holonomic_count > 0) {
    calls.holonomic = holonomic;
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
