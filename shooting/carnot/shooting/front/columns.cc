#include "carnot/shooting/front/columns.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "carnot/numerics/parallel.h"
#include "carnot/shooting/front/ray_ends.h"
#include "carnot/shooting/linear/norm.h"
#include "carnot/shooting/rays/conjugate_time.h"

namespace carnot::internal {
namespace {

constexpr int kRays = 16;  // directions that tell a bound

// A column, and where its places end.
struct ColumnEnds {
  Column column;
  std::vector<double> ends;
};

class ColumnMaker {
 public:
  ColumnMaker(const ConjugateColumns& asked, ImageScale scale)
      : asked_(asked), n_(asked.dynamics.dof), scale_(std::move(scale)) {}

  std::vector<Column> all() {
    std::vector<ColumnEnds> even;
    for (const Column& column : even_columns(asked_.momenta, 0)) even.push_back({column, {}});
    const auto count = static_cast<int>(even.size());
    for_all(count, [&](int k) { even[k] = made(even[k].column.c); });
    std::vector<double> ends;
    for (const ColumnEnds& one : even) {
      if (!is_bounded(one.column)) return {};
      ends.insert(ends.end(), one.ends.begin(), one.ends.end());
    }
    scale_.measure(ends, n_);
    std::vector<std::vector<Column>> between(count);
    if (asked_.momenta.rank() > 1) {
      for_all(count, [&](int k) { add_between(even[k], even[(k + 1) % count], 0, between[k]); });
    }
    std::vector<Column> columns;
    for (int k = 0; k < count; ++k) {
      columns.push_back(even[k].column);
      columns.insert(columns.end(), between[k].begin(), between[k].end());
    }
    return columns;
  }

 private:
  template <class Work>
  void for_all(int count, const Work& work) const {
    parallel_for(count, thread_count(asked_.threads), work);
  }

  static bool is_bounded(const Column& column) {
    return std::isfinite(column.low) && std::isfinite(column.high);
  }

  [[nodiscard]] ColumnEnds made(const Eigen::Vector3d& c) const {
    constexpr int kDoublings = 13;
    const auto bound = [&](double side) {
      return bound_along(
          asked_.dynamics, asked_.from, asked_.momenta, asked_.target, {c, {side, 0}}, kDoublings);
    };
    ColumnEnds one{{c, -bound(-1), bound(1)}, {}};
    if (!is_bounded(one.column)) return one;
    std::vector<std::vector<double>> momenta;
    momenta.reserve(kPlacesOnColumn);
    for (int i = 0; i < kPlacesOnColumn; ++i) {
      momenta.push_back(asked_.momenta.momentum(place_on(one.column, i)));
    }
    const std::vector<std::vector<double>> longest{momenta.front(), momenta.back()};
    one.ends = ray_ends(asked_.dynamics, asked_.from, momenta, longest, asked_.target, 1);
    return one;
  }

  // Whether ends are apart, and by so much more than along the columns that middles of edges would
  // make slivers.
  [[nodiscard]] bool apart(const ColumnEnds& a, const ColumnEnds& b) const {
    // Martinet's sphere with edges of 0.2 has a first mesh of 60 columns and ends with 45,000
    // vertices; with 4 it has 48, as without this, and more than 68,000 are too few. Spheres of
    // unicycles have 48 either way.
    constexpr double kSliver = 2;
    const auto end = [&](const ColumnEnds& of, int i) {
      return scale_.image(&of.ends[static_cast<std::size_t>(i) * n_]);
    };
    for (int i = 0; i + 1 < kPlacesOnColumn; ++i) {
      const double across = distance(end(a, i), end(b, i));
      const double along =
          std::max(distance(end(a, i), end(a, i + 1)), distance(end(b, i), end(b, i + 1)));
      if (across > asked_.edge && across > kSliver * along) return true;
    }
    return false;
  }

  void add_between(const ColumnEnds& a,
                   const ColumnEnds& b,
                   int depth,
                   std::vector<Column>& columns) const {
    constexpr int kDeepest = 10;
    if (depth == kDeepest || !apart(a, b)) return;
    ColumnEnds middle = made((a.column.c + b.column.c).normalized());
    if (!is_bounded(middle.column)) return;
    middle.column.added = true;
    add_between(a, middle, depth + 1, columns);
    columns.push_back(middle.column);
    add_between(middle, b, depth + 1, columns);
  }

  const ConjugateColumns& asked_;
  int n_;
  ImageScale scale_;
};

}  // namespace

double bound_along(const Dynamics& dynamics,
                   const std::vector<double>& from,
                   const UnitMomenta& momenta,
                   double target,
                   const UnitMomentum& side,
                   int doublings) {
  constexpr double kEnough = 0.02;
  const auto is_conjugate = [&](double w) {
    const Ray ray(dynamics, from, momenta.momentum({side.c, w * side.w}));
    return conjugate_time(ray, 1.01 * target) <= target;
  };
  double low = 0;
  double high = 1 / target;
  for (int i = 0; !is_conjugate(high); ++i) {
    if (i == doublings) return std::numeric_limits<double>::infinity();
    low = high;
    high *= 2;
  }
  while (high - low > kEnough * high) {
    const double middle = 0.5 * (low + high);
    (is_conjugate(middle) ? high : low) = middle;
  }
  return high;
}

UnitMomentum place_on(const Column& column, int i) {
  return {column.c, {column.low + (column.high - column.low) * i / (kPlacesOnColumn - 1), 0}};
}

std::vector<Column> even_columns(const UnitMomenta& momenta, double bound) {
  constexpr int kAround = 48;
  std::vector<Column> columns;
  for (const Eigen::Vector3d& c : momenta.directions(momenta.rank() == 1 ? 2 : kAround)) {
    columns.push_back({c, -bound, bound});
  }
  return columns;
}

std::vector<double> bounds_along(const Dynamics& dynamics,
                                 const std::vector<double>& from,
                                 const UnitMomenta& momenta,
                                 double target,
                                 const Eigen::Vector2d& axis,
                                 int directions,
                                 int doublings,
                                 int threads) {
  const std::vector<Eigen::Vector3d> all = momenta.directions(directions);
  std::vector<double> bounds(2 * all.size(), 0);
  parallel_for(2 * directions, thread_count(threads), [&](int k) {
    const double side = k % 2 == 0 ? 1 : -1;
    bounds[k] = bound_along(dynamics, from, momenta, target, {all[k / 2], side * axis}, doublings);
  });
  return bounds;
}

double conjugate_bound(const Dynamics& dynamics,
                       const std::vector<double>& from,
                       const UnitMomenta& momenta,
                       double target,
                       int threads) {
  constexpr int kDoublings = 8;
  const std::vector<double> bounds = bounds_along(
      dynamics, from, momenta, target, Eigen::Vector2d::UnitX(), kRays, kDoublings, threads);
  return *std::max_element(bounds.begin(), bounds.end());
}

double median_conjugate_bound(const Dynamics& dynamics,
                              const std::vector<double>& from,
                              const UnitMomenta& momenta,
                              double target,
                              int threads) {
  constexpr int kDoublings = 20;
  std::vector<double> bounds = bounds_along(
      dynamics, from, momenta, target, Eigen::Vector2d::UnitX(), kRays, kDoublings, threads);
  const auto middle = bounds.begin() + std::ssize(bounds) / 2;
  std::nth_element(bounds.begin(), middle, bounds.end());
  return *middle;
}

std::vector<Column> conjugate_columns(const ConjugateColumns& asked, ImageScale scale) {
  return ColumnMaker(asked, std::move(scale)).all();
}

}  // namespace carnot::internal
