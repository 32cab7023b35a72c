#include "carnot/shooting/field/field_sweep.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "carnot/numerics/parallel.h"
#include "carnot/numerics/scalar.h"
#include "carnot/shooting/problem/ends.h"

namespace carnot::internal {

namespace {

constexpr double kUnreached = std::numeric_limits<double>::infinity();
constexpr long kMostSlabs = 16;

}  // namespace

FieldSweep::FieldSweep(const BoundaryValueProblem& problem,
                       const FieldGrid& grid,
                       int branches,
                       FieldPartners& partners)
    : problem_(problem),
      grid_(grid),
      partners_(partners),
      newton_(problem),
      n_(problem.dynamics.dof),
      layers_(static_cast<long>(grid.axes.front().values.size())),
      slabs_(std::clamp(layers_ / 2, 1L, kMostSlabs)),
      points_(grid.size(), n_, grid.axes.size(), branches),
      queues_(slabs_) {
  layer_ = grid.size() / layers_;
}

bool FieldSweep::seed(long i,
                      const std::vector<double>& p0,
                      const std::vector<int>& windings,
                      int origin,
                      long& flows) {
  FieldPoint point;
  point.p0 = Eigen::Map<const Eigen::VectorXd>(p0.data(), n_);
  point.windings = windings;
  point.origin = origin;
  if (!newton_.solve(target(i, windings), point, flows)) return false;
  return points_.put(i, point).has_value();
}

std::vector<long> FieldSweep::borders() const {
  std::vector<long> layers;
  for (long slab = 1; slab <= slabs_ && slabs_ > 1; ++slab) layers.push_back(begin_of(slab) - 1);
  return layers;
}

long FieldSweep::slab_of(FieldSlot slot) const {
  const long layer = points_.point_of(slot) / layer_;
  long slab = layer * slabs_ / layers_;
  while (begin_of(slab + 1) <= layer) ++slab;
  return slab;
}

void FieldSweep::queue(FieldSlot slot) {
  const long slab = slab_of(slot);
  if (partners_.has(slab)) queues_[slab].push({points_.action(slot), slot});
}

void FieldSweep::gather() {
  queues_.assign(slabs_, {});
  for (long layer = 0; layer < layers_; ++layer) {
    for_layer(layer, [this](FieldSlot slot) {
      if (points_.has_news(slot, FieldStore::kSlab)) queue(slot);
    });
  }
}

double FieldSweep::least_news() {
  double least = kUnreached;
  for (Queue& queue : queues_) {
    while (!queue.empty() && !points_.has_news(queue.top().slot, FieldStore::kSlab)) queue.pop();
    if (!queue.empty()) least = std::min(least, queue.top().action);
  }
  for (const long border : borders()) {
    for (const auto& [layer, direction] : {std::pair{border, 1}, {(border + 1) % layers_, -1}}) {
      const FieldStore::Whom whom = direction > 0 ? FieldStore::kUp : FieldStore::kDown;
      for_layer(layer, [&, step = direction](FieldSlot slot) {
        if (!points_.has_news(slot, whom)) return;
        const bool is_neighbour = grid_.step(points_.point_of(slot), 0, step).index >= 0;
        if (is_neighbour) least = std::min(least, points_.action(slot));
      });
    }
  }
  partners_.share([&least](ByteWriter& out) { out.add(least); },
                  [&least](ByteReader& in) { least = std::min(least, in.take<double>()); });
  return least;
}

void FieldSweep::share() {
  partners_.share([this](ByteWriter& out) { points_.write_changes(out); },
                  [this](ByteReader& in) {
                    for (const FieldSlot slot : points_.read_changes(in)) {
                      if (points_.has_news(slot, FieldStore::kSlab)) queue(slot);
                    }
                  });
}

void FieldSweep::push_all(FieldSlot slot, long slab, FieldWave& wave) {
  const long first = begin_of(slab) * layer_;
  const long last = begin_of(slab + 1) * layer_;
  const long i = points_.point_of(slot);
  const FieldPoint from = points_.point(slot);
  points_.told(slot, FieldStore::kSlab);
  for (std::size_t axis = 0; axis < grid_.axes.size(); ++axis) {
    for (const int direction : {-1, 1}) {
      const FieldGrid::Step step = grid_.step(i, axis, direction);
      if (step.index >= first && step.index < last) wave.push(from, axis, step);
    }
  }
}

void FieldSweep::sweep_slab(long slab, const std::function<bool()>& goes_on, FieldCounts& counts) {
  Queue& news = queues_[slab];
  FieldWave wave(problem_, grid_, points_, counts);
  std::vector<FieldSlot> waiting;  // for what may make them better
  while (goes_on()) {
    while (!news.empty() && news.top().action <= course_.level && !wave.full()) {
      const FieldSlot next = news.top().slot;
      news.pop();
      if (!points_.has_news(next, FieldStore::kSlab)) continue;
      if (wave.awaits(points_.point_of(next))) {
        waiting.push_back(next);
      } else {
        push_all(next, slab, wave);
      }
    }
    if (wave.empty()) return;
    for (const FieldSlot next : wave.run()) queue(next);
    for (const FieldSlot next : waiting) queue(next);
    waiting.clear();
  }
}

void FieldSweep::cross(long layer, FieldCounts& counts) {
  for (const int direction : {1, -1}) {
    const FieldStore::Whom whom = direction > 0 ? FieldStore::kUp : FieldStore::kDown;
    FieldWave wave(problem_, grid_, points_, counts);
    const auto run = [&] {
      for (const FieldSlot slot : wave.run()) queue(slot);
    };
    const long from = direction > 0 ? layer : (layer + 1) % layers_;
    for_layer(from, [&](FieldSlot slot) {
      if (!points_.has_news(slot, whom) || points_.action(slot) > course_.level) return;
      points_.told(slot, whom);
      const FieldGrid::Step step = grid_.step(points_.point_of(slot), 0, direction);
      if (step.index >= 0) wave.push(points_.point(slot), 0, step);
      if (wave.full()) run();
    });
    run();
  }
}

Spread FieldSweep::spread(int threads,
                          const Progress& progress,
                          const std::function<void()>& between,
                          int most_sweeps) {
  // Of the level. With 1.3, 2 and 4 a field of 69,696 vehicles takes 18, 8 and 5 sweeps, and the
  // same time on two threads.
  constexpr double kRise = 2;
  const auto known = [this] {
    long count = 0;
    for (long i = 0; i < points_.size(); ++i) count += points_.known(i) ? 1 : 0;
    return static_cast<double>(count) / static_cast<double>(points_.size());
  };
  double part = is_spreading() ? known() : 0;
  const auto goes_on = [&] {
    if (progress && !progress(part)) partners_.stop();
    return !partners_.stops();
  };
  points_.forget_changes();  // made by all partners alike
  gather();
  while (course_.sweeps < most_sweeps) {
    (void)goes_on();
    const double least = least_news();
    if (partners_.stopped()) return Spread::kStopped;
    if (!std::isfinite(least)) {
      course_ = {};
      return Spread::kSettled;
    }
    if (least > course_.level) course_.level = kRise * least;
    const FieldCounts counted = sweep(threads, goes_on);
    if (partners_.stopped()) return Spread::kStopped;  // within a slab
    counts_ += counted;
    ++course_.sweeps;
    counts_.sweeps = std::max(counts_.sweeps, course_.sweeps);
    part = known();
    if (between) between();
  }
  course_ = {};
  return Spread::kTired;
}

FieldCounts FieldSweep::sweep(int threads, const std::function<bool()>& goes_on) {
  std::vector<FieldCounts> counts(slabs_);
  parallel_for(static_cast<int>(slabs_), threads, [&](int slab) {
    if (partners_.has(slab)) sweep_slab(slab, goes_on, counts[slab]);
  });
  share();
  if (partners_.stopped()) return {};
  const std::vector<long> crossed = borders();
  const int inner = std::max(0, static_cast<int>(crossed.size()) - 1);
  const auto cross_own = [&](int border) {
    if (partners_.has(border / 2)) cross(crossed[border], counts[border]);
  };
  // Every second border, then the others; around, the last and the first.
  for (const int parity : {0, 1}) {
    parallel_for(inner, threads, [&](int border) {
      if (border % 2 == parity) cross_own(border);
    });
    share();
  }
  if (!crossed.empty()) cross_own(inner);
  FieldCounts all;
  for (const FieldCounts& counted : counts) all += counted;
  share();
  partners_.share([&all](ByteWriter& out) { out.add(all); },
                  [&all](ByteReader& in) { all += in.take<FieldCounts>(); });
  return all;
}

void FieldSweep::write(ByteWriter& out) const {
  out.add(counts_);
  out.add(course_);
  points_.write(out);
}

void FieldSweep::read(ByteReader& in) {
  counts_ = in.take<FieldCounts>();
  course_ = in.take<Course>();
  points_.read(in);
}

bool FieldSweep::reflect(long from, const std::vector<double>& mirror, long& flows) {
  const FieldPoint point = points_.point(points_.best(from));
  const FieldGrid::Image image = grid_.image(from, point.windings, mirror);
  std::vector<double> p0(n_);
  for (int j = 0; j < n_; ++j) p0[j] = mirror[j] * point.p0[j];
  return seed(image.index, p0, image.windings, point.origin, flows);
}

long FieldSweep::reflect(int threads) {
  constexpr double kLess = 1e-9;  // relative; less is what the sweep's flows are good to
  constexpr long kBlock = 256;
  const auto blocks = static_cast<int>((points_.size() + kBlock - 1) / kBlock);
  const std::vector<int> none(grid_.axes.size(), 0);
  long improved = 0;
  for (const std::vector<double>& mirror : problem_.dynamics.info.symmetries.mirrors) {
    bool keeps_start = true;
    for (int j = 0; j < n_; ++j) {
      keeps_start = keeps_start && mirror[j] * problem_.from[j] == problem_.from[j];
    }
    if (!keeps_start) continue;
    std::vector<FieldCounts> counts(blocks);
    parallel_for(blocks, threads, [&](int block) {
      for (long i = block * kBlock; i < std::min(points_.size(), (block + 1) * kBlock); ++i) {
        // Each pair once, so that no two threads meet.
        const long other = grid_.image(i, none, mirror).index;
        if (other <= i || !(points_.known(i) || points_.known(other))) continue;
        const auto action = [&](long k) {
          return points_.known(k) ? points_.action(k) : kUnreached;
        };
        const long less = action(i) < action(other) ? i : other;
        const long more = i + other - less;
        if (!(action(less) < (1 - kLess) * action(more))) continue;
        if (reflect(less, mirror, counts[block].flows)) ++counts[block].improved;
      }
    });
    for (const FieldCounts& part : counts) {
      counts_ += part;
      improved += part.improved;
    }
  }
  return improved;
}

std::vector<long> FieldSweep::doubtful() const {
  std::vector<long> list;
  for (long i = 0; i < points_.size(); ++i) {
    if (!points_.known(i) || points_.doubted(i)) list.push_back(i);
  }
  return list;
}

double FieldSweep::error_of(FieldSlot slot,
                            const SmallVector& end,
                            const std::vector<double>& units) const {
  const std::vector<double> to = target(points_.point_of(slot), points_.windings(slot));
  double error = 0;
  for (int j = 0; j < n_; ++j) error = maximum(error, units[j] * std::abs(end[j] - to[j]));
  return error;
}

std::vector<double> FieldSweep::packed_errors(std::span<const long> points,
                                              const std::vector<double>& units) const {
  constexpr double kTolerance = 0.1 * kFineFlow;  // not that of the flows that made the extremals
  std::vector<SmallVector> p0;
  for (const long i : points) p0.push_back(points_.p0(points_.best(i)));
  const std::vector<PackedEnd> ends = packed_ends(problem_, p0, std::vector(p0.size(), kTolerance));
  std::vector<double> errors(points.size(), kUnreached);
  for (std::size_t k = 0; k < points.size(); ++k) {
    if (ends[k].reached) errors[k] = error_of(points_.best(points[k]), ends[k].q1, units);
  }
  return errors;
}

std::vector<double> FieldSweep::verify(std::span<const long> points,
                                       const std::vector<double>& units,
                                       double allowed) {
  std::vector<double> errors(points.size(), kUnreached);
  const auto beyond = [&](std::size_t k) { return !(errors[k] <= allowed); };
  if (has_packs(problem_.dynamics)) {
    errors = packed_errors(points, units);
    std::vector<FieldAttempt> attempts;
    std::vector<std::size_t> tried;
    for (std::size_t k = 0; k < points.size(); ++k) {
      if (!beyond(k)) continue;
      const FieldPoint point = points_.point(points_.best(points[k]));
      attempts.push_back({target(points[k], point.windings), point.inverse, point});
      tried.push_back(k);
    }
    newton_.polish(attempts);
    std::vector<long> mended;
    for (std::size_t a = 0; a < tried.size(); ++a) {
      const long i = points[tried[a]];
      if (attempts[a].found) points_.replace(points_.best(i), attempts[a].point);
      mended.push_back(i);
    }
    const std::vector<double> left = packed_errors(mended, units);
    for (std::size_t a = 0; a < tried.size(); ++a) errors[tried[a]] = left[a];
  }
  for (std::size_t k = 0; k < points.size(); ++k) {
    if (beyond(k)) errors[k] = verify_by_steps(points[k], units, allowed);
  }
  return errors;
}

double FieldSweep::verify_by_steps(long i, const std::vector<double>& units, double allowed) {
  constexpr int kMostSteps = 16;  // times those of the sweep
  const FieldSlot slot = points_.best(i);
  const auto error_by = [&](int factor) {
    const std::vector<double> end = newton_.end(points_.p0(slot), 2 * factor);
    return end.empty() ? kUnreached
                       : error_of(slot, Eigen::Map<const Eigen::VectorXd>(end.data(), n_), units);
  };
  double error = error_by(1);
  long unused = 0;
  for (int factor = 2; factor <= kMostSteps && !(error <= allowed); factor *= 2) {
    FieldPoint point = points_.point(slot);
    if (!newton_.solve(target(i, point.windings), point, unused, factor)) continue;
    if (point.sign != points_.sign(slot)) break;
    points_.replace(slot, point);
    error = error_by(factor);
  }
  return error;
}

}  // namespace carnot::internal
