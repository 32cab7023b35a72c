#include "carnot/shooting/problem/hamiltonian_terms.h"

#include <algorithm>
#include <array>
#include <limits>

namespace carnot::internal {
namespace {

constexpr int kPoints = HamiltonianTerms::kPoints;
constexpr std::array<double, kPoints> kOnes{1, 1, 1, 1, 1, 1, 1, 1};

}  // namespace

HamiltonianTerms::HamiltonianTerms(const Dynamics& dynamics, double drift)
    : dynamics_(dynamics),
      drift_(drift),
      n_(dynamics.dof),
      t_(kPoints),
      z_(2 * n_ * kPoints),
      z_dot_(z_.size()),
      jacobian_(4 * n_ * n_ * kPoints),
      value_(kPoints),
      by_q_(n_ * kPoints),
      by_p_(n_ * kPoints),
      qq_(n_ * n_ * kPoints),
      qp_(qq_.size()),
      pp_(qq_.size()) {}

void HamiltonianTerms::set(int point, double t, const double* q, const double* p) {
  t_[point] = t;
  for (int j = 0; j < n_; ++j) {
    z_[j * kPoints + point] = q[j];
    z_[(n_ + j) * kPoints + point] = p[j];
  }
}

bool HamiltonianTerms::evaluate(int count, Order order, int group) {
  found_.resize(std::max<std::size_t>(found_.size(), 2 * group + 2));
  // What is not wanted repeats the last point.
  for (int point = count; point < kPoints; ++point) {
    t_[point] = t_[count - 1];
    for (int k = 0; k < 2 * n_; ++k) z_[k * kPoints + point] = z_[k * kPoints + count - 1];
  }
  const auto fill = [&](double with) {
    for (auto* first : {&value_, &by_q_, &by_p_}) std::fill(first->begin(), first->end(), with);
    if (order == Order::kFirst) return;
    for (auto* second : {&qq_, &qp_, &pp_}) std::fill(second->begin(), second->end(), with);
  };
  fill(0);
  bool good = add(count, 1, 0.5 * (1 + drift_), order, found_[2 * group]);
  if (drift_ != 1 && good) {
    const auto reverse = [&] {
      for (int k = n_ * kPoints; k < 2 * n_ * kPoints; ++k) z_[k] = -z_[k];
    };
    reverse();
    good = add(count, -1, 0.5 * (1 - drift_), order, found_[2 * group + 1]);
    reverse();
  }
  if (!good) fill(std::numeric_limits<double>::quiet_NaN());
  return good;
}

void HamiltonianTerms::fix_gauge(int point, const double* q) {
  if (dynamics_.forced == 0) return;
  const int size = 2 * n_;
  if (normal_.empty()) {
    std::vector<double> z(size, 0.0);
    std::vector<double> projector(static_cast<std::size_t>(size) * size);
    std::copy(q, q + n_, z.begin());
    if (!dynamics_.tangent_projector(0, z, projector)) return;
    normal_.resize(n_ * n_);
    for (int i = 0; i < n_; ++i) {
      for (int j = 0; j < n_; ++j) normal_[i * n_ + j] = (i == j) - projector[i * size + j];
    }
  }
  for (int i = 0; i < n_; ++i) {
    for (int j = 0; j < n_; ++j) {
      const double entry = normal_[i * n_ + j];
      const double p = z_[(n_ + j) * kPoints + point];
      by_p_[i * kPoints + point] += entry * p;
      value_[point] += 0.5 * entry * p * z_[(n_ + i) * kPoints + point];
      pp_[(i * n_ + j) * kPoints + point] += entry;
    }
  }
}

// Newton's method keeps to a branch by steps that change H_yy by no more than a factor, and
// velocities grow like momenta. Where these grow a millionfold, as on the first steps of a path
// from rest, it takes a hundred iterations from there, and eight from the system's own guess.
// (Appell's constraint, 10 targets: median 1.1 s with all starts warm.)
bool HamiltonianTerms::is_near(const std::vector<double>& p) const {
  if (p.empty()) return false;
  for (int l = 0; l < kPoints; ++l) {
    double change = 0;
    double size = 0;
    for (int j = 0; j < n_; ++j) {
      const double before = p[j * kPoints + l];
      const double now = z_[(n_ + j) * kPoints + l];
      change += (now - before) * (now - before);
      size += before * before;
    }
    if (!(change <= size)) return false;
  }
  return true;
}

bool HamiltonianTerms::set_rates(Found& found) {
  const SystemFunctions& functions = *dynamics_.functions;
  const void* const system = dynamics_.system.get();
  std::vector<double>& y = found.y;
  const auto rates = [&] {
    return functions.rates(system, t_.data(), z_.data(), y.data(), z_dot_.data());
  };
  const bool near = is_near(found.p);
  found.p.assign(z_.begin() + n_ * kPoints, z_.end());
  if (near && rates()) return true;
  std::vector<double> branch(kMostAlgebraic * n_);
  functions.branch(system, branch.data());
  y.resize(branch.size() * kPoints);
  for (std::size_t k = 0; k < y.size(); ++k) y[k] = branch[k / kPoints];
  return rates();
}

bool HamiltonianTerms::add(int count, double sign, double weight, Order order, Found& found) {
  const SystemFunctions& functions = *dynamics_.functions;
  const void* const system = dynamics_.system.get();
  if (!set_rates(found)) {
    found.p.clear();
    return false;
  }
  const std::vector<double>& y = found.y;
  std::array<PointMeasures, kPoints> measures;
  functions.measure(system,
                    kPoints,
                    t_.data(),
                    kOnes.data(),
                    z_.data(),
                    z_dot_.data(),
                    y.data(),
                    measures.data());
  for (int l = 0; l < kPoints; ++l) value_[l] -= weight * measures[l].lagrangian;
  for (int j = 0; j < n_; ++j) {
    for (int l = 0; l < kPoints; ++l) {
      const int q = j * kPoints + l;
      const int p = (n_ + j) * kPoints + l;
      value_[l] += weight * z_[p] * z_dot_[q];
      by_p_[q] += sign * weight * z_dot_[q];
      by_q_[q] -= weight * z_dot_[p];
    }
  }
  if (order == Order::kFirst) return true;
  if (!set_jacobians(count, y)) return false;
  const auto row = [&](int r, int c) { return &jacobian_[(r * 2 * n_ + c) * kPoints]; };
  for (int i = 0; i < n_; ++i) {
    for (int j = 0; j < n_; ++j) {
      const int at = (i * n_ + j) * kPoints;
      for (int l = 0; l < kPoints; ++l) {
        qq_[at + l] -= weight * row(n_ + i, j)[l];
        qp_[at + l] += sign * weight * row(j, i)[l];
        pp_[at + l] += weight * row(i, n_ + j)[l];
      }
    }
  }
  return true;
}

bool HamiltonianTerms::set_jacobians(int count, const std::vector<double>& rows) {
  const SystemFunctions& functions = *dynamics_.functions;
  const void* const system = dynamics_.system.get();
  if (functions.jacobians(system, t_.data(), z_.data(), kOnes.data(), jacobian_.data())) {
    return true;
  }
  const int size = 2 * n_;
  std::vector<double> z(size);
  std::vector<double> y(rows.size() / kPoints);
  std::vector<double> jacobian(static_cast<std::size_t>(size) * size);
  for (int l = 0; l < count; ++l) {
    for (int k = 0; k < size; ++k) z[k] = z_[k * kPoints + l];
    for (std::size_t k = 0; k < y.size(); ++k) y[k] = rows[k * kPoints + l];
    const RateStatus status =
        functions.jacobian(system, t_[l], z.data(), y.data(), jacobian.data());
    if (status != RateStatus::kOk) return false;
    for (int r = 0; r < size; ++r) {
      for (int c = 0; c < size; ++c) {
        jacobian_[(r * size + c) * kPoints + l] = jacobian[c * size + r];
      }
    }
  }
  return true;
}

}  // namespace carnot::internal
