#include "carnot/shooting/front/section_field.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "carnot/shooting/front/grid_topology.h"
#include "carnot/shooting/front/level_point.h"
#include "carnot/shooting/linear/dense.h"
#include "carnot/shooting/problem/natural_scales.h"
#include "carnot/shooting/rays/ray.h"

namespace carnot::internal {

SectionField::SectionField(const Dynamics& dynamics,
                           const std::vector<double>& from,
                           const SectionOptions& options)
    : dynamics_(dynamics), from_(from), options_(options) {
  int k = 0;
  for (int j = 0; j < dynamics.dof; ++j) {
    if (j != options.condition.coordinate) seen_[k++] = j;
  }
}

bool SectionField::fit() {
  begin_box();
  if (!settle_box() || (shear() && !settle_box())) return false;
  const bool is_empty =
      std::none_of(beyond_.begin(), beyond_.end(), [](double b) { return b < 0; });
  return is_empty || solve_finely();
}

bool SectionField::is_known(GridPlace i) const {
  return std::isfinite(field_.p0[i * dynamics_.dof]);
}

Eigen::VectorXd SectionField::momentum(GridPlace i) const {
  return Eigen::Map<const Eigen::VectorXd>(&field_.p0[i * dynamics_.dof], dynamics_.dof);
}

Eigen::VectorXd SectionField::place(GridPlace i) const { return vector_of(grid_.target(i)); }

Eigen::VectorXd SectionField::widths() const {
  Eigen::VectorXd widths = Eigen::VectorXd::Zero(dynamics_.dof);
  for (int k = 0; k < 3; ++k) widths[seen_[k]] = 2 * half_[k];
  const EndCondition& condition = options_.condition;
  widths[condition.coordinate] = condition.equal >= 0 ? widths[condition.equal] : widths.maxCoeff();
  return widths;
}

long SectionField::unknown() const { return std::count(beyond_.begin(), beyond_.end(), 1.0); }

std::array<double, 3> SectionField::on_axes(const std::vector<double>& q) const {
  std::vector<double> own = q;
  for (const FieldGrid::Follower& one : shear_) own[one.coordinate] -= one.ratio * q[one.leader];
  return {own[seen_[0]], own[seen_[1]], own[seen_[2]]};
}

FieldGrid SectionField::grid_of(const std::array<int, 3>& counts) const {
  FieldGrid grid;
  grid.to = from_;
  const std::array<double, 3> middle = on_axes(from_);
  for (int k = 0; k < 3; ++k) {
    FieldGrid::Axis axis{seen_[k], {}, false, 0};
    for (int i = 0; i < counts[k]; ++i) {
      axis.values.push_back(middle[k] + half_[k] * (2.0 * i / (counts[k] - 1) - 1));
    }
    grid.axes.push_back(std::move(axis));
  }
  const EndCondition& condition = options_.condition;
  grid.to[condition.coordinate] = condition.value;
  grid.followers = shear_;
  if (condition.equal >= 0) grid.followers.push_back({condition.coordinate, condition.equal, 1});
  return grid;
}

bool SectionField::solve(FieldGrid grid, long check) {
  grid_ = std::move(grid);
  BoundaryValueProblem problem(dynamics_, from_, grid_.target(0), options_.length);
  for (long i = 0; i < grid_.size(); ++i) {
    problem.to = grid_.target(i);
    if (end_status(dynamics_, problem.to) == RateStatus::kOk) break;
  }
  FieldOptions field;
  field.search.seed = options_.seed;
  field.search.mod_angles = false;
  field.threads = options_.threads;
  field.check = check;
  field.progress = options_.progress;
  field_ = FieldSolver(problem, grid_, field).run();
  searches_ += field_.searches + field_.checked;
  beyond_.clear();
  for (const double action : field_.action) {
    const double d = std::sqrt(2 * action / options_.length);
    beyond_.push_back(std::isfinite(d) ? d - 1 : 1);
  }
  return field_.finished;
}

std::array<double, 3> SectionField::in_box(GridPlace i) const {
  std::array<double, 3> at = on_axes(grid_.target(i));
  const std::array<double, 3> middle = on_axes(from_);
  for (int k = 0; k < 3; ++k) at[k] = (at[k] - middle[k]) / half_[k];
  return at;
}

std::array<double, 3> SectionField::reaches() const {
  std::array<double, 3> reach{};
  for (GridPlace i = 0; i < grid_.size(); ++i) {
    if (beyond_[i] >= 0) continue;
    const std::array<double, 3> at = in_box(i);
    for (int k = 0; k < 3; ++k) reach[k] = std::max(reach[k], std::abs(at[k]));
  }
  return reach;
}

void SectionField::begin_box() {
  const BoundaryValueProblem here(dynamics_, from_, from_, options_.length);
  const std::vector<double> scales = natural_scales(here).q;
  double largest = 0;  // in natural scales
  for (int k = 0; k < 3; ++k) {
    std::vector<double> z = from_;
    z.resize(2 * from_.size());
    z[from_.size() + seen_[k]] = 1;
    half_[k] = std::sqrt(2 * motion_at(dynamics_, z.data()).hamiltonian) * options_.length;
    largest = std::max(largest, half_[k] / scales[seen_[k]]);
  }
  for (int k = 0; k < 3; ++k) {
    if (!(half_[k] > 0)) half_[k] = 0.5 * largest * scales[seen_[k]];
  }
}

// Of three spheres (the vehicle's of lengths 1 and 2 in theta = phi, Engel's in x4 = 0, edges of
// 0.5) all are closed without handles whatever is put here, and the first one takes 200 searches
// with these values. It takes 530 and 630 with margins of 1 and 2.5 cells, 480 and 235 where a box
// is loose at 0.7 and 0.95. The second one takes 250, and 520 where a box grows by 1.2 only.
bool SectionField::settle_box() {
  constexpr int kRounds = 12;   // most end after four
  constexpr int kVain = 1;      // more rounds without any place inside
  constexpr double kOut = 1.5;  // where the sphere crosses the border
  constexpr double kMargin = 1.5 * kCell;
  constexpr double kLoose = 0.85;
  for (int round = 0; round < kRounds; ++round) {
    if (!solve(grid_of({kCoarse, kCoarse, kCoarse}), 0)) return false;
    const std::array<double, 3> reach = reaches();
    if (reach[0] == 0 && reach[1] == 0 && reach[2] == 0 && round > kVain) break;
    bool changed = false;
    for (int k = 0; k < 3; ++k) {
      const double wanted = reach[k] > 1 - 0.5 * kCell ? kOut : std::min(1.0, reach[k] + kMargin);
      if (wanted > kLoose && wanted <= 1) continue;
      half_[k] *= wanted;
      changed = true;
    }
    if (!changed) break;
  }
  return true;
}

// A sphere may be a thin sheet across the axes: that of the vehicle in theta = phi is a tenth as
// thick as it is wide in y and theta. Then the coordinate that is most across the sheet follows the
// others along it, and the box becomes thinner. It does so with 0.7 and with 0.95 alike. Where it
// never does, that sphere has four handles with edges of 0.5.
bool SectionField::shear() {
  constexpr double kWorth = 0.7;
  std::vector<std::array<double, 3>> inside;
  for (GridPlace i = 0; i < grid_.size(); ++i) {
    if (beyond_[i] < 0) inside.push_back(in_box(i));
  }
  if (inside.empty()) return false;
  Eigen::MatrixXd spread = Eigen::MatrixXd::Zero(3, 3);
  for (const auto& at : inside) {
    const Eigen::Vector3d x(at[0], at[1], at[2]);
    spread += x * x.transpose();
  }
  const Eigen::VectorXd across = symmetric_eigen(spread).vectors.col(0);
  Eigen::Index c = 0;
  across.cwiseAbs().maxCoeff(&c);
  double reach = 0;
  double before = 0;
  for (const auto& at : inside) {
    const Eigen::Vector3d x(at[0], at[1], at[2]);
    reach = std::max(reach, std::abs(x.dot(across) / across[c]));
    before = std::max(before, std::abs(x[c]));
  }
  if (!(reach < kWorth * before)) return false;
  for (int l = 0; l < 3; ++l) {
    if (l == c) continue;
    shear_.push_back({seen_[c], seen_[l], -across[l] / across[c] * half_[c] / half_[l]});
  }
  half_[c] *= reach + kCell;
  return true;
}

int SectionField::thickness(int axis) const {
  std::vector<int> runs;
  std::vector<char> seen(grid_.size(), 0);
  for (GridPlace i = 0; i < grid_.size(); ++i) {
    if (beyond_[i] >= 0 || seen[i] != 0) continue;
    int run = 0;
    for (GridPlace at = i; at >= 0 && beyond_[at] < 0; at = grid_.step(at, axis, 1).index) {
      seen[at] = 1;
      ++run;
    }
    runs.push_back(run);
  }
  if (runs.empty()) return 0;
  const auto quartile = runs.begin() + static_cast<long>(runs.size() / 4);
  std::nth_element(runs.begin(), quartile, runs.end());
  return *quartile;
}

// Edges are as long as asked for, and the sphere some places thick, or it has holes. With edges of
// 0.1 the vehicle's has a handle where five places are those of the median in place of the
// quartile, and none so. Even numbers, so that planes of symmetry, which the cut locus often lies
// in, pass between places.
std::array<int, 3> SectionField::fine_counts() const {
  constexpr double kThick = 5;  // places
  constexpr double kFinest = 4;
  std::array<int, 3> counts{};
  for (int k = 0; k < 3; ++k) {
    const double asked = std::sqrt(3.0) / options_.edge + 1;
    const double finer = kThick / std::max(thickness(k), 1) * kCoarse;
    counts[k] = static_cast<int>(std::ceil(std::clamp(finer, asked, kFinest * asked)));
    counts[k] += counts[k] % 2;
  }
  return counts;
}

bool SectionField::solve_finely() {
  // Where the sphere is thinner than cells its inside has handles. Then the grid is made finer, but
  // where these are many: they come from places that are not known. The vehicle's sphere in
  // theta = phi has one handle with edges of 0.3, and none on a grid that is once finer.
  constexpr int kFinerGrids = 2;
  constexpr double kFiner = 1.25;
  constexpr int kMany = 4;
  std::array<int, 3> counts = fine_counts();
  for (int finer = 0;; ++finer) {
    if (!solve_within(counts)) return false;
    const int handles =
        grid_topology(grid_, [this](GridPlace i) { return is_inside(i); }).handles();
    if (handles <= 0 || handles >= kMany || finer == kFinerGrids) return true;
    for (int& count : counts) count = 2 * static_cast<int>(std::ceil(0.5 * kFiner * count));
  }
}

bool SectionField::solve_within(const std::array<int, 3>& counts) {
  constexpr long kCheck = 100;
  constexpr int kRounds = 8;
  constexpr double kWider = 1.2;
  for (int round = 0; round < kRounds; ++round) {
    if (!solve(grid_of(counts), kCheck)) return false;
    const std::array<double, 3> reach = reaches();
    bool inside = true;
    for (int k = 0; k < 3; ++k) {
      if (reach[k] < 1 - 1.0 / counts[k]) continue;
      half_[k] *= kWider;
      inside = false;
    }
    if (inside) break;
  }
  return true;
}

}  // namespace carnot::internal
