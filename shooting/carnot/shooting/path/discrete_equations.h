// The equations of a discrete extremal.
//
// A path with multipliers is a discrete extremal when, with F_d of path_lagrangian.h,
//
//   D2 F_d(q_{i-1}, q_i, lambda_{i-1}) + D1 F_d(q_i, q_{i+1}, lambda_i) = 0,   D3 F_d = 0,
//
// This is the midpoint rule with momenta that match at every node. It is also the gradient of
// sum F_d, the action less lambda times the constraints. Unknowns and equations are ordered
// lambda_0, q_1, lambda_1, q_2, ..., lambda_{K-1}. Free coordinates of q_0 come before them and
// those of q_K after them; their equations say that the momentum vanishes there. The matrix holds
// exact second derivatives and is banded.
#pragma once

#include <vector>

#include "carnot/shooting/boundary_value_problem.h"
#include "carnot/shooting/linear/banded_lu.h"
#include "carnot/shooting/path/middles.h"
#include "carnot/shooting/path/path.h"
#include "carnot/shooting/path/path_lagrangian.h"

namespace carnot::internal {

class DiscreteEquations {
 public:
  // `drift` is that of path_lagrangian.h. Keeps a reference to the dynamics of the problem.
  DiscreteEquations(const BoundaryValueProblem& problem, int intervals, double drift = 1);

  [[nodiscard]] int size() const { return first_ + inner() + last_; }
  [[nodiscard]] BandedLu matrix() const { return {size(), band(), band()}; }
  // Whether an unknown is a multiplier.
  [[nodiscard]] bool is_multiplier(int unknown) const {
    const int place = unknown - first_;
    return place >= 0 && place < inner() && place % (n_ + k_) < k_;
  }

  // The unknown that coordinate j of a node is; -1 where it is fixed.
  [[nodiscard]] int of_node(int node, int j) const {
    return node < intervals_ ? unknown(node, j) : unknown(node - 1, n_ + j);
  }

  // What stands for the second derivatives of sum F_d by the nodes: a combination of themselves and
  // of B = sum h J'J with J = dr/dq, r the terms of midpoint_transcription.h. B is made of second
  // derivatives of the kinetic energy and of a share of |G v|^2, without the curvature of their
  // terms. It is positive definite where the constraints leave the nodes free.
  struct Weights {
    double hessian = 1;
    double metric = 0;
  };
  // Residual at `path`; fills the matrix too where one is given. Returns the largest momentum;
  // where the defects v - H_p are equations too, the longest way in an interval if that is larger.
  double evaluate(const Path& path,
                  std::vector<double>& residual,
                  BandedLu* matrix,
                  const Weights& weights = {1, 0});
  // Adds share * B to the matrix; NaN where the terms cannot be evaluated.
  void add_metric(const Path& path, double share, BandedLu& matrix);
  // B x, with zeros for the multipliers. The result is NaN where the terms cannot be evaluated.
  void metric_product(const Path& path, const std::vector<double>& x, std::vector<double>& product);
  // path - step * direction.
  void move(const Path& from, const std::vector<double>& direction, double step, Path& to) const;

 private:
  static constexpr int kLanes = Middles::kLanes;

  [[nodiscard]] int band() const { return 2 * n_ + k_ - 1; }
  // Number of multipliers and of coordinates of inner nodes.
  [[nodiscard]] int inner() const { return intervals_ * k_ + (intervals_ - 1) * n_; }
  // Index of argument `a` of interval i among the unknowns; -1 where an end is fixed.
  [[nodiscard]] int unknown(int i, int a) const {
    const int start = first_ + i * (n_ + k_);
    if (a >= 2 * n_) return start + a - 2 * n_;
    if (a >= n_) return i + 1 == intervals_ ? free_to_[a - n_] : start + k_ + a - n_;
    return i == 0 ? free_from_[a] : start - n_ + a;
  }
  // Adds the terms of interval i; of one between others, where unknowns follow each other and
  // nothing is weighed, with less effort.
  void add(int i,
           const PathLagrangian::Terms& terms,
           double weight_of_hessian,
           std::vector<double>& residual,
           BandedLu* matrix);
  void add_between(int i,
                   const PathLagrangian::Terms& terms,
                   std::vector<double>& residual,
                   BandedLu* matrix) const;
  // Sets slopes_: dr of intervals side by side from `first` on. Returns of how many.
  int set_slopes(const Path& path, int first);

  const Dynamics& dynamics_;
  PathLagrangian lagrangian_;
  double h_;
  int n_;
  int k_;
  int intervals_;
  int first_ = 0;               // how many coordinates of q_0 are free,
  int last_ = 0;                // and of q_K
  std::vector<int> free_from_;  // the unknown that each is, or -1
  std::vector<int> free_to_;
  int m_;
  std::vector<int> unknowns_;  // of the arguments of one interval
  Middles middles_;
  // Of Middles::kLanes intervals side by side: terms, their derivatives by the middle, and those of
  // r by both nodes, n x 2n.
  std::vector<double> terms_;
  std::vector<double> by_middle_;
  std::vector<double> slopes_;
};

}  // namespace carnot::internal
