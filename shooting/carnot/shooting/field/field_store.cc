#include "carnot/shooting/field/field_store.h"

#include <algorithm>
#include <utility>

namespace carnot::internal {
namespace {

std::size_t numbers_of_a_point(int n) {
  return static_cast<std::size_t>(2 * n + n * n + n * (n + 1) / 2);
}

}  // namespace

FieldStore::FieldStore(long points, int n, std::size_t axes)
    : n_(n),
      axes_(axes),
      width_(numbers_of_a_point(n)),
      states_(points),
      numbers_(points * width_),
      windings_(points * axes) {}

FieldPoint FieldStore::point(long i) const {
  const State& state = states_[i];
  FieldPoint point;
  point.sign = state.sign;
  point.origin = state.origin;
  point.action = state.action;
  const double* next = numbers(i);
  point.p0 = Eigen::Map<const Eigen::VectorXd>(next, n_);
  next += n_;
  point.p1 = Eigen::Map<const Eigen::VectorXd>(next, n_);
  next += n_;
  point.inverse = Eigen::Map<const Eigen::MatrixXd>(next, n_, n_);
  next += n_ * n_;
  point.slope.resize(n_, n_);
  for (int r = 0; r < n_; ++r) {
    for (int c = 0; c <= r; ++c) point.slope(r, c) = point.slope(c, r) = *next++;
  }
  point.windings = windings(i);
  return point;
}

SmallVector FieldStore::p0(long i) const {
  return Eigen::Map<const Eigen::VectorXd>(numbers(i), n_);
}

std::vector<int> FieldStore::windings(long i) const {
  const auto* const begin = &windings_[i * axes_];
  return {begin, begin + axes_};
}

void FieldStore::put(long i, const FieldPoint& point) {
  states_[i].news = kSlab | kUp | kDown;
  states_[i].doubted = false;
  replace(i, point);
}

void FieldStore::replace(long i, const FieldPoint& point) {
  State& state = states_[i];
  state.known = true;
  state.sign = point.sign;
  state.origin = point.origin;
  state.action = point.action;
  double* next = &numbers_[i * width_];
  next = std::copy_n(point.p0.data(), n_, next);
  next = std::copy_n(point.p1.data(), n_, next);
  next = std::copy_n(point.inverse.data(), n_ * n_, next);
  for (int r = 0; r < n_; ++r) {
    for (int c = 0; c <= r; ++c) *next++ = 0.5 * (point.slope(r, c) + point.slope(c, r));
  }
  std::transform(
      point.windings.begin(), point.windings.end(), &windings_[i * axes_], [](int turns) {
        return static_cast<std::int16_t>(turns);
      });
}

void FieldStore::write(ByteWriter& out) const {
  out.add(states_);
  out.add(numbers_);
  out.add(windings_);
}

void FieldStore::read(ByteReader& in) {
  const auto take = [&in]<class T>(std::vector<T>& values) {
    std::vector<T> taken = in.take_all<T>(values.size());
    if (taken.size() != values.size()) ByteReader::fail();
    values = std::move(taken);
  };
  take(states_);
  take(numbers_);
  take(windings_);
}

}  // namespace carnot::internal
