// Ipopt on the direct midpoint transcription of a problem of optimal control.
//
// Minimise sum_i h cost(t_i, qm_i, u_i) subject to (q_i+1 - q_i) / h = f(t_i, qm_i, u_i), with the
// nodes and the controls as unknowns. Of the scene only H(t, q, p, u) = p.f - cost is asked for:
// the cost is -H at p = 0, and f_j is H at the j-th unit vector plus the cost. Derivatives are
// differences, so nothing of carnot's own is trusted but that one function.
#include <algorithm>
#include <array>
#include <cmath>
#include <coin/IpTNLP.hpp>
#include <vector>

#include "benchmark/peers/ipopt_run.h"
#include "carnot/system/system_functions.h"

namespace carnot::apps {
namespace {

using Ipopt::Index;
using Ipopt::Number;

class ControlledPath : public Ipopt::TNLP {
 public:
  ControlledPath(const BoundaryValueProblem& problem, GridPath& path, double& action)
      : dynamics_(problem.dynamics),
        n_(dynamics_.dof),
        m_(dynamics_.functions->algebraic),
        intervals_(static_cast<int>(path.q.size()) / n_ - 1),
        h_(problem.time / intervals_),
        path_(path),
        action_(action),
        w_(n_ + m_),
        momentum_(n_) {}

  bool get_nlp_info(
      Index& n, Index& m, Index& jacobian, Index& hessian, IndexStyleEnum& style) override {
    n = (intervals_ - 1) * n_ + intervals_ * m_;
    m = intervals_ * n_;
    jacobian = 0;
    hessian = 0;
    for (int i = 0; i < intervals_; ++i) {
      each_jacobian(i, [&](int, int, int) { ++jacobian; });
      each_hessian(i, [&](int, int, int, int) { ++hessian; });
    }
    style = C_STYLE;
    return true;
  }

  bool get_bounds_info(
      Index n, Number* lower, Number* upper, Index m, Number* low, Number* high) override {
    constexpr double kNone = 2e19;  // as Ipopt says it
    std::fill_n(lower, n, -kNone);
    std::fill_n(upper, n, kNone);
    std::fill_n(low, m, 0.0);
    std::fill_n(high, m, 0.0);
    return true;
  }

  bool get_starting_point(Index /*n*/,
                          bool /*init_x*/,
                          Number* x,
                          bool /*init_z*/,
                          Number* /*z_lower*/,
                          Number* /*z_upper*/,
                          Index /*m*/,
                          bool /*init_lambda*/,
                          Number* /*lambda*/) override {
    x = std::copy(path_.q.begin() + n_, path_.q.end() - n_, x);
    std::copy(path_.u.begin(), path_.u.end(), x);
    return true;
  }

  bool eval_f(Index /*n*/, const Number* x, bool /*new_x*/, Number& value) override {
    value = 0;
    for (int i = 0; i < intervals_; ++i) {
      set_middle(i, x);
      value += h_ * cost();
    }
    return std::isfinite(value);
  }

  bool eval_grad_f(Index n, const Number* x, bool /*new_x*/, Number* gradient) override {
    std::fill_n(gradient, n, 0.0);
    for (int i = 0; i < intervals_; ++i) {
      set_middle(i, x);
      for (int a = 0; a < n_ + m_; ++a) {
        const double slope = h_ * difference(a, [&] { return cost(); });
        each_part(i, a, [&](int at, double share) { gradient[at] += share * slope; });
      }
    }
    return true;
  }

  bool eval_g(Index /*n*/, const Number* x, bool /*new_x*/, Index /*m*/, Number* g) override {
    for (int i = 0; i < intervals_; ++i) {
      set_middle(i, x);
      for (int j = 0; j < n_; ++j) {
        g[i * n_ + j] = (node(i + 1, j, x) - node(i, j, x)) / h_ - velocity(j);
      }
    }
    return true;
  }

  bool eval_jac_g(Index /*n*/,
                  const Number* x,
                  bool /*new_x*/,
                  Index /*m*/,
                  Index /*count*/,
                  Index* rows,
                  Index* columns,
                  Number* values) override {
    int at = 0;
    for (int i = 0; i < intervals_; ++i) {
      if (values != nullptr) set_middle(i, x);
      std::vector<double> slopes;  // of f_j, one row after the other
      for (int j = 0; j < n_ && values != nullptr; ++j) {
        for (int a = 0; a < n_ + m_; ++a) {
          slopes.push_back(difference(a, [&] { return velocity(j); }));
        }
      }
      each_jacobian(i, [&](int j, int local, int column) {
        if (values == nullptr) {
          rows[at] = i * n_ + j;
          columns[at] = column;
        } else {
          const double change = local % n_ == j ? (local < n_ ? -1 : 1) / h_ : 0;
          const double* const row = &slopes[j * (n_ + m_)];
          values[at] = local < 2 * n_ ? change - 0.5 * row[local % n_] : -row[local - n_];
        }
        ++at;
      });
    }
    return true;
  }

  bool eval_h(Index /*n*/,
              const Number* x,
              bool /*new_x*/,
              Number weight,
              Index /*m*/,
              const Number* lambda,
              bool /*new_lambda*/,
              Index /*count*/,
              Index* rows,
              Index* columns,
              Number* values) override {
    int at = 0;
    std::vector<double> second((n_ + m_) * (n_ + m_));
    for (int i = 0; i < intervals_; ++i) {
      if (values != nullptr) {
        set_middle(i, x);
        const auto lagrangian = [&] {
          double sum = weight * h_ * cost();
          for (int j = 0; j < n_; ++j) sum -= lambda[i * n_ + j] * velocity(j);
          return sum;
        };
        for (int a = 0; a < n_ + m_; ++a) {
          for (int b = 0; b <= a; ++b) {
            second[a * (n_ + m_) + b] = second_difference(a, b, lagrangian);
            second[b * (n_ + m_) + a] = second[a * (n_ + m_) + b];
          }
        }
      }
      each_hessian(i, [&](int a, int b, int row, int column) {
        if (values == nullptr) {
          rows[at] = row;
          columns[at] = column;
        } else {
          values[at] = share_of(a) * share_of(b) * second[middle_of(a) * (n_ + m_) + middle_of(b)];
        }
        ++at;
      });
    }
    return true;
  }

  void finalize_solution(Ipopt::SolverReturn /*status*/,
                         Index /*n*/,
                         const Number* x,
                         const Number* /*z_lower*/,
                         const Number* /*z_upper*/,
                         Index /*m*/,
                         const Number* /*g*/,
                         const Number* /*lambda*/,
                         Number value,
                         const Ipopt::IpoptData* /*data*/,
                         Ipopt::IpoptCalculatedQuantities* /*quantities*/) override {
    const int inner = (intervals_ - 1) * n_;
    std::copy_n(x, inner, path_.q.begin() + n_);
    std::copy_n(x + inner, path_.u.size(), path_.u.begin());
    action_ = value;
  }

 private:
  // An interval has the unknowns q_i, q_i+1, u_i, numbered so, of which qm and u are made.
  [[nodiscard]] int middle_of(int local) const { return local < n_ ? local : local - n_; }
  [[nodiscard]] double share_of(int local) const { return local < 2 * n_ ? 0.5 : 1; }
  // Index of such a one among all; -1 at a fixed end.
  [[nodiscard]] int unknown(int i, int local) const {
    const int inner = (intervals_ - 1) * n_;
    if (local >= 2 * n_) return inner + i * m_ + local - 2 * n_;
    const int index = (i - 1) * n_ + local;
    return index < inner ? std::max(index, -1) : -1;
  }
  [[nodiscard]] double node(int i, int j, const Number* x) const {
    return i == 0 || i == intervals_ ? path_.q[i * n_ + j] : x[(i - 1) * n_ + j];
  }

  void set_middle(int i, const Number* x) {
    t_ = (i + 0.5) * h_;
    for (int j = 0; j < n_; ++j) w_[j] = 0.5 * (node(i, j, x) + node(i + 1, j, x));
    for (int c = 0; c < m_; ++c) w_[n_ + c] = x[unknown(i, 2 * n_ + c)];
  }

  [[nodiscard]] double hamiltonian() const {
    return dynamics_.functions->hamiltonian(
        dynamics_.system.get(), t_, w_.data(), momentum_.data(), w_.data() + n_);
  }
  [[nodiscard]] double cost() { return -hamiltonian(); }
  [[nodiscard]] double velocity(int j) {
    momentum_[j] = 1;
    const double h = hamiltonian();
    momentum_[j] = 0;
    return h + cost();
  }

  // df/dw_a to about 1e-12: of fourth order.
  template <class F>
  double difference(int a, const F& f) {
    constexpr double kStep = 1e-3;
    const double centre = w_[a];
    const double d = kStep * std::max(1.0, std::abs(centre));
    const auto at = [&](double by) {
      w_[a] = centre + by * d;
      return f();
    };
    const double slope = (8 * (at(1) - at(-1)) - (at(2) - at(-2))) / (12 * d);
    w_[a] = centre;
    return slope;
  }

  // To about 1e-8, which is enough to converge.
  template <class F>
  double second_difference(int a, int b, const F& f) {
    constexpr double kStep = 1e-4;
    const std::array<double, 2> centre{w_[a], w_[b]};
    const double da = kStep * std::max(1.0, std::abs(centre[0]));
    const double db = kStep * std::max(1.0, std::abs(centre[1]));
    const auto at = [&](double by_a, double by_b) {
      w_[a] = centre[0];
      w_[b] = centre[1];
      w_[a] += by_a * da;
      w_[b] += by_b * db;
      return f();
    };
    const double second = (at(1, 1) - at(1, -1) - at(-1, 1) + at(-1, -1)) / (4 * da * db);
    w_[a] = centre[0];
    w_[b] = centre[1];
    return second;
  }

  // f(index among all, share of the middle).
  template <class F>
  void each_part(int i, int a, const F& f) const {
    for (int local = 0; local < 2 * n_ + m_; ++local) {
      if (middle_of(local) == a && unknown(i, local) >= 0) f(unknown(i, local), share_of(local));
    }
  }
  // f(row, unknown of the interval, index among all).
  template <class F>
  void each_jacobian(int i, const F& f) const {
    for (int j = 0; j < n_; ++j) {
      for (int local = 0; local < 2 * n_ + m_; ++local) {
        if (unknown(i, local) >= 0) f(j, local, unknown(i, local));
      }
    }
  }
  // The lower triangle, two unknowns of the interval and their indices among all.
  template <class F>
  void each_hessian(int i, const F& f) const {
    for (int a = 0; a < 2 * n_ + m_; ++a) {
      for (int b = 0; b <= a; ++b) {
        if (unknown(i, a) >= 0 && unknown(i, b) >= 0) f(a, b, unknown(i, a), unknown(i, b));
      }
    }
  }

  const Dynamics& dynamics_;
  int n_;
  int m_;
  int intervals_;
  double h_;
  GridPath& path_;
  double& action_;
  double t_ = 0;
  std::vector<double> w_;         // (qm, u)
  std::vector<double> momentum_;  // of `hamiltonian`
};

}  // namespace

std::optional<double> control_with_ipopt(const BoundaryValueProblem& problem, GridPath& path) {
  double action = 0;
  if (!run_ipopt(new ControlledPath(problem, path, action))) return std::nullopt;
  return action;
}

}  // namespace carnot::apps
