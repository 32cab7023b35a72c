// Ipopt on the direct midpoint transcription of a problem with velocity constraints.
//
// Minimise sum_i h L(qm_i, v_i) subject to h G(qm_i) v_i = 0. All that Ipopt asks for is in the
// discrete Lagrangian F(x, lambda) = h (L - lambda.G v) of Dynamics: F_lambda = -h G v are the
// constraints, F_lambda,q their Jacobian, and with weight s of the objective and multipliers mu the
// Hessian is s F_qq(0) + (F_qq(mu) - F_qq(0)). Limits are rows of their own, at each inner node.
#include <algorithm>
#include <cmath>
#include <coin/IpIpoptApplication.hpp>
#include <coin/IpTNLP.hpp>
#include <span>

#include "benchmark/peers/boundary_peers.h"
#include "benchmark/peers/ipopt_run.h"

namespace carnot::apps {
namespace {

using Ipopt::Index;
using Ipopt::Number;

class Transcription : public Ipopt::TNLP {
 public:
  Transcription(const BoundaryValueProblem& problem, std::vector<double>& q, double& action)
      : dynamics_(problem.dynamics),
        limits_(problem.limits),
        n_(dynamics_.dof),
        k_(dynamics_.transcribed),
        m_(2 * n_ + k_),
        intervals_(static_cast<int>(q.size()) / n_ - 1),
        limited_(static_cast<int>(limits_.size())),
        h_(problem.time / intervals_),
        q_(q),
        action_(action),
        x_(m_),
        gradient_(m_),
        hessian_(m_ * m_),
        weighted_(m_ * m_) {}

  bool get_nlp_info(
      Index& n, Index& m, Index& jacobian, Index& hessian, IndexStyleEnum& style) override {
    n = (intervals_ - 1) * n_;
    m = intervals_ * k_ + (intervals_ - 1) * limited_;
    jacobian = (intervals_ - 1) * limited_ * n_;
    hessian = limited_ > 0 ? (intervals_ - 1) * n_ * (n_ + 1) / 2 : 0;
    for (int i = 0; i < intervals_; ++i) {
      each_jacobian(i, [&](int, int, int, int) { ++jacobian; });
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
    for (int row = intervals_ * k_; row < m; ++row) {
      const Limit& limit = limits_[(row - intervals_ * k_) % limited_];
      low[row] = std::max(limit.lower, -kNone);
      high[row] = std::min(limit.upper, kNone);
    }
    return true;
  }

  bool get_starting_point(Index n,
                          bool /*init_x*/,
                          Number* x,
                          bool /*init_z*/,
                          Number* /*z_lower*/,
                          Number* /*z_upper*/,
                          Index /*m*/,
                          bool /*init_lambda*/,
                          Number* /*lambda*/) override {
    std::copy_n(q_.begin() + n_, n, x);
    return true;
  }

  bool eval_f(Index /*n*/, const Number* x, bool /*new_x*/, Number& value) override {
    value = 0;
    std::vector<double> middle(n_), velocity(n_), terms(n_ + k_ + 1);
    for (int i = 0; i < intervals_; ++i) {
      evaluate(i, x, nullptr, {});
      double kinetic = 0;  // v.L_v / 2, with L_v from both ends
      for (int j = 0; j < n_; ++j) {
        velocity[j] = (x_[n_ + j] - x_[j]) / h_;
        middle[j] = 0.5 * (x_[j] + x_[n_ + j]);
        kinetic += 0.25 * velocity[j] * (gradient_[n_ + j] - gradient_[j]);
      }
      if (!dynamics_.midpoint(middle, velocity, terms)) return false;
      value += h_ * (kinetic - terms.back());
    }
    return std::isfinite(value);
  }

  bool eval_grad_f(Index n, const Number* x, bool /*new_x*/, Number* gradient) override {
    std::fill_n(gradient, n, 0.0);
    for (int i = 0; i < intervals_; ++i) {
      evaluate(i, x, nullptr, {});
      for (int a = 0; a < 2 * n_; ++a) {
        if (unknown(i, a) >= 0) gradient[unknown(i, a)] += gradient_[a];
      }
    }
    return true;
  }

  bool eval_g(Index /*n*/, const Number* x, bool /*new_x*/, Index /*m*/, Number* g) override {
    for (int i = 0; i < intervals_; ++i) {
      evaluate(i, x, nullptr, {});
      std::copy(gradient_.begin() + 2 * n_, gradient_.end(), g + i * k_);
    }
    for (int node = 1; node < intervals_; ++node) {
      for (int l = 0; l < limited_; ++l) {
        g[limit_row(node, l)] = limits_[l].value(x + (node - 1) * n_, nullptr, nullptr);
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
      if (values != nullptr) evaluate(i, x, nullptr, hessian_);
      each_jacobian(i, [&](int a, int b, int row, int column) {
        if (values != nullptr) {
          values[at] = hessian_[a * m_ + b];
        } else {
          rows[at] = row;
          columns[at] = column;
        }
        ++at;
      });
    }
    for (int node = 1; node < intervals_; ++node) {
      for (int l = 0; l < limited_; ++l, at += n_) {
        if (values != nullptr) limits_[l].value(x + (node - 1) * n_, values + at, nullptr);
        for (int j = 0; j < n_ && values == nullptr; ++j) {
          rows[at + j] = limit_row(node, l);
          columns[at + j] = (node - 1) * n_ + j;
        }
      }
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
    for (int i = 0; i < intervals_; ++i) {
      if (values != nullptr) {
        evaluate(i, x, lambda + i * k_, weighted_);
        evaluate(i, x, nullptr, hessian_);
      }
      each_hessian(i, [&](int a, int b, int row, int column) {
        if (values != nullptr) {
          const double plain = hessian_[a * m_ + b];
          values[at] = weight * plain + (weighted_[a * m_ + b] - plain);
        } else {
          rows[at] = row;
          columns[at] = column;
        }
        ++at;
      });
    }
    for (int node = 1; node < intervals_ && limited_ > 0; ++node) {
      if (values != nullptr) set_bending(node, x, lambda);
      for (int a = 0; a < n_; ++a) {
        for (int b = 0; b <= a; ++b, ++at) {
          if (values != nullptr) {
            values[at] = bending_[a * n_ + b];
          } else {
            rows[at] = (node - 1) * n_ + a;
            columns[at] = (node - 1) * n_ + b;
          }
        }
      }
    }
    return true;
  }

  void finalize_solution(Ipopt::SolverReturn /*status*/,
                         Index n,
                         const Number* x,
                         const Number* /*z_lower*/,
                         const Number* /*z_upper*/,
                         Index /*m*/,
                         const Number* /*g*/,
                         const Number* /*lambda*/,
                         Number value,
                         const Ipopt::IpoptData* /*data*/,
                         Ipopt::IpoptCalculatedQuantities* /*quantities*/) override {
    std::copy_n(x, n, q_.begin() + n_);
    action_ = value;
  }

 private:
  // F and its derivatives on interval i, at multipliers zero where there are none.
  void evaluate(int i, const Number* x, const Number* lambda, std::span<double> hessian) {
    for (int a = 0; a < 2 * n_; ++a) {
      x_[a] = unknown(i, a) >= 0 ? x[unknown(i, a)] : q_[i * n_ + a];
    }
    for (int j = 0; j < k_; ++j) x_[2 * n_ + j] = lambda != nullptr ? lambda[j] : 0;
    dynamics_.discrete_lagrangian(h_, x_, gradient_, hessian);
  }

  [[nodiscard]] int limit_row(int node, int limit) const {
    return intervals_ * k_ + (node - 1) * limited_ + limit;
  }

  // The second derivatives of the limits at a node, each times its multiplier.
  void set_bending(int node, const Number* x, const Number* lambda) {
    bending_.assign(n_ * n_, 0.0);
    std::vector<double> gradient(n_), hessian(n_ * n_);
    for (int l = 0; l < limited_; ++l) {
      limits_[l].value(x + (node - 1) * n_, gradient.data(), hessian.data());
      for (int e = 0; e < n_ * n_; ++e) bending_[e] += lambda[limit_row(node, l)] * hessian[e];
    }
  }

  // Index of coordinate a of interval i, of both its ends, among the unknowns; -1 at a fixed end.
  [[nodiscard]] int unknown(int i, int a) const {
    const int index = (i - 1) * n_ + a;
    return index < (intervals_ - 1) * n_ ? std::max(index, -1) : -1;
  }

  // f(row and column of the block, row and column of the whole).
  template <class F>
  void each_jacobian(int i, const F& f) const {
    for (int j = 0; j < k_; ++j) {
      for (int b = 0; b < 2 * n_; ++b) {
        if (unknown(i, b) >= 0) f(2 * n_ + j, b, i * k_ + j, unknown(i, b));
      }
    }
  }
  // The lower triangle; Ipopt adds what it is given twice.
  template <class F>
  void each_hessian(int i, const F& f) const {
    for (int a = 0; a < 2 * n_; ++a) {
      for (int b = 0; b <= a; ++b) {
        if (unknown(i, a) >= 0 && unknown(i, b) >= 0) f(a, b, unknown(i, a), unknown(i, b));
      }
    }
  }

  const Dynamics& dynamics_;
  const std::vector<Limit>& limits_;
  int n_;
  int k_;
  int m_;
  int intervals_;
  int limited_;
  double h_;
  std::vector<double>& q_;
  double& action_;
  std::vector<double> x_;
  std::vector<double> gradient_;
  std::vector<double> hessian_;
  std::vector<double> weighted_;
  std::vector<double> bending_;
};

}  // namespace

bool run_ipopt(const Ipopt::SmartPtr<Ipopt::TNLP>& problem) {
  const Ipopt::SmartPtr<Ipopt::IpoptApplication> ipopt = new Ipopt::IpoptApplication(false);
  ipopt->Options()->SetIntegerValue("print_level", 0);
  ipopt->Options()->SetStringValue("sb", "yes");
  ipopt->Options()->SetIntegerValue("max_iter", 500);
  ipopt->Options()->SetNumericValue("tol", 1e-10);
  ipopt->Options()->SetNumericValue("bound_relax_factor", 0);  // limits are kept to, not nearly
  return ipopt->Initialize() == Ipopt::Solve_Succeeded &&
         ipopt->OptimizeTNLP(problem) == Ipopt::Solve_Succeeded;
}

std::optional<double> solve_with_ipopt(const BoundaryValueProblem& problem,
                                       std::vector<double>& q) {
  double action = 0;
  if (!run_ipopt(new Transcription(problem, q, action))) return std::nullopt;
  return action;
}

}  // namespace carnot::apps
