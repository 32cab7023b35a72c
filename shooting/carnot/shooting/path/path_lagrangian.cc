#include "carnot/shooting/path/path_lagrangian.h"

#include <algorithm>
#include <cmath>
#include <span>

namespace carnot::internal {

bool evaluate_middles(
    const Path& path, double h, int first, HamiltonianTerms::Order order, HamiltonianTerms& terms) {
  const int n = path.dof;
  const int count = std::min(HamiltonianTerms::kPoints, path.intervals - first);
  std::vector<double> middle(n);
  for (int point = 0; point < count; ++point) {
    const int i = first + point;
    const double* left = path.configuration(i);
    const double* right = path.configuration(i + 1);
    for (int j = 0; j < n; ++j) middle[j] = 0.5 * (left[j] + right[j]);
    terms.set(point, (i + 0.5) * h, middle.data(), &path.lambda[i * n]);
  }
  const bool good = terms.evaluate(count, order, first / HamiltonianTerms::kPoints);
  if (first == 0) terms.fix_gauge(0, path.configuration(0));
  return good;
}

PathLagrangian::PathLagrangian(const Dynamics& dynamics, double h, double drift)
    : dynamics_(dynamics),
      h_(h),
      n_(dynamics.dof),
      k_(multipliers(dynamics)),
      lanes_(dynamics.has_transcription() ? kLanes : 1),
      x_(static_cast<std::size_t>(2 * n_ + k_) * lanes_),
      gradient_(x_.size()),
      hessian_(x_.size() * (2 * n_ + k_)),
      own_x_(2 * n_ + k_),
      middle_(n_),
      velocity_(n_) {
  if (dynamics.has_transcription()) {
    values_.resize(n_ + k_ + 1);
  } else {
    terms_.emplace(dynamics, drift);
  }
}

void PathLagrangian::set_middle(const Path& path, int i) {
  const double* left = path.configuration(i);
  const double* right = path.configuration(i + 1);
  for (int j = 0; j < n_; ++j) {
    middle_[j] = 0.5 * (left[j] + right[j]);
    velocity_[j] = (right[j] - left[j]) / h_;
  }
}

int PathLagrangian::together(const Path& path, int first) const {
  return std::min(terms_ ? HamiltonianTerms::kPoints : kLanes, path.intervals - first);
}

void PathLagrangian::transcribe(const Path& path, int first, int count, bool second) {
  for (int l = 0; l < kLanes; ++l) {
    path.gather(first + std::min(l, count - 1), k_, own_x_.data());
    for (std::size_t a = 0; a < own_x_.size(); ++a) x_[a * kLanes + l] = own_x_[a];
  }
  dynamics_.discrete_lagrangians(
      h_, x_, gradient_, second ? std::span<double>(hessian_) : std::span<double>());
}

void PathLagrangian::visit(const Path& path,
                           bool second,
                           const std::function<void(int, const Terms&)>& visit) {
  const auto order = second ? HamiltonianTerms::Order::kSecond : HamiltonianTerms::Order::kFirst;
  for (int first = 0; first < path.intervals;) {
    if (terms_) evaluate_middles(path, h_, first, order, *terms_);
    const int count = together(path, first);
    if (!terms_) transcribe(path, first, count, second);
    for (int point = 0; point < count; ++point) {
      const int i = first + point;
      if (terms_) {
        path.gather(i, k_, x_.data());
        set_middle(path, i);
        set_gradient(point, &path.lambda[i * k_]);
        if (second) set_hessian(point);
      }
      const int lane = terms_ ? 0 : point;
      const int size = 2 * n_ + k_;
      visit(i,
            {{&x_[lane], lanes_, size},
             {&gradient_[lane], lanes_, size},
             {&hessian_[lane], lanes_, second ? size * size : 0}});
    }
    first += count;
  }
}

void PathLagrangian::set_gradient(int point, const double* p) {
  for (int j = 0; j < n_; ++j) {
    const double force = 0.5 * h_ * terms_->by_q(point, j);
    gradient_[j] = -p[j] - force;
    gradient_[n_ + j] = p[j] - force;
    gradient_[2 * n_ + j] = h_ * (velocity_[j] - terms_->by_p(point, j));
  }
}

void PathLagrangian::set_hessian(int point) {
  const int size = 3 * n_;
  for (int i = 0; i < n_; ++i) {
    for (int j = 0; j < n_; ++j) {
      const double by_nodes = -0.25 * h_ * terms_->qq(point, i, j);
      const double same = i == j ? 1 : 0;
      const double mixed = -0.5 * h_ * terms_->qp(point, i, j);
      for (int a = 0; a < 2; ++a) {
        for (int b = 0; b < 2; ++b) hessian_[(a * n_ + i) * size + b * n_ + j] = by_nodes;
        const double entry = mixed + (a == 0 ? -same : same);
        hessian_[(a * n_ + i) * size + 2 * n_ + j] = entry;
        hessian_[(2 * n_ + j) * size + a * n_ + i] = entry;
      }
      hessian_[(2 * n_ + i) * size + 2 * n_ + j] = -h_ * terms_->pp(point, i, j);
    }
  }
}

double PathLagrangian::action(const Path& path) {
  double action = 0;
  for (int first = 0; terms_ && first < path.intervals;) {
    evaluate_middles(path, h_, first, HamiltonianTerms::Order::kFirst, *terms_);
    const int count = together(path, first);
    for (int point = 0; point < count; ++point) {
      double lagrangian = -terms_->value(point);
      for (int j = 0; j < n_; ++j) {
        lagrangian += path.lambda[(first + point) * k_ + j] * terms_->by_p(point, j);
      }
      if (std::isfinite(lagrangian)) action += h_ * lagrangian;
    }
    first += count;
  }
  for (int i = 0; !terms_ && i < path.intervals; ++i) {
    set_middle(path, i);
    if (!dynamics_.midpoint(middle_, velocity_, values_)) continue;
    for (int j = 0; j < n_; ++j) action += 0.5 * h_ * values_[j] * values_[j];
    action -= h_ * values_.back();
  }
  return action;
}

}  // namespace carnot::internal
