// The middles of intervals of a path side by side, as Dynamics::midpoints takes them.
#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

#include "carnot/dynamics.h"

namespace carnot::internal {

// Number j of interval l is at j * kLanes + l. Where there are fewer intervals, the last one stands
// for the rest.
class Middles {
 public:
  static constexpr int kLanes = Dynamics::kMidpointLanes;

  explicit Middles(int n) : n_(n), q_(static_cast<std::size_t>(n) * kLanes), v_(q_.size()) {}

  // Of `count` intervals of length h from the node q on.
  void set(const double* q, int count, double h) {
    const double per_h = 1 / h;
    for (int l = 0; l < kLanes; ++l) {
      const double* left = q + std::min(l, count - 1) * n_;
      const double* right = left + n_;
      for (int j = 0; j < n_; ++j) {
        q_[j * kLanes + l] = 0.5 * (left[j] + right[j]);
        v_[j * kLanes + l] = (right[j] - left[j]) * per_h;
      }
    }
  }

  // Of one interval each of as many paths, whose nodes i and i + 1 stand side by side.
  void set_lanes(const double* nodes, double h) {
    const double per_h = 1 / h;
    const double* const next = nodes + q_.size();
    for (std::size_t i = 0; i < q_.size(); ++i) {
      q_[i] = 0.5 * (nodes[i] + next[i]);
      v_[i] = (next[i] - nodes[i]) * per_h;
    }
  }

  [[nodiscard]] const std::vector<double>& q() const { return q_; }
  // The velocities there.
  [[nodiscard]] const std::vector<double>& v() const { return v_; }

 private:
  int n_;
  std::vector<double> q_;
  std::vector<double> v_;
};

}  // namespace carnot::internal
