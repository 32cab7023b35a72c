#include "carnot/shooting/field/field_sweep.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>

#include "carnot/numerics/parallel.h"
#include "carnot/shooting/problem/ends.h"

namespace carnot::internal {

FieldSweep::FieldSweep(const BoundaryValueProblem& problem, const FieldGrid& grid)
    : problem_(problem),
      grid_(grid),
      newton_(problem),
      n_(problem.dynamics.dof),
      layers_(static_cast<long>(grid.axes.front().values.size())),
      points_(grid.size(), n_, grid.axes.size()) {
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
  if (!points_.is_more(i, point.action)) return false;
  points_.put(i, point);
  return true;
}

void FieldSweep::push_all(long i, long first, long last, FieldWave& wave) {
  // What waits for i comes first, since i tells what it knows once.
  if (wave.awaits(i)) wave.run();
  if (!points_.has_news(i, 0)) return;
  const FieldPoint from = points_.point(i);
  for (std::size_t axis = 0; axis < grid_.axes.size(); ++axis) {
    for (const int direction : {-1, 1}) {
      const FieldGrid::Step step = grid_.step(i, axis, direction);
      if (step.index >= first && step.index < last) wave.push(from, axis, step);
    }
  }
}

void FieldSweep::sweep_slab(long first,
                            long last,
                            bool forward,
                            const std::function<bool()>& goes_on,
                            FieldCounts& counts) {
  const long begin = first * layer_;
  const long end = last * layer_;
  FieldWave wave(problem_, grid_, points_, counts);
  for (long k = begin; k < end; ++k) {
    if (k % layer_ == 0 && !goes_on()) return;
    push_all(forward ? k : begin + end - 1 - k, begin, end, wave);
  }
  wave.run();
}

void FieldSweep::cross(long layer, FieldCounts& counts) {
  for (const int direction : {1, -1}) {
    FieldWave wave(problem_, grid_, points_, counts);
    const long from = direction > 0 ? layer : (layer + 1) % layers_;
    for (long k = from * layer_; k < (from + 1) * layer_; ++k) {
      if (!points_.has_news(k, direction > 0 ? 1 : 2)) continue;
      const FieldGrid::Step step = grid_.step(k, 0, direction);
      if (step.index >= 0) wave.push(points_.point(k), 0, step);
    }
    wave.run();
  }
}

Spread FieldSweep::spread(int threads,
                          const Progress& progress,
                          const std::function<void()>& between,
                          int most_sweeps) {
  constexpr long kSlabs = 16;
  const long slabs = std::clamp(layers_ / 2, 1L, kSlabs);
  const auto begin = [&](long slab) { return slab * layers_ / slabs; };
  const auto known = [this] {
    long count = 0;
    for (long i = 0; i < points_.size(); ++i) count += points_.known(i) ? 1 : 0;
    return static_cast<double>(count) / static_cast<double>(points_.size());
  };
  double part = is_spreading() ? known() : 0;
  const auto goes_on = [&] { return !progress || progress(part); };
  while (course_.sweeps < most_sweeps) {
    const bool forward = course_.sweeps % 2 == 0;
    std::vector<FieldCounts> counts(slabs);
    parallel_for(static_cast<int>(slabs), threads, [&](int slab) {
      sweep_slab(begin(slab), begin(slab + 1), forward, goes_on, counts[slab]);
    });
    if (!goes_on()) return Spread::kStopped;
    // Borders of every second pair of slabs, then the others; around, the last and the first.
    for (const long parity : {0L, 1L}) {
      parallel_for(static_cast<int>(slabs), threads, [&](int slab) {
        if (slab % 2 == parity && slab + 1 < slabs) cross(begin(slab + 1) - 1, counts[slab]);
      });
    }
    if (slabs > 1 || layers_ > 2) cross(layers_ - 1, counts[0]);
    long improved = 0;
    for (const FieldCounts& counted : counts) {
      counts_ += counted;
      improved += counted.improved;
    }
    // Who improved was told to its neighbours in this sweep, or will be in the next one.
    course_.quiet = improved == 0 ? course_.quiet + 1 : 0;
    ++course_.sweeps;
    counts_.sweeps = std::max<long>(counts_.sweeps, course_.sweeps);
    if (course_.quiet == 2) {
      course_ = {};
      return Spread::kSettled;
    }
    part = known();
    if (between) between();
  }
  course_ = {};
  return Spread::kTired;
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
  const FieldPoint point = points_.point(from);
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
          return points_.known(k) ? points_.action(k) : std::numeric_limits<double>::infinity();
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

double FieldSweep::error_of(long i, const std::vector<double>& units, int factor) const {
  const FieldPoint point = points_.point(i);
  const std::vector<double> end = newton_.end(point.p0, 2 * factor);
  if (end.empty()) return std::numeric_limits<double>::infinity();
  const std::vector<double> to = target(i, point.windings);
  double error = 0;
  for (int j = 0; j < n_; ++j) error = std::max(error, units[j] * std::abs(end[j] - to[j]));
  return error;
}

double FieldSweep::verify(long i, const std::vector<double>& units, double allowed) {
  constexpr int kMostSteps = 16;  // times those of the sweep
  double error = error_of(i, units, 1);
  long unused = 0;
  for (int factor = 2; factor <= kMostSteps && !(error <= allowed); factor *= 2) {
    FieldPoint point = points_.point(i);
    if (!newton_.solve(target(i, point.windings), point, unused, factor)) continue;
    if (point.sign != points_.sign(i)) break;
    points_.replace(i, point);
    error = error_of(i, units, factor);
  }
  return error;
}

}  // namespace carnot::internal
