// What a field says of each point in the end.
#include <algorithm>
#include <cmath>
#include <limits>

#include "carnot/numerics/parallel.h"
#include "carnot/shooting/field/field_solver.h"

namespace carnot::internal {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

}  // namespace

bool FieldSolver::answer(Field& field) {
  verify(field);
  if (partners_.stopped()) return false;
  const long size = grid_.size();
  std::vector<long> poor;
  for (long i = 0; i < size; ++i) {
    const bool settled = searches_.tried(i) || searches_.rests(i);
    if (!(field.error[i] <= allowed_error()) && !settled) poor.push_back(i);
  }
  searches_.keep(search(poor, options_.search.seed));
  if (partners_.stopped()) return false;
  course_.searches += static_cast<long>(poor.size());
  for (long i = 0; i < size; ++i) settle(i, field);
  return true;
}

void FieldSolver::verify(Field& field) {
  const long size = grid_.size();
  const int n = scaled_.dynamics.dof;
  field.dof = n;
  field.action.assign(size, kNaN);
  field.p0.assign(size * n, kNaN);
  field.error.assign(size, kNaN);
  field.verification.assign(size, Verification::kSingle);
  field.label.assign(size, Label::kUnknown);
  field.reason.assign(size, Reason::kNone);
  verify_parts(field.error);
  for (long i = 0; i < size; ++i) {
    if (!sweep_.points().known(i)) continue;
    const FieldPoint point = sweep_.points().point(sweep_.points().best(i));
    field.action[i] = point.action * scales_.action;
    field.label[i] = labels_[point.origin];
    for (int j = 0; j < n; ++j) field.p0[i * n + j] = point.p0[j] * scales_.momentum(j);
  }
}

void FieldSolver::verify_parts(std::vector<double>& errors) {
  const double allowed = allowed_error();
  const int threads = thread_count(options_.threads);
  const long size = grid_.size();
  constexpr long kBlock = 256;
  const long blocks = (size + kBlock - 1) / kBlock;
  sweep_.forget_changes();  // made by all partners alike
  parallel_for(static_cast<int>(blocks), threads, [&](int block) {
    if (!partners_.has(block) || !go_on()) return;
    std::vector<long> points;
    for (long i = block * kBlock; i < std::min(size, (block + 1) * kBlock); ++i) {
      if (sweep_.points().known(i)) points.push_back(i);
    }
    const std::vector<double> found = sweep_.verify(points, scales_.q, allowed);
    for (std::size_t k = 0; k < points.size(); ++k) errors[points[k]] = found[k];
  });
  sweep_.share();
  partners_.share([&errors](ByteWriter& out) { out.add(errors); },
                  [&errors](ByteReader& in) {
                    const auto theirs = in.take_all<double>(errors.size());
                    for (std::size_t i = 0; i < theirs.size(); ++i) {
                      if (!std::isnan(theirs[i])) errors[i] = theirs[i];
                    }
                  });
}

bool FieldSolver::is_less(const FieldFind& found, double action) {
  constexpr double kLower = 1e-12;  // relative
  double force = 0;
  for (const double p : found.p0) force += std::abs(p);
  return found.action + force * found.error < (1 - kLower) * action;
}

void FieldSolver::settle(long i, Field& field) const {
  const int n = field.dof;
  if (searches_.rests(i)) {
    field.action[i] = field.error[i] = 0;
    std::fill_n(field.p0.begin() + i * n, n, 0.0);
    field.label[i] = Label::kLocallyMinimal;  // nothing is less
    return;
  }
  const bool good = field.error[i] <= allowed_error();
  const FieldFind* found = searches_.find(i);
  if (found != nullptr && (!good || is_less(*found, field.action[i]))) {
    field.action[i] = found->action;
    std::copy(found->p0.begin(), found->p0.end(), field.p0.begin() + i * n);
    field.verification[i] = found->verification;
    field.error[i] = found->error;
    field.label[i] = found->label;
  } else if (!good) {
    const Reason failure = searches_.failure(i);
    field.reason[i] = failure == Reason::kNone ? Reason::kNotVerified : failure;
    field.action[i] = kNaN;
    field.error[i] = kNaN;
    std::fill_n(field.p0.begin() + i * n, n, kNaN);
    field.label[i] = Label::kUnknown;
  }
}

}  // namespace carnot::internal
