#include "carnot/shooting/problem/walls.h"

#include <cmath>

namespace carnot::internal {

Walls::Walls(const std::vector<Limit>& limits, int n) : limits_(limits), n_(n) {
  for (std::size_t i = 0; i < limits.size(); ++i) {
    const auto at = static_cast<int>(i);
    if (std::isfinite(limits[i].lower)) walls_.push_back({at, 1, limits[i].lower});
    if (std::isfinite(limits[i].upper)) walls_.push_back({at, -1, limits[i].upper});
  }
}

void Walls::evaluate(const double* q, double* s, double* gradients, double* hessians) const {
  std::vector<double> gradient(n_);
  std::vector<double> hessian(static_cast<std::size_t>(n_) * n_);
  double value = 0;
  int known = -1;  // the two walls of a limit follow each other
  for (int i = 0; i < size(); ++i) {
    const Wall& wall = walls_[i];
    if (wall.limit != known) {
      value = limits_[wall.limit].value(q,
                                        gradients != nullptr ? gradient.data() : nullptr,
                                        hessians != nullptr ? hessian.data() : nullptr);
      known = wall.limit;
    }
    s[i] = wall.sign * (value - wall.bound);
    for (int j = 0; j < n_ && gradients != nullptr; ++j)
      gradients[i * n_ + j] = wall.sign * gradient[j];
    for (int j = 0; j < n_ * n_ && hessians != nullptr; ++j) {
      hessians[i * n_ * n_ + j] = wall.sign * hessian[j];
    }
  }
}

}  // namespace carnot::internal
