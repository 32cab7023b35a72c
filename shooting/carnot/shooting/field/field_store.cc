#include "carnot/shooting/field/field_store.h"

#include <algorithm>
#include <span>
#include <utility>

namespace carnot::internal {
namespace {

std::size_t numbers_of_a_slot(std::size_t n) { return 2 * n + n * n + n * (n + 1) / 2; }

}  // namespace

FieldStore::FieldStore(long points, int n, std::size_t axes, int branches)
    : n_(n),
      axes_(axes),
      branches_(branches),
      width_(numbers_of_a_slot(static_cast<std::size_t>(n))),
      states_(points * branches),
      numbers_(points * branches * width_),
      windings_(points * branches * axes),
      doubted_(points) {}

FieldSlot FieldStore::best(long i) const {
  FieldSlot best = slot(i, 0);
  for (int b = 1; b < branches_ && is_filled(slot(i, b)); ++b) {
    if (action(slot(i, b)) < action(best)) best = slot(i, b);
  }
  return best;
}

bool FieldStore::is_more(FieldSlot slot, double action) const {
  constexpr double kBetter = 1e-10;  // relative; less is round-off
  return !is_filled(slot) || action < (1 - kBetter) * states_[at(slot)].action;
}

bool FieldStore::wants(long i, double action) const {
  for (int b = 0; b < branches_; ++b) {
    if (is_more(slot(i, b), action)) return true;
  }
  return false;
}

bool FieldStore::is_same(FieldSlot slot, const FieldPoint& point) const {
  constexpr double kSame = 1e-4;  // of the largest momentum
  const SmallVector there = p0(slot);
  const double apart = (point.p0 - there).cwiseAbs().maxCoeff();
  return apart <= kSame * there.cwiseAbs().maxCoeff() && windings(slot) == point.windings;
}

std::optional<FieldSlot> FieldStore::place_of(long i, const FieldPoint& point) const {
  FieldSlot place = slot(i, 0);
  for (int b = 0; b < branches_; ++b) {
    const FieldSlot next = slot(i, b);
    if (!is_filled(next)) return next;
    if (is_same(next, point)) {
      place = next;
      break;
    }
    if (action(next) > action(place)) place = next;
  }
  if (!is_more(place, point.action)) return std::nullopt;
  return place;
}

std::optional<FieldSlot> FieldStore::put(long i, const FieldPoint& point) {
  const std::optional<FieldSlot> place = place_of(i, point);
  if (!place) return std::nullopt;
  if (!known(i) || point.action < action(i)) doubted_[i] = 0;
  states_[at(*place)].news = kSlab | kUp | kDown;
  replace(*place, point);
  return place;
}

FieldPoint FieldStore::point(FieldSlot slot) const {
  const State& state = states_[at(slot)];
  FieldPoint point;
  point.sign = state.sign;
  point.origin = state.origin;
  point.action = state.action;
  const double* next = numbers(slot);
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
  point.windings = windings(slot);
  return point;
}

SmallVector FieldStore::p0(FieldSlot slot) const {
  return Eigen::Map<const Eigen::VectorXd>(numbers(slot), n_);
}

std::vector<int> FieldStore::windings(FieldSlot slot) const {
  const auto* const begin = &windings_[at(slot) * axes_];
  return {begin, begin + axes_};
}

void FieldStore::replace(FieldSlot slot, const FieldPoint& point) {
  State& state = states_[at(slot)];
  state.known = state.changed = true;
  state.sign = point.sign;
  state.origin = point.origin;
  state.action = point.action;
  double* next = &numbers_[at(slot) * width_];
  next = std::copy_n(point.p0.data(), n_, next);
  next = std::copy_n(point.p1.data(), n_, next);
  next = std::copy_n(point.inverse.data(), n_ * n_, next);
  for (int r = 0; r < n_; ++r) {
    for (int c = 0; c <= r; ++c) *next++ = 0.5 * (point.slope(r, c) + point.slope(c, r));
  }
  std::transform(
      point.windings.begin(), point.windings.end(), &windings_[at(slot) * axes_], [](int turns) {
        return static_cast<std::int16_t>(turns);
      });
}

void FieldStore::write(ByteWriter& out) const {
  out.add(states_);
  out.add(numbers_);
  out.add(windings_);
  out.add(doubted_);
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
  take(doubted_);
}

void FieldStore::write_changes(ByteWriter& out) {
  constexpr long kEnd = -1;
  for (long k = 0; k < static_cast<long>(states_.size()); ++k) {
    State& state = states_[k];
    if (!state.changed) continue;
    state.changed = false;
    out.add(k);
    out.add(state);
    out.add(doubted_[k / branches_]);
    out.add_all<double>({&numbers_[k * width_], width_});
    out.add_all<std::int16_t>({&windings_[k * axes_], axes_});
  }
  out.add(kEnd);
}

void FieldStore::forget_changes() {
  for (State& state : states_) state.changed = false;
}

std::vector<FieldSlot> FieldStore::read_changes(ByteReader& in) {
  std::vector<FieldSlot> slots;
  for (auto k = in.take<long>(); k >= 0; k = in.take<long>()) {
    if (k >= static_cast<long>(states_.size())) ByteReader::fail();
    states_[k] = in.take<State>();
    states_[k].changed = false;
    doubted_[k / branches_] = in.take<std::uint8_t>();
    in.take_into(std::span(&numbers_[k * width_], width_));
    in.take_into(std::span(&windings_[k * axes_], axes_));
    slots.push_back(FieldSlot{k});
  }
  return slots;
}

}  // namespace carnot::internal
