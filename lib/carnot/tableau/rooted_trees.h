// The order conditions of a Runge-Kutta method, Phi(t) = 1/gamma(t) for all rooted trees t.
//
// With a vertex for each stage, Phi(t) = sum_i b_i g_i and g_i the product over the subtrees t_k at
// the root of sum_j a_ij g_j(t_k); gamma(t) = |t| prod_k gamma(t_k). Of a partitioned method with
// one b and c the vertices have two colours, q and p; the colour of a subtree decides whether a_ij
// is that of q or of p, and the colour of the root does not matter.
// Source: Hairer, Lubich & Wanner, Geometric Numerical Integration, III.1.1 and III.2.1.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <vector>

#include "carnot/tableau/order_conditions.h"

namespace carnot {

// The trees of one order; the colour of the root is not counted.
struct TreeCheck {
  int trees = 0;
  // Largest |Phi - 1/gamma|.
  long double error = 0;
  // The same over the round-off to expect: epsilon of T times the sum of all terms' absolute
  // values.
  long double defect = 0;
  // Sum of ((Phi - 1/gamma) / sigma)^2, sigma the number of symmetries of the tree.
  long double squares = 0;
};

template <class T>
class RootedTrees {
 public:
  // Sums are formed in long double.
  RootedTrees(const Tableau<T>& tableau, int max_order)
      : b_(tableau.b.template cast<long double>()) {
    a_.push_back(coefficients_of(tableau));
    if (tableau.partitioned) a_.push_back(coefficients_of(tableau, Part::kMomentum));
    const Weights one = Weights::Ones(tableau.stages());
    for (int order = 1; order <= max_order; ++order) {
      checks_.emplace_back();
      grow({order, 1, 1, one, one}, order - 1, branches_.size(), 0);
      if (order < max_order) add_branches();
    }
  }

  [[nodiscard]] const TreeCheck& of_order(int order) const { return checks_[order - 1]; }

  // The largest order up to which all conditions hold to `tolerance` units of round-off.
  [[nodiscard]] int order(long double tolerance) const {
    int order = 0;
    while (order < static_cast<int>(checks_.size()) && checks_[order].defect <= tolerance) ++order;
    return order;
  }

  // Euclidean norm of the coefficients of h^order in the error of a step.
  [[nodiscard]] double error_constant(int order) const {
    return static_cast<double>(std::sqrt(of_order(order).squares));
  }

 private:
  using Weights = StageVector<long double, kAnyStages>;

  // A tree with g_i at its root; or a branch, with sum_j a_ij g_j at the vertex that it hangs on.
  struct Tree {
    int order;
    long double gamma;
    long double sigma;
    Weights weights;
    Weights size;  // with absolute values
  };

  // Adds branches of total order `rest` in descending order, from index `last` (used `times` times
  // already) down: each set of branches once.
  void grow(const Tree& tree, int rest, std::size_t last, int times) {
    if (rest == 0) {
      finish(tree);
      return;
    }
    for (std::size_t k = 0; k < branches_.size() && k <= last; ++k) {
      const Tree& branch = branches_[k];
      if (branch.order > rest) continue;
      const int repeated = k == last ? times + 1 : 1;
      grow({tree.order,
            tree.gamma * branch.gamma,
            tree.sigma * branch.sigma * static_cast<long double>(repeated),
            tree.weights.cwiseProduct(branch.weights),
            tree.size.cwiseProduct(branch.size)},
           rest - branch.order,
           k,
           repeated);
    }
  }

  void finish(Tree tree) {
    tree.gamma *= static_cast<long double>(tree.order);
    const long double exact = 1 / tree.gamma;
    const long double scale = exact + b_.cwiseAbs().dot(tree.size);
    const long double error = std::abs(b_.dot(tree.weights) - exact);
    TreeCheck& check = checks_.back();
    check.trees += 1;
    check.error = std::max(check.error, error);
    check.defect = std::max(check.defect, error / (std::numeric_limits<T>::epsilon() * scale));
    check.squares += error * error / (tree.sigma * tree.sigma);
    trees_.push_back(tree);
  }

  // The new trees, of every colour, as branches of larger ones.
  void add_branches() {
    for (const Tree& tree : trees_) {
      for (const auto& a : a_) {
        branches_.push_back({tree.order,
                             tree.gamma,
                             tree.sigma,
                             a.lazyProduct(tree.weights),
                             a.cwiseAbs().lazyProduct(tree.size)});
      }
    }
    trees_.clear();
  }

  Weights b_;
  std::vector<StageMatrix<long double, kAnyStages>> a_;
  std::vector<Tree> branches_;
  std::vector<Tree> trees_;  // of the order being made
  std::vector<TreeCheck> checks_;
};

}  // namespace carnot
