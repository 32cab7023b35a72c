// From formulas to tapes.
#include "carnot/language/text_system.h"

#include <algorithm>
#include <array>
#include <utility>

#include "carnot/language/text_calls.h"
#include "carnot/scene/chart.h"

namespace carnot::language {
namespace {

class TapeMaker {
 public:
  TapeMaker(const Formulation& f, Graph& graph, TextSystem& system)
      : f_(f), graph_(graph), system_(system) {
    n_ = f.dof;
    m_ = f.algebraic;
    const int most = std::max(f.multipliers, system.transcribed);
    inputs_ = {kTime,
               first_of(kConfiguration, n_),
               first_of(kMomentum, n_),
               first_of(kAlgebraic, m_),
               first_of(kVelocity, n_),
               first_of(kMultiplier, most)};
  }

  void run() {
    for (int i = 0; i < n_; ++i) z_.push_back(kConfiguration.first + i);
    for (int i = 0; i < n_; ++i) z_.push_back(kMomentum.first + i);
    for (const Expression& y : f_.solution) whole_solution_.push_back(graph_.whole(y));
    if (f_.linear) {
      linear_rate();
    } else {
      newton();
    }
    points();
    velocities();
    if (f_.kind == Formulation::Kind::kOptimalControl) controls();
    if (f_.kind == Formulation::Kind::kGeneralizedHamiltonian) transforms();
    if (f_.kind != Formulation::Kind::kVelocityConstraints) hessian();
    if (!f_.holonomic.empty()) holonomic();
    if (f_.chart) system_.chart = tape({{*f_.chart}});
    if (f_.transcription) transcription(*f_.transcription);
  }

 private:
  Tape tape(const std::vector<SymbolicVector>& groups) {
    SymbolicVector all;
    std::vector<int> sizes;
    for (const SymbolicVector& group : groups) {
      all.insert(all.end(), group.begin(), group.end());
      sizes.push_back(static_cast<int>(group.size()));
    }
    return {graph_, inputs_, all, sizes};
  }
  SymbolicVector gradient_of(const Expression& e, const Block& block, int count) {
    return gradient(graph_, e, block.first, count);
  }
  Expression at_solution(const Expression& e) {
    return graph_.substitute(e, kAlgebraic.first, whole_solution_);
  }
  static SymbolicVector values(const std::vector<Check>& checks,
                               std::vector<RateStatus>& statuses) {
    SymbolicVector result;
    for (const Check& check : checks) {
      result.push_back(check.value);
      statuses.push_back(check.status);
    }
    return result;
  }

  // (H_p, -H_q).
  SymbolicVector motion() {
    SymbolicVector rate = gradient_of(f_.hamiltonian, kMomentum, n_);
    for (const Expression& e : gradient_of(f_.hamiltonian, kConfiguration, n_)) rate.push_back(-e);
    return rate;
  }

  // H_zz, entry (i, j) with i <= j.
  SymbolicMatrix second_derivatives(bool solved) {
    SymbolicMatrix s(graph_, 2 * n_, 2 * n_);
    for (int i = 0; i < 2 * n_; ++i) {
      const Expression slope = graph_.derivative(f_.hamiltonian, z_[i]);
      for (int j = i; j < 2 * n_; ++j) {
        const Expression e = graph_.derivative(slope, z_[j]);
        s(i, j) = solved ? at_solution(e) : e;
        s(j, i) = s(i, j);
      }
    }
    return s;
  }

  // H_yz.
  SymbolicMatrix mixed_derivatives(bool solved) {
    SymbolicMatrix mixed(graph_, m_, 2 * n_);
    for (int i = 0; i < m_; ++i) {
      const Expression slope = graph_.derivative(f_.hamiltonian, kAlgebraic.first + i);
      for (int j = 0; j < 2 * n_; ++j) {
        const Expression e = graph_.derivative(slope, z_[j]);
        mixed(i, j) = solved ? at_solution(e) : e;
      }
    }
    return mixed;
  }

  // (0 I; -I 0) S row by row.
  SymbolicVector turned(const SymbolicMatrix& s) {
    SymbolicVector rows;
    for (int i = 0; i < 2 * n_; ++i) {
      for (int j = 0; j < 2 * n_; ++j) {
        rows.push_back(i < n_ ? s(n_ + i, j) : -s(i - n_, j));
      }
    }
    return rows;
  }

  void linear_rate() {
    SymbolicVector rate;
    for (const Expression& e : motion()) rate.push_back(at_solution(e));
    std::vector<Check> all = f_.checks;
    if (f_.chart) {
      const Expression small = graph_.number(kNearSingularChart * kNearSingularChart);
      all.insert(all.begin(), {graph_.power(*f_.chart, 2) - small, RateStatus::kChart});
    }
    const SymbolicVector checks = values(all, system_.rate_checks);
    system_.rate = tape({rate, whole_solution_, checks});
    SymbolicMatrix s = second_derivatives(true);
    const SymbolicMatrix mixed = mixed_derivatives(true);
    // y_z = (-H_yy)^-1 H_yz, and the Hessian is symmetric.
    for (int j = 0; j < 2 * n_ && m_ > 0; ++j) {
      SymbolicVector column;
      for (int i = 0; i < m_; ++i) column.push_back(mixed(i, j));
      SymbolicVector y_z = f_.solve(column);
      for (Expression& e : y_z) e = graph_.whole(e);
      for (int i = 0; i <= j; ++i) {
        SymbolicVector terms{s(i, j)};
        for (int l = 0; l < m_; ++l) terms.push_back(mixed(l, i) * y_z[l]);
        s(i, j) = graph_.sum(terms);
        s(j, i) = s(i, j);
      }
    }
    system_.jacobian = tape({turned(s), checks});
  }

  void newton() {
    system_.rate = tape({motion(), {}, {}});
    SymbolicMatrix mixed = mixed_derivatives(false);
    system_.jacobian = tape({mixed.entries, second_derivatives(false).entries});
    system_.equations = tape({gradient_of(f_.hamiltonian, kAlgebraic, m_)});
    if (system_.has_guess) system_.guess = tape({f_.guess});
  }

  void hessian() {
    const SymbolicVector slopes = gradient_of(f_.hamiltonian, kAlgebraic, m_);
    system_.hessian = tape({slopes, jacobian(graph_, slopes, kAlgebraic.first, m_).entries});
  }

  void points() {
    const Expression power = graph_.derivative(f_.hamiltonian, kTime.first);
    const Expression speed = f_.square_speed ? *f_.square_speed : graph_.number(0);
    system_.point = tape({{f_.hamiltonian}, {power}, {speed}, f_.constraint});
    system_.lambda = tape({f_.lambda, values(f_.lambda_checks, system_.lambda_checks)});
  }

  void velocities() {
    const auto slopes = jacobian(graph_, f_.constraint, kVelocity.first, n_);
    system_.constraint = tape({f_.constraint, slopes.entries});
    system_.momentum = tape({f_.momentum});
    if (!f_.masses.empty()) system_.masses = tape({f_.masses});
  }

  // What belongs to x' = f and the cost, from H = p.f - cost.
  void controls() {
    const int c = m_;
    SymbolicVector f = gradient_of(f_.hamiltonian, kMomentum, n_);
    const SymbolicVector zeros(static_cast<std::size_t>(n_), graph_.number(0));
    const Expression cost = -graph_.substitute(f_.hamiltonian, kMomentum.first, zeros);
    const SymbolicVector slopes = gradient_of(cost, kAlgebraic, c);
    const SymbolicMatrix frame = jacobian(graph_, f, kAlgebraic.first, c);
    const SymbolicVector columns = transposed(graph_, frame).entries;
    if (f_.linear) {
      const SymbolicVector rest(static_cast<std::size_t>(c), graph_.number(0));
      SymbolicVector linear;
      for (const Expression& e : slopes) {
        linear.push_back(graph_.substitute(e, kAlgebraic.first, rest));
      }
      const SymbolicMatrix weight = jacobian(graph_, slopes, kAlgebraic.first, c);
      system_.controls = tape({columns, f_.drift, weight.entries, linear});
    } else {
      system_.dynamics = tape({f, columns, slopes});
    }
  }

  // Derivatives by x = (p, y) of F, first and second.
  Tape stationary(const Expression& function) {
    SymbolicVector slopes = gradient_of(function, kMomentum, n_);
    for (const Expression& e : gradient_of(function, kAlgebraic, m_)) slopes.push_back(e);
    SymbolicVector second;
    for (const Expression& e : slopes) {
      for (int j = 0; j < n_; ++j) second.push_back(graph_.derivative(e, kMomentum.first + j));
      for (int j = 0; j < m_; ++j) second.push_back(graph_.derivative(e, kAlgebraic.first + j));
    }
    return tape({slopes, second});
  }

  void transforms() {
    SymbolicVector terms{f_.hamiltonian};
    SymbolicVector fixed;
    SymbolicVector held;
    for (int i = 0; i < n_; ++i) {
      const Expression p = graph_.variable(kMomentum.first + i);
      terms.push_back(-(p * graph_.variable(kVelocity.first + i)));
    }
    system_.legendre = stationary(graph_.sum(terms));
    for (int i = 0; i < m_; ++i) fixed.push_back(graph_.variable(kMultiplier.first + i));
    terms[0] = graph_.substitute(f_.hamiltonian, kAlgebraic.first, fixed);
    for (int i = 0; i < m_; ++i) {
      const Expression off = graph_.variable(kAlgebraic.first + i) - fixed[i];
      terms.push_back(0.5 * graph_.power(off, 2));
    }
    system_.held = stationary(graph_.sum(terms));
  }

  void holonomic() {
    const SymbolicMatrix dh = jacobian(graph_, f_.holonomic, kConfiguration.first, n_);
    system_.holonomic = tape({f_.holonomic, dh.entries});
    SymbolicVector slopes;
    for (const Expression& mu : f_.holonomic_forces) {
      for (const int z : z_) slopes.push_back(graph_.derivative(mu, z));
    }
    system_.forces = tape({f_.holonomic_forces});
    system_.slopes_of_forces = tape({slopes});
  }

  void transcription(const TranscriptionFormulas& t) {
    SymbolicVector entries;
    for (int i = 0; i < n_; ++i) {
      for (int j = 0; j <= i; ++j) entries.push_back(t.mass(i, j));
    }
    entries.insert(entries.end(), t.constraints.entries.begin(), t.constraints.entries.end());
    entries.push_back(t.potential);
    SymbolicVector rows;
    for (const Expression& e : entries) {
      rows.push_back(e);
      for (int d = 0; d < n_; ++d) {
        rows.push_back(graph_.derivative(e, kConfiguration.first + d));
      }
    }
    system_.entries = tape({entries});
    system_.slopes = tape({rows});
    const SymbolicVector slope = gradient_of(t.lagrangian, kConfiguration, n_);
    SymbolicMatrix second = jacobian(graph_, slope, kConfiguration.first, n_);
    for (int i = 0; i < n_; ++i) {
      for (int j = 0; j < i; ++j) second(i, j) = second(j, i);
    }
    system_.lagrangian_hessian = tape({second.entries});
  }

  const Formulation& f_;
  Graph& graph_;
  TextSystem& system_;
  int n_;
  int m_;
  std::vector<Block> inputs_;
  std::vector<int> z_;
  SymbolicVector whole_solution_;
};

}  // namespace

TextSystem::TextSystem(const Formulation& formulation, Graph& graph)
    : kind(formulation.kind),
      dof(formulation.dof),
      algebraic(formulation.algebraic),
      multipliers(formulation.multipliers),
      transcribed(formulation.transcription ? formulation.transcription->constraints.rows : 0),
      linear(formulation.linear),
      autonomous(formulation.autonomous),
      constraint_count(static_cast<int>(formulation.constraint.size())),
      holonomic_count(static_cast<int>(formulation.holonomic.size())),
      metric(formulation.square_speed.has_value()),
      has_transcription(formulation.transcription.has_value()),
      has_chart(formulation.chart.has_value()),
      has_guess(!formulation.guess.empty()) {
  if (kind == Formulation::Kind::kOptimalControl) controls_count = algebraic;
  TapeMaker(formulation, graph, *this).run();
  connect_calls(*this);
  if (formulation.transcription) transcription.gauge = formulation.transcription->gauge;
}

}  // namespace carnot::language
