#include "carnot/language/formulation.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <utility>

namespace carnot::language {
namespace {

class Formulator {
 public:
  Formulator(const SceneSource& scene,
             std::string_view text,
             const std::string& file,
             QuadraticBy quadratic)
      : scene_(scene), graph_(*scene.graph), text_(text), file_(file), quadratic_(quadratic) {}

  Formulation run() {
    out_.dof = scene_.dof();
    if (scene_.chart) out_.chart = scene_.chart->expression;
    if (scene_.hamiltonian) {
      generalized();
    } else if (scene_.lagrangian) {
      refuse(scene_.kinetic, "'kinetic' beside 'lagrangian'");
      refuse(scene_.mass, "'mass' beside 'lagrangian'");
      refuse(scene_.potential, "'potential' beside 'lagrangian'");
      lagrangian(*scene_.lagrangian);
    } else if (!scene_.controls.empty()) {
      control();
    } else if (scene_.kinetic || scene_.mass) {
      if (is_general()) {
        lagrangian(kinetic_less_potential());
      } else {
        velocity();
      }
    } else {
      fail({1, 1},
           "nothing is said that a path makes stationary; accepted: kinetic or mass, controls and "
           "cost, lagrangian, or hamiltonian");
    }
    guess();
    if (out_.dof > kMostDof) {
      fail({1, 1},
           "there are " + std::to_string(out_.dof) + " coordinates; accepted: at most " +
               std::to_string(kMostDof));
    }
    return std::move(out_);
  }

 private:
  [[noreturn]] void fail(const Place& place, const std::string& what) const {
    refuse_text(text_, file_, place, what);
  }

  SymbolicVector variables(const Block& block, int count) {
    SymbolicVector result;
    for (int i = 0; i < count; ++i) result.push_back(graph_.variable(block.first + i));
    return result;
  }
  SymbolicVector velocities() { return variables(kVelocity, scene_.dof()); }
  SymbolicVector momenta() { return variables(kMomentum, scene_.dof()); }

  bool depends(const Expression& e, const Block& block) {
    return graph_.depends(e, block.first, block.count);
  }
  bool depends(const SymbolicMatrix& m, const Block& block) {
    return std::any_of(
        m.entries.begin(), m.entries.end(), [&](const Expression& e) { return depends(e, block); });
  }
  // a with zeros for a block.
  Expression without(const Expression& a, const Block& block) {
    const SymbolicVector zeros(static_cast<std::size_t>(block.count), graph_.number(0));
    return graph_.substitute(a, block.first, zeros);
  }
  // x'M x/2, M symmetric, entry by entry: derivatives of that are short.
  Expression half_form(const SymbolicMatrix& m, const SymbolicVector& x) {
    SymbolicVector terms;
    for (int i = 0; i < m.rows; ++i) {
      terms.push_back(0.5 * (m(i, i) * x[i] * x[i]));
      for (int j = 0; j < i; ++j) terms.push_back(m(i, j) * x[i] * x[j]);
    }
    return graph_.sum(terms);
  }
  void refuse(const std::optional<Formula>& formula, const std::string& what) const {
    if (formula) fail(formula->place, what);
  }
  void refuse(const std::optional<MatrixFormula>& formula, const std::string& what) const {
    if (formula) fail(formula->place, what);
  }

  // Only Newton's method begins somewhere.
  void guess() {
    if (scene_.guess.empty()) return;
    const bool control = out_.kind == Formulation::Kind::kOptimalControl;
    if (!control && out_.kind != Formulation::Kind::kLagrangian) {
      fail(scene_.guess[0].second.place,
           "a guess is of use with controls and for a lagrangian only");
    }
    const Block& block = control ? kAlgebraic : kVelocity;
    out_.guess.assign(static_cast<std::size_t>(out_.algebraic), graph_.number(0));
    for (const auto& [of, formula] : scene_.guess) {
      const int i = static_cast<int>(graph_.node(of.node).index) - block.first;
      if (i < 0 || i >= out_.algebraic) fail(formula.place, "a guess of what is not to be found");
      if (depends(formula.expression, kVelocity) || depends(formula.expression, kAlgebraic)) {
        fail(formula.place, "a guess may depend on t, coordinates and momenta only");
      }
      out_.guess[i] = formula.expression;
    }
  }

  // ---- velocity constraints, H = p.v - v'M v/2 + V + lambda.G v

  SymbolicMatrix mass() {
    const int n = scene_.dof();
    if (scene_.mass) {
      refuse(scene_.kinetic, "'kinetic' beside 'mass'; one of them is enough");
      const MatrixFormula& given = *scene_.mass;
      if (given.rows != n || given.columns != n) {
        fail(given.place,
             "the mass is " + std::to_string(given.rows) + " x " + std::to_string(given.columns) +
                 "; accepted: a row and a column for "
                 "each of the " +
                 std::to_string(n) + " coordinates");
      }
      SymbolicMatrix m(graph_, n, n);
      m.entries = given.entries;
      for (int i = 0; i < n; ++i) {
        for (int j = 0; j < i; ++j) {
          if (!(m(i, j) - m(j, i)).is_zero()) fail(given.place, "the mass is not symmetric");
        }
      }
      if (depends(m, kVelocity) || depends(m, kTime)) {
        fail(given.place, "the mass may depend on the coordinates only");
      }
      return m;
    }
    const Formula& kinetic = *scene_.kinetic;
    const SymbolicVector slopes = gradient(graph_, kinetic.expression, kVelocity.first, n);
    SymbolicMatrix m = jacobian(graph_, slopes, kVelocity.first, n);
    const bool quadratic = !depends(m, kVelocity);
    if (quadratic && !without(kinetic.expression, kVelocity).is_zero()) {
      fail(kinetic.place,
           "the kinetic energy does not vanish at rest; accepted: potential = ... "
           "for the part without velocities");
    }
    const bool straight = std::all_of(slopes.begin(), slopes.end(), [&](const Expression& e) {
      return without(e, kVelocity).is_zero();
    });
    if (!quadratic || !straight) {
      fail(kinetic.place,
           "the kinetic energy is no quadratic form in the velocities; accepted: "
           "lagrangian = ... for any other function");
    }
    return m;
  }

  // Without velocities: h(q) = 0, which is noted.
  bool is_holonomic(const Formula& row) {
    if (depends(row.expression, kVelocity)) return false;
    if (depends(row.expression, kTime)) fail(row.place, "a holonomic constraint depends on t");
    if (row.expression.is_constant()) fail(row.place, "this equation has no coordinates");
    out_.holonomic.push_back(row.expression);
    return true;
  }

  // Dh q'.
  SymbolicVector hidden_constraints() {
    return product(
        graph_, jacobian(graph_, out_.holonomic, kConfiguration.first, scene_.dof()), velocities());
  }

  // The last of the multipliers are those of the holonomic constraints.
  void part_holonomic(SymbolicVector& lambda) {
    const auto l = static_cast<std::ptrdiff_t>(out_.holonomic.size());
    out_.holonomic_forces.assign(lambda.end() - l, lambda.end());
    lambda.erase(lambda.end() - l, lambda.end());
  }

  // Rows linear in the velocities, those that follow from holonomic constraints last.
  SymbolicMatrix linear_rows() {
    const int n = scene_.dof();
    SymbolicVector rows;
    for (const Formula& row : scene_.rows) {
      if (!is_holonomic(row)) rows.push_back(row.expression);
    }
    out_.multipliers = static_cast<int>(rows.size());
    for (const Expression& e : hidden_constraints()) rows.push_back(e);
    if (static_cast<int>(rows.size()) >= n) {
      fail(scene_.rows.back().place, "as many constraints as coordinates leave nothing free");
    }
    return jacobian(graph_, rows, kVelocity.first, n);
  }

  void velocity() {
    refuse(scene_.cost, "'cost' without controls");
    out_.kind = Formulation::Kind::kVelocityConstraints;
    const int n = scene_.dof();
    const SymbolicMatrix m = mass();
    const SymbolicMatrix g = linear_rows();
    const int k = g.rows;
    Expression potential = graph_.number(0);
    if (scene_.potential) {
      potential = scene_.potential->expression;
      if (depends(potential, kVelocity)) {
        fail(scene_.potential->place,
             "the potential may depend on the coordinates only; accepted: "
             "lagrangian = ... for any other function");
      }
    }
    const SymbolicVector v = velocities();
    const SymbolicVector p = momenta();
    std::vector<Check> rank;
    if (const auto frame = frame_of(graph_, g, rank)) {
      const SymbolicVector u = variables(kAlgebraic, n - k);
      out_.algebraic = n - k;
      const SymbolicVector speed = product(graph_, *frame, u);
      // v'M v/2 on the frame as the text has it: terms that vanish there do so before they meet.
      const Expression kinetic =
          scene_.kinetic ? graph_.substitute(scene_.kinetic->expression, kVelocity.first, speed)
                         : half_form(m, speed);
      const SymbolicMatrix reduced = jacobian(
          graph_, gradient(graph_, kinetic, kAlgebraic.first, n - k), kAlgebraic.first, n - k);
      out_.hamiltonian =
          graph_.sum(SymbolicVector{dot(graph_, p, speed), -half_form(reduced, u), potential});
      out_.checks = rank;
      definite(reduced, transposed_product(graph_, *frame, p), RateStatus::kMassNotPositive);
      multipliers(m, g, p, speed);
      part_holonomic(out_.lambda);
      for (Expression& mu : out_.holonomic_forces) {
        mu = graph_.substitute(mu, kAlgebraic.first, out_.solution);
      }
    } else {
      const SymbolicVector y = variables(kAlgebraic, n + k);
      const SymbolicVector speed(y.begin(), y.begin() + n);
      const SymbolicVector lambda(y.begin() + n, y.end());
      out_.algebraic = n + k;
      out_.hamiltonian = graph_.sum(SymbolicVector{dot(graph_, p, speed),
                                                   -half_form(m, speed),
                                                   potential,
                                                   dot(graph_, lambda, product(graph_, g, speed))});
      saddle(m, g, p, SymbolicVector(static_cast<std::size_t>(k), graph_.number(0)));
      out_.lambda = lambda;
      part_holonomic(out_.lambda);
      out_.holonomic_forces.assign(
          out_.solution.end() - static_cast<std::ptrdiff_t>(out_.holonomic.size()),
          out_.solution.end());
    }
    out_.constraint = product(graph_, g, v);
    out_.square_speed = dot(graph_, v, product(graph_, m, v));
    out_.masses = diagonal(m);
    SymbolicVector force = variables(kMultiplier, out_.multipliers);
    force.resize(static_cast<std::size_t>(k), graph_.number(0));
    out_.momentum = product(graph_, m, v);
    const SymbolicVector pushed = transposed_product(graph_, g, force);
    for (int i = 0; i < n; ++i) out_.momentum[i] = out_.momentum[i] - pushed[i];
    // Of the constraints of a path's intervals one would follow from the others and the ends.
    if (!out_.holonomic.empty()) return;
    const Expression l = graph_.sum(
        SymbolicVector{half_form(m, v), -potential, -dot(graph_, force, out_.constraint)});
    out_.transcription = TranscriptionFormulas{m, g, potential, false, l};
  }

  // y from A y = b, A = -H_yy positive definite.
  void definite(const SymbolicMatrix& a, const SymbolicVector& b, RateStatus status) {
    const SymbolicCholesky factor(graph_, a);
    factor.add_checks(status, out_.checks);
    out_.solution = factor.solve(b);
    out_.solve = [factor](const SymbolicVector& right) { return factor.solve(right); };
  }

  // (v, lambda) from M v - G'lambda = a, -G v = b, by M + gamma G'G, which is positive definite
  // where M is on ker G. A mass that is positive definite everywhere is taken as it is: most of
  // them are constant and diagonal, and nothing is left of their factors. (A skate's rates on the
  // sphere take 235 steps instead of 1060, their derivatives 1506 instead of 4650.) What gamma does
  // for rows that are nearly dependent, G v = -b to round-off, one correction of (v, lambda) does
  // then.
  void saddle(const SymbolicMatrix& m,
              const SymbolicMatrix& g,
              const SymbolicVector& a,
              const SymbolicVector& b) {
    const int n = m.rows;
    const int k = g.rows;
    SymbolicMatrix regular = m;
    Expression gamma = graph_.number(0);
    const SymbolicMatrix g_t = transposed(graph_, g);
    if (k > 0) {
      SymbolicCholesky(graph_, product(graph_, g, g_t))
          .add_checks(RateStatus::kConstraintRank, out_.checks);
    }
    if (k > 0 && !SymbolicCholesky(graph_, m).always_positive()) {
      const SymbolicMatrix square = product(graph_, g_t, g);
      SymbolicVector mass_trace;
      SymbolicVector square_trace;
      for (int i = 0; i < n; ++i) {
        mass_trace.push_back(m(i, i));
        square_trace.push_back(square(i, i));
      }
      gamma = graph_.sum(mass_trace) / graph_.sum(square_trace);
      if (gamma.is_zero()) gamma = graph_.number(1);
      for (int i = 0; i < n; ++i) {
        for (int j = 0; j < n; ++j) regular(i, j) = m(i, j) + gamma * square(i, j);
      }
    }
    const SymbolicCholesky factor(graph_, regular);
    factor.add_checks(RateStatus::kMassNotPositive, out_.checks);
    SymbolicMatrix w(graph_, n, k);  // A^-1 G'
    for (int i = 0; i < k; ++i) {
      SymbolicVector row;
      for (int j = 0; j < n; ++j) row.push_back(g(i, j));
      const SymbolicVector column = factor.solve(row);
      for (int j = 0; j < n; ++j) w(j, i) = column[j];
    }
    const SymbolicCholesky schur(graph_, product(graph_, g, w));
    Graph* const graph = &graph_;
    out_.solve = [=](const SymbolicVector& right) {
      SymbolicVector r(right.begin(), right.begin() + n);
      const SymbolicVector below(right.begin() + n, right.end());
      const SymbolicVector back = product(*graph, g_t, below);
      for (int i = 0; i < n && k > 0; ++i) r[i] = r[i] - gamma * back[i];
      SymbolicVector x = factor.solve(r);
      if (k == 0) return x;
      SymbolicVector s = product(*graph, g, x);
      for (int i = 0; i < k; ++i) s[i] = -(below[i] + s[i]);
      const SymbolicVector mu = schur.solve(s);
      const SymbolicVector pushed = product(*graph, w, mu);
      for (int i = 0; i < n; ++i) x[i] = x[i] + pushed[i];
      x.insert(x.end(), mu.begin(), mu.end());
      return x;
    };
    SymbolicVector right = a;
    right.insert(right.end(), b.begin(), b.end());
    out_.solution = out_.solve(right);
    if (k == 0 || !gamma.is_zero()) return;
    for (Expression& e : out_.solution) e = graph_.whole(e);
    const SymbolicVector v(out_.solution.begin(), out_.solution.begin() + n);
    SymbolicVector left(static_cast<std::size_t>(n), graph_.number(0));
    const SymbolicVector speed = product(graph_, g, v);
    for (int i = 0; i < k; ++i) left.push_back(graph_.whole(speed[i] + b[i]));
    const SymbolicVector correction = out_.solve(left);
    for (std::size_t i = 0; i < correction.size(); ++i) {
      out_.solution[i] = out_.solution[i] + correction[i];
    }
  }

  static SymbolicVector diagonal(const SymbolicMatrix& m) {
    SymbolicVector entries;
    for (int j = 0; j < m.columns; ++j) entries.push_back(m(j, j));
    return entries;
  }

  // G W, as in mass_norm.h: the weight of a coordinate is one over its mass.
  SymbolicMatrix weighed(const SymbolicMatrix& m, SymbolicMatrix g) {
    for (int j = 0; j < g.columns; ++j) {
      const Expression& mass = m(j, j);
      if (mass.is_constant() && !(mass.coefficient > 0)) continue;
      for (int i = 0; i < g.rows; ++i) g(i, j) = g(i, j) / mass;
    }
    return g;
  }

  // lambda from G W G'lambda = G W (M v - p).
  void multipliers(const SymbolicMatrix& m,
                   const SymbolicMatrix& g,
                   const SymbolicVector& p,
                   const SymbolicVector& v) {
    if (g.rows == 0) return;
    const SymbolicMatrix weighted = weighed(m, g);
    const SymbolicCholesky gram(graph_, product(graph_, weighted, transposed(graph_, g)));
    gram.add_checks(RateStatus::kConstraintRank, out_.lambda_checks);
    SymbolicVector excess = product(graph_, m, v);
    for (std::size_t i = 0; i < excess.size(); ++i) excess[i] = excess[i] - p[i];
    out_.lambda = gram.solve(product(graph_, weighted, excess));
  }

  // ---- Lagrangian, H = p.v - L + lambda.g

  // Kinetic energy and constraints are there, but t, or constraints that are not linear in the
  // velocities, ask for a Lagrangian.
  bool is_general() {
    const auto moves = [&](const Formula& f) { return depends(f.expression, kTime); };
    if (scene_.kinetic && moves(*scene_.kinetic)) return true;
    if (scene_.potential && moves(*scene_.potential)) return true;
    return std::any_of(scene_.rows.begin(), scene_.rows.end(), [&](const Formula& row) {
      if (!depends(row.expression, kVelocity)) return false;
      const SymbolicVector slopes = gradient(graph_, row.expression, kVelocity.first, scene_.dof());
      const bool linear = std::none_of(
          slopes.begin(), slopes.end(), [&](const Expression& e) { return depends(e, kVelocity); });
      return moves(row) || !linear || !without(row.expression, kVelocity).is_zero();
    });
  }

  Formula kinetic_less_potential() {
    Formula f = scene_.kinetic ? *scene_.kinetic
                               : Formula{half_form(mass(), velocities()), scene_.mass->place};
    if (scene_.kinetic) refuse(scene_.mass, "'mass' beside 'kinetic'; one of them is enough");
    if (scene_.potential) f.expression = f.expression - scene_.potential->expression;
    return f;
  }

  void lagrangian(const Formula& of) {
    refuse(scene_.cost, "'cost' without controls");
    if (!scene_.controls.empty()) fail(of.place, "a Lagrangian beside controls");
    out_.kind = Formulation::Kind::kLagrangian;
    const int n = scene_.dof();
    const Expression l = of.expression;
    SymbolicVector g;
    out_.autonomous = !depends(l, kTime);
    for (const Formula& row : scene_.rows) {
      if (is_holonomic(row)) continue;
      g.push_back(row.expression);
      out_.autonomous = out_.autonomous && !depends(row.expression, kTime);
    }
    out_.multipliers = static_cast<int>(g.size());
    for (const Expression& e : hidden_constraints()) g.push_back(e);
    const int k = static_cast<int>(g.size());
    if (k >= n) fail(scene_.rows.back().place, "as many constraints as coordinates");
    out_.algebraic = n + k;
    const SymbolicVector y = variables(kAlgebraic, n + k);
    const SymbolicVector speed(y.begin(), y.begin() + n);
    const SymbolicVector lambda(y.begin() + n, y.end());
    const SymbolicVector p = momenta();
    const auto at_speed = [&](const Expression& e) {
      return graph_.substitute(e, kVelocity.first, speed);
    };
    SymbolicVector terms{dot(graph_, p, speed), -at_speed(l)};
    for (int i = 0; i < k; ++i) terms.push_back(lambda[i] * at_speed(g[i]));
    out_.hamiltonian = graph_.sum(terms);
    out_.lambda = lambda;
    part_holonomic(out_.lambda);
    out_.constraint = g;
    const SymbolicVector v = velocities();
    const SymbolicVector slopes = gradient(graph_, l, kVelocity.first, n);
    const SymbolicMatrix m = jacobian(graph_, slopes, kVelocity.first, n);
    const SymbolicMatrix rows = jacobian(graph_, g, kVelocity.first, n);
    SymbolicVector force = variables(kMultiplier, out_.multipliers);
    force.resize(static_cast<std::size_t>(k), graph_.number(0));
    out_.momentum = slopes;
    const SymbolicVector pushed = transposed_product(graph_, rows, force);
    for (int i = 0; i < n; ++i) out_.momentum[i] = out_.momentum[i] - pushed[i];
    out_.linear = !depends(m, kVelocity) && !depends(rows, kVelocity);
    out_.may_be_indefinite = out_.linear && out_.holonomic.empty();
    if (out_.may_be_indefinite && quadratic_ == QuadraticBy::kNewton) out_.linear = false;
    if (!out_.linear && !out_.holonomic.empty()) {
      fail(of.place,
           "holonomic constraints with a Lagrangian that is not quadratic "
           "in the velocities; write coordinates on which they hold");
    }
    out_.masses = diagonal(m);
    if (!out_.linear) return;
    SymbolicVector a;
    SymbolicVector b;
    for (int i = 0; i < n; ++i) a.push_back(p[i] - without(slopes[i], kVelocity));
    for (int i = 0; i < k; ++i) b.push_back(without(g[i], kVelocity));
    saddle(m, rows, a, b);
    out_.holonomic_forces.assign(
        out_.solution.end() - static_cast<std::ptrdiff_t>(out_.holonomic.size()),
        out_.solution.end());
  }

  // ---- optimal control, H = p.f - l

  void control() {
    refuse(scene_.kinetic, "'kinetic' beside controls; accepted: cost = ...");
    refuse(scene_.mass, "'mass' beside controls; accepted: cost = ...");
    refuse(scene_.potential, "'potential' beside controls; accepted: cost = ...");
    if (!scene_.rows.empty()) {
      fail(scene_.rows[0].place,
           "an equation beside controls; accepted: x' = ... for each "
           "coordinate");
    }
    out_.kind = Formulation::Kind::kOptimalControl;
    const int n = scene_.dof();
    const int c = static_cast<int>(scene_.controls.size());
    if (!scene_.cost) fail({1, 1}, "there are controls, and no cost; accepted: cost = ...");
    const Expression cost = scene_.cost->expression;
    if (depends(cost, kVelocity)) {
      fail(scene_.cost->place,
           "the cost depends on velocities; accepted: coordinates and controls");
    }
    SymbolicVector f;
    out_.autonomous = !depends(cost, kTime);
    for (int i = 0; i < n; ++i) {
      if (i >= static_cast<int>(scene_.dynamics.size()) || !scene_.dynamics[i]) {
        fail(scene_.cost->place,
             "the velocity of " + scene_.coordinates[i].name +
                 " is not given; accepted: " + scene_.coordinates[i].name + "' = ...");
      }
      const Formula& row = *scene_.dynamics[i];
      if (depends(row.expression, kVelocity)) {
        fail(row.place, "a velocity on the right; accepted: coordinates and controls");
      }
      f.push_back(row.expression);
      out_.autonomous = out_.autonomous && !depends(row.expression, kTime);
    }
    if (c > 2 * n) fail(scene_.cost->place, "too many controls");
    out_.algebraic = c;
    const SymbolicVector p = momenta();
    out_.hamiltonian = dot(graph_, p, f) - cost;
    const SymbolicMatrix frame = jacobian(graph_, f, kAlgebraic.first, c);
    const SymbolicVector slopes = gradient(graph_, cost, kAlgebraic.first, c);
    const SymbolicMatrix weight = jacobian(graph_, slopes, kAlgebraic.first, c);
    out_.linear = !depends(frame, kAlgebraic) && !depends(weight, kAlgebraic);
    if (!out_.linear) return;
    const auto at_rest = [&](const Expression& e) { return without(e, kAlgebraic); };
    SymbolicVector b = transposed_product(graph_, frame, p);
    bool metric = out_.autonomous && at_rest(cost).is_zero();
    for (int i = 0; i < c; ++i) {
      const Expression linear = at_rest(slopes[i]);
      metric = metric && linear.is_zero();
      b[i] = b[i] - linear;
    }
    for (int i = 0; i < n; ++i) {
      out_.drift.push_back(at_rest(f[i]));
      metric = metric && out_.drift.back().is_zero();
    }
    definite(weight, b, RateStatus::kNotIndexOne);
    if (metric) metric_control(frame, weight);
  }

  // (F'F)^-1, made regular.
  SymbolicCholesky square_of(const SymbolicMatrix& frame) {
    constexpr double kRegular = 1e-14;
    const int c = frame.columns;
    const SymbolicMatrix frame_t = transposed(graph_, frame);
    SymbolicMatrix square = product(graph_, frame_t, frame);
    SymbolicVector trace;
    for (int i = 0; i < c; ++i) trace.push_back(square(i, i));
    const Expression small = kRegular * graph_.sum(trace);
    for (int i = 0; i < c; ++i) square(i, i) = square(i, i) + small;
    return {graph_, square};
  }

  // The velocities as those of a projector; see admissible_velocities.h. There are no momenta in
  // it, nor the time: their variables hold one over the units of the coordinates, and kappa.
  void metric_control(const SymbolicMatrix& own_frame, const SymbolicMatrix& weight) {
    const int n = own_frame.rows;
    const int c = own_frame.columns;
    const SymbolicVector v = velocities();
    const SymbolicVector own_controls =
        square_of(own_frame).solve(transposed_product(graph_, own_frame, v));
    out_.square_speed = dot(graph_, own_controls, product(graph_, weight, own_controls));
    const SymbolicVector per_unit = variables(kMomentum, n);
    SymbolicMatrix frame = own_frame;
    for (int i = 0; i < n; ++i) {
      for (int j = 0; j < c; ++j) frame(i, j) = per_unit[i] * frame(i, j);
    }
    const SymbolicCholesky factor = square_of(frame);
    SymbolicMatrix w(graph_, c, n);
    for (int j = 0; j < n; ++j) {
      SymbolicVector row;
      for (int i = 0; i < c; ++i) row.push_back(frame(j, i));
      const SymbolicVector column = factor.solve(row);
      for (int i = 0; i < c; ++i) w(i, j) = column[i];
    }
    TranscriptionFormulas formulas;
    formulas.gauge = true;
    formulas.mass = product(graph_, transposed(graph_, w), product(graph_, weight, w));
    const SymbolicMatrix gauge = product(graph_, frame, w);
    formulas.constraints = identity(graph_, n);
    for (int i = 0; i < n; ++i) {
      for (int j = 0; j < n; ++j) {
        formulas.constraints(i, j) = formulas.constraints(i, j) - gauge(i, j);
      }
    }
    formulas.potential = graph_.number(0);
    const SymbolicVector lambda = variables(kMultiplier, n);
    const Expression kappa = graph_.variable(kTime.first);
    const SymbolicVector b = transposed_product(graph_, frame, lambda);
    const SymbolicVector u = factor.solve(transposed_product(graph_, frame, v));
    const Expression running = dot(graph_, u, product(graph_, weight, u));
    formulas.lagrangian =
        graph_.sum(SymbolicVector{0.5 * running,
                                  -(0.5 * kappa * dot(graph_, b, factor.solve(b))),
                                  dot(graph_, b, u),
                                  -dot(graph_, lambda, v)});
    out_.transcription = std::move(formulas);
  }

  // ---- generalized Hamiltonian, J z' = grad H(z)

  void generalized() {
    refuse(scene_.kinetic, "'kinetic' beside 'hamiltonian'");
    refuse(scene_.mass, "'mass' beside 'hamiltonian'");
    refuse(scene_.potential, "'potential' beside 'hamiltonian'");
    refuse(scene_.cost, "'cost' beside 'hamiltonian'");
    refuse(scene_.lagrangian, "'lagrangian' beside 'hamiltonian'");
    if (!scene_.rows.empty()) fail(scene_.rows[0].place, "an equation beside 'hamiltonian'");
    if (!scene_.controls.empty()) fail(scene_.hamiltonian->place, "'hamiltonian' beside controls");
    out_.kind = Formulation::Kind::kGeneralizedHamiltonian;
    if (!scene_.drawing.empty()) fail(scene_.drawing[0].place, "'draw' beside 'hamiltonian'");
    if (scene_.path || !scene_.reports.empty()) {
      fail(scene_.hamiltonian->place, "'path' or 'report' beside 'hamiltonian'");
    }
    const int size = scene_.dof();
    const Expression h = scene_.hamiltonian->expression;
    if (depends(h, kVelocity)) {
      fail(scene_.hamiltonian->place,
           "the hamiltonian depends on velocities; accepted: coordinates, "
           "all of z");
    }
    if (!scene_.structure) {
      fail(scene_.hamiltonian->place,
           "there is no structure; accepted: structure = [0, -1; 1, 0], "
           "the antisymmetric J of J z' = grad H(z)");
    }
    const std::vector<double> j = constants(*scene_.structure, size);
    try {
      if (scene_.basis) {
        const int rank = darboux_form(j, size).dof;
        out_.darboux = darboux_form(j, size, rank, constants(*scene_.basis, size));
      } else {
        out_.darboux = darboux_form(j, size);
      }
    } catch (const std::invalid_argument& error) {
      fail(scene_.structure->place, error.what());
    }
    const int n = out_.darboux->dof;
    const int m = size - 2 * n;
    if (n > kMostDof || m > 2 * n) {
      fail(scene_.structure->place,
           "the structure has rank " + std::to_string(2 * n) + " of " + std::to_string(size) +
               "; accepted: a rank from " + "half the size to " + std::to_string(2 * kMostDof));
    }
    out_.dof = n;
    out_.algebraic = m;
    out_.multipliers = m;
    out_.autonomous = !depends(h, kTime);
    SymbolicVector x = variables(kConfiguration, n);
    for (const Expression& e : variables(kMomentum, n)) x.push_back(e);
    for (const Expression& e : variables(kAlgebraic, m)) x.push_back(e);
    SymbolicVector z;
    for (int i = 0; i < size; ++i) {
      SymbolicVector terms;
      for (int l = 0; l < size; ++l) terms.push_back(out_.darboux->basis[l * size + i] * x[l]);
      z.push_back(graph_.sum(terms));
    }
    out_.hamiltonian = graph_.substitute(h, kConfiguration.first, z);
    out_.lambda = variables(kAlgebraic, m);
    out_.linear = m == 0;
    if (m == 0) out_.solve = [](const SymbolicVector& b) { return b; };
  }

  // Column by column, as darboux.h has matrices.
  std::vector<double> constants(const MatrixFormula& m, int size) {
    if (m.rows != size || m.columns != size) {
      fail(m.place,
           "the matrix is " + std::to_string(m.rows) + " x " + std::to_string(m.columns) +
               "; accepted: a row and a column for each of the " + std::to_string(size) +
               " coordinates");
    }
    std::vector<double> numbers(m.entries.size());
    for (int i = 0; i < size; ++i) {
      for (int j = 0; j < size; ++j) {
        if (!m(i, j).is_constant()) fail(m.place, "an entry of the matrix is not constant");
        numbers[j * size + i] = m(i, j).coefficient;
      }
    }
    return numbers;
  }

  const SceneSource& scene_;
  Graph& graph_;
  std::string_view text_;
  const std::string& file_;
  QuadraticBy quadratic_;
  Formulation out_;
};

}  // namespace

std::string_view kind_text(const Formulation& formulation) {
  switch (formulation.kind) {
    case Formulation::Kind::kVelocityConstraints:
      return formulation.holonomic.empty() ? "velocity constraints"
                                           : "velocity + holonomic constraints";
    case Formulation::Kind::kLagrangian:
      return "Lagrangian";
    case Formulation::Kind::kOptimalControl:
      return "optimal control";
    case Formulation::Kind::kGeneralizedHamiltonian:
      return "generalized Hamiltonian";
  }
  return "";
}

Formulation formulate(const SceneSource& scene,
                      std::string_view text,
                      const std::string& file,
                      QuadraticBy quadratic) {
  return Formulator(scene, text, file, quadratic).run();
}

}  // namespace carnot::language
