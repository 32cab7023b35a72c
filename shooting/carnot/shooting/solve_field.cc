#include "carnot/shooting/solve_field.h"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <limits>
#include <optional>
#include <random>
#include <set>
#include <stdexcept>
#include <string>
#include <utility>

#include "carnot/numerics/parallel.h"
#include "carnot/shooting/field/field_bytes.h"
#include "carnot/shooting/field/field_jumps.h"
#include "carnot/shooting/field/field_sample.h"
#include "carnot/shooting/field/field_searches.h"
#include "carnot/shooting/field/field_sweep.h"
#include "carnot/shooting/field/triangles.h"
#include "carnot/shooting/problem/natural_scales.h"
#include "carnot/shooting/problem/rescaled.h"

namespace carnot {

using namespace internal;

namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

bool has_potential(const BoundaryValueProblem& problem) {
  const int n = problem.dynamics.dof;
  const std::vector<double> rest(n, 0.0);
  std::vector<double> velocity(n), lambda(problem.dynamics.multipliers);
  for (const std::vector<double>& q : {problem.from, problem.to}) {
    if (problem.dynamics.evaluate(0, q, rest, velocity, lambda).hamiltonian != 0) return true;
  }
  return false;
}

void require(bool ok, const std::string& what) {
  if (!ok) throw std::invalid_argument(what);
}

void validate(const BoundaryValueProblem& problem) {
  problem.validate();
  require(problem.dynamics.has_transcription() && !has_potential(problem),
          "a field is of a scene with velocity constraints or driftless controls, and without a "
          "potential");
  require(!problem.has_free_ends(), "the ends of a field are not free");
  require(problem.limits.empty(), "a field keeps to no limits");
}

void validate(const BoundaryValueProblem& problem, const std::vector<FieldAxis>& axes) {
  constexpr double kEven = 1e-9;
  require(!axes.empty(), "a field has at least one axis");
  for (const FieldAxis& axis : axes) {
    require(axis.coordinate >= 0 && axis.coordinate < problem.dynamics.dof && !axis.values.empty(),
            "an axis of a field has a coordinate and values");
    const std::vector<double>& x = axis.values;
    const double step = x.size() > 1 ? x[1] - x[0] : 1;
    bool even = step != 0;
    for (std::size_t i = 1; i < x.size(); ++i) {
      even = even && std::abs(x[i] - x[i - 1] - step) <= kEven * std::abs(step);
    }
    require(even, "the values of an axis are not equidistant");
  }
}

FieldGrid grid_of(const BoundaryValueProblem& problem,
                  const std::vector<FieldAxis>& axes,
                  bool mod_angles) {
  constexpr double kRounded = 1e-9;
  FieldGrid grid;
  grid.to = problem.to;
  for (const FieldAxis& axis : axes) {
    FieldGrid::Axis one{axis.coordinate, axis.values, false, 0};
    if (mod_angles) one.period = problem.dynamics.info.configuration[axis.coordinate].period;
    if (one.period > 0 && axis.values.size() > 2) {
      const double step = std::abs(axis.values[1] - axis.values[0]);
      const double covered = step * static_cast<double>(axis.values.size());
      one.around = std::abs(covered - one.period) <= kRounded * one.period;
    }
    grid.axes.push_back(std::move(one));
  }
  return grid;
}

// The same problem to the first point of the grid at which the scene is regular; without any, to
// the first one.
BoundaryValueProblem to_a_regular_point(BoundaryValueProblem problem, const FieldGrid& grid) {
  for (long i = 0; i < grid.size(); ++i) {
    problem.to = grid.target(i);
    if (end_status(problem.dynamics, problem.to) == RateStatus::kOk) return problem;
  }
  problem.to = grid.target(0);
  return problem;
}

class FieldSolver {
 public:
  FieldSolver(const BoundaryValueProblem& problem,
              const FieldGrid& grid,
              const FieldOptions& options)
      : own_(problem),
        options_(options),
        own_grid_(grid),
        scales_(scales_of()),
        scaled_(rescaled(own_, scales_)),
        grid_(in_scales()),
        sweep_(scaled_, grid_),
        searches_(own_, own_grid_) {}

  Field run() {
    const auto began = std::chrono::steady_clock::now();
    try {
      if (options_.state != nullptr) read(*options_.state);
    } catch (const DamagedBytes& damaged) {
      throw DamagedState(damaged.what());
    }
    Field field;
    for (long i = 0; i < grid_.size(); ++i) field.resumed += sweep_.points().known(i) ? 1 : 0;
    field.finished = work();
    if (field.finished) collect(field);
    field.searches = course_.searches;
    field.triangles = course_.triangles;
    field.violations = course_.violations;
    field.checked = course_.checked;
    field.lower = course_.lower;
    field.bound = upper_share(course_.lower, course_.checked);
    const FieldCounts& counts = sweep_.counts();
    field.pushes = counts.pushes;
    field.improved = counts.improved;
    field.flows = counts.flows;
    field.sweeps = counts.sweeps;
    field.settled = course_.settled;
    for (const long i : sweep_.doubtful()) field.unkept += sweep_.points().known(i) ? 1 : 0;
    const std::chrono::duration<double> elapsed = std::chrono::steady_clock::now() - began;
    field.elapsed_seconds = elapsed.count();
    return field;
  }

 private:
  static constexpr std::size_t kFewestJumps = 16;
  enum class Phase : std::int8_t { kSeeds, kDoubts, kJumps, kCheck, kDone };
  // Where the work is.
  struct Course {
    Phase phase = Phase::kSeeds;
    bool spreading = false;  // before anything else
    bool settled = true;
    bool in_vain = false;                // the last sample of doubted points had hardly any less
    std::size_t at_once = kFewestJumps;  // points beyond jumps that are searched
    int round = 0;                       // of the check
    long searches = 0;
    long triangles = 0;
    long violations = 0;
    long checked = 0;
    long lower = 0;
  };

  // False where it was stopped.
  bool work() {
    while (course_.spreading || course_.phase != Phase::kDone) {
      if (!(course_.spreading ? spread() : search_on())) return false;
      keep();
    }
    return true;
  }
  bool search_on() {
    switch (course_.phase) {
      case Phase::kSeeds:
        return search_seeds();
      case Phase::kDoubts:
        return search_doubts();
      case Phase::kJumps:
        return search_jumps();
      case Phase::kCheck:
        return check();
      case Phase::kDone:
        break;
    }
    return true;
  }

  void keep() const {
    if (options_.keep) options_.keep([this](std::ostream& out) { write(out); });
  }
  // What a state must be of.
  [[nodiscard]] std::vector<double> identity() const {
    std::vector<double> numbers = own_.from;
    numbers.insert(numbers.end(), own_grid_.to.begin(), own_grid_.to.end());
    for (const FieldGrid::Axis& axis : own_grid_.axes) {
      numbers.push_back(axis.coordinate);
      numbers.push_back(axis.period);
      numbers.insert(numbers.end(), axis.values.begin(), axis.values.end());
    }
    numbers.push_back(own_.time);
    numbers.push_back(static_cast<double>(options_.search.seed));
    return numbers;
  }
  void write(std::ostream& out) const {
    ByteWriter bytes(out);
    bytes.add(identity());
    bytes.add(course_);
    bytes.add(labels_);
    sweep_.write(bytes);
    searches_.write(bytes);
    bytes.finish();
  }
  void read(std::istream& in) {
    ByteReader bytes(in);
    const std::vector<double> own = identity();
    if (bytes.take_all<double>(own.size()) != own) {
      throw DamagedState("the state is that of another field");
    }
    course_ = bytes.take<Course>();
    labels_ = bytes.take_all<Label>(static_cast<std::size_t>(course_.searches + grid_.size()));
    sweep_.read(bytes);
    searches_.read(bytes);
    bytes.finish();
  }

  // Those of the farthest corner, where the scene is regular there.
  [[nodiscard]] NaturalScales scales_of() const {
    BoundaryValueProblem farthest = own_;
    for (const FieldGrid::Axis& axis : own_grid_.axes) {
      const double start = own_.from[axis.coordinate];
      const double a = axis.values.front();
      const double b = axis.values.back();
      farthest.to[axis.coordinate] = std::abs(a - start) > std::abs(b - start) ? a : b;
    }
    const bool regular = end_status(farthest.dynamics, farthest.to) == RateStatus::kOk;
    return natural_scales(regular ? farthest : own_);
  }
  [[nodiscard]] FieldGrid in_scales() const {
    FieldGrid grid = own_grid_;
    for (std::size_t j = 0; j < grid.to.size(); ++j) grid.to[j] /= scales_.q[j];
    for (FieldGrid::Axis& axis : grid.axes) {
      for (double& x : axis.values) x /= scales_.q[axis.coordinate];
    }
    return grid;
  }

  [[nodiscard]] GeodesicOptions searching(std::uint64_t seed) {
    GeodesicOptions search = options_.search;
    search.seed = seed;
    search.progress = [this](double) { return go_on(); };
    return search;
  }
  FieldSearches::Reports search(const std::vector<long>& points, std::uint64_t seed) {
    return searches_.search(points, searching(seed), options_.threads);
  }

  bool go_on() {
    if (!stopped_ && options_.progress && !options_.progress(known_)) stopped_ = true;
    return !stopped_;
  }

  // Keeps what was found, and gives it to the sweep. Whether any of it was better than what that
  // had.
  bool take(const FieldSearches::Reports& reports) {
    searches_.keep(reports);
    bool better = false;
    for (const auto& [i, report] : reports) {
      if (report.geodesics.empty()) continue;
      const Geodesic& geodesic = report.geodesics[0];
      std::vector<double> p0 = geodesic.p0;
      for (int j = 0; j < scaled_.dynamics.dof; ++j) p0[j] /= scales_.momentum(j);
      std::vector<int> windings;
      for (const FieldGrid::Axis& axis : grid_.axes) {
        windings.push_back(geodesic.windings.empty() ? 0 : geodesic.windings[axis.coordinate]);
      }
      labels_.push_back(geodesic.label);
      better |= sweep_.seed(i, p0, windings, static_cast<int>(labels_.size()) - 1);
    }
    return better;
  }

  // From neighbour to neighbour and across the mirrors of the scene. Without mirrors 25 of 46,656
  // vehicles had more than their image, up to nine times as much.
  bool spread() {
    const Progress progress = [this](double known) {
      known_ = known;
      return go_on();
    };
    const int threads = thread_count(options_.threads);
    if (!sweep_.is_spreading()) (void)sweep_.reflect(threads);
    do {
      const Spread spread = sweep_.spread(threads, progress, [this] { keep(); });
      course_.settled = spread == Spread::kSettled;
      if (spread == Spread::kStopped || stopped_) return false;
    } while (course_.settled && sweep_.reflect(threads) > 0);
    course_.spreading = false;
    return true;
  }

  bool search_seeds() {
    constexpr long kPointsPerSeed = 2000;
    constexpr long kFewest = 8;
    constexpr long kMost = 64;
    const long size = grid_.size();
    const std::vector<long> seeds = evenly_spread_points(
        grid_, std::min(size, std::clamp(size / kPointsPerSeed, kFewest, kMost)));
    if (!improve(seeds)) return false;
    course_.phase = Phase::kDoubts;
    return true;
  }

  // What came of searches of points.
  struct Searched {
    std::size_t known = 0;  // before
    std::size_t less = 0;   // of these had less
  };
  // Searches points, each of them once, and asks for a spread where that gave news; nothing where
  // it was stopped.
  std::optional<Searched> improve(const std::vector<long>& points) {
    constexpr double kLess = 1e-6;  // relative; the model of a neighbour is not better than that
    const auto found = search(points, options_.search.seed);
    if (stopped_) return std::nullopt;
    course_.searches += static_cast<long>(points.size());
    Searched searched;
    for (const auto& [i, report] : found) {
      const double action = action_of(i);
      if (!std::isfinite(action)) continue;
      ++searched.known;
      const bool has_less =
          !report.geodesics.empty() && report.geodesics[0].action < (1 - kLess) * action;
      searched.less += has_less ? 1 : 0;
    }
    course_.spreading = take(found);
    return searched;
  }

  // Searches a sample of the points that neighbours promised less in vain, and spreads what that
  // gives, until hardly any of a sample has less; and all that nothing is known of. Of 46,656
  // vehicles 2,500 are doubted, and of each sample of 130 one or two had less: to search on cost
  // 64 s more than all the rest, which took 37 s, and changed 10 points.
  bool search_doubts() {
    constexpr std::size_t kLeast = 32;
    constexpr std::size_t kShare = 16;  // of them at once: neighbours profit from each other
    constexpr std::size_t kMost = 512;
    constexpr std::size_t kWorth = 32;  // of so many one has less, or they are not searched on
    std::vector<long> doubtful;
    for (const long i : sweep_.doubtful()) {
      const bool known = sweep_.points().known(i);
      const bool wanted = !(course_.in_vain && known);
      if (wanted && !searches_.tried(i) && !searches_.rests(i)) doubtful.push_back(i);
    }
    if (doubtful.empty()) {
      course_.phase = Phase::kJumps;
      course_.at_once = kFewestJumps;
      return true;
    }
    std::vector<long> some;
    const std::size_t at_once = std::clamp(doubtful.size() / kShare, kLeast, kMost);
    const std::size_t stride = (doubtful.size() + at_once - 1) / at_once;
    for (std::size_t k = 0; k < doubtful.size(); k += stride) some.push_back(doubtful[k]);
    const auto searched = improve(some);
    if (!searched) return false;
    if (searched->known > 0) course_.in_vain = searched->less * kWorth < searched->known;
    return true;
  }

  // Searches points that are much farther than a neighbour, the farthest first, and as long as
  // enough of them had less. Of 393 among 46,656 vehicles the first 48 all had less, up to 600
  // times less, then 16 of 64 and 14 of 128; none were wrong among 38 unicycles and 88 points of
  // the Heisenberg group, where 16 searches are made in vain.
  bool search_jumps() {
    constexpr std::size_t kMost = 512;
    constexpr std::size_t kWorth = 8;
    std::vector<double> distances(grid_.size());
    for (long i = 0; i < grid_.size(); ++i) distances[i] = std::sqrt(2 * action_of(i) * own_.time);
    std::vector<long> far = points_beyond_jumps(own_grid_, distances);
    std::erase_if(far, [this](long i) { return searches_.tried(i) || searches_.rests(i); });
    far.resize(std::min(far.size(), course_.at_once));
    const auto searched = improve(far);
    if (!searched) return false;
    if (far.empty() || searched->less * kWorth < far.size()) course_.phase = Phase::kCheck;
    course_.at_once = std::clamp(2 * searched->less, kFewestJumps, kMost);
    return true;
  }

  // A random sample, searched with another seed, and the triangles between it and neighbours. What
  // is lower is spread, and another sample drawn.
  bool check() {
    constexpr int kRounds = 4;
    const long count = std::min(options_.check, grid_.size());
    std::seed_seq sequence{options_.search.seed, options_.search.seed >> 32U, std::uint64_t{1}};
    std::mt19937_64 random(sequence);
    std::set<long> sample;
    for (int round = 0; round <= course_.round && count > 0; ++round) {
      sample.clear();
      while (static_cast<long>(sample.size()) < count) {
        sample.insert(static_cast<long>(random() % static_cast<std::uint64_t>(grid_.size())));
      }
    }
    const std::uint64_t seed = options_.search.seed + 1 + static_cast<std::uint64_t>(course_.round);
    const auto found = check({sample.begin(), sample.end()}, seed);
    if (stopped_) return false;
    if (course_.lower + course_.violations == 0 || ++course_.round == kRounds) {
      course_.phase = Phase::kDone;
    } else if (take(found)) {
      course_.spreading = true;
      course_.in_vain = false;
      course_.phase = Phase::kDoubts;
    }
    return true;
  }
  // What searches gave to these points, and to those that violate a triangle.
  FieldSearches::Reports check(const std::vector<long>& sample, std::uint64_t seed) {
    constexpr double kLower = 1e-8;
    auto found = search(sample, seed);
    const Triangles triangles = check_triangles(
        own_,
        own_grid_,
        [this](long i) { return verified_action_of(i); },
        sample,
        searching(seed),
        seed,
        options_.threads);
    if (stopped_) return found;
    course_.triangles = triangles.tried;
    course_.violations = static_cast<long>(triangles.beyond.size());
    course_.checked = static_cast<long>(sample.size());
    course_.lower = 0;
    for (const auto& [i, report] : found) {
      if (report.geodesics.empty()) continue;
      if (report.geodesics[0].action < (1 - kLower) * verified_action_of(i)) ++course_.lower;
    }
    found.merge(search(triangles.beyond, seed));
    return found;
  }

  // In the units of the scene; infinite where nothing is known.
  [[nodiscard]] double action_of(long i) const {
    if (searches_.rests(i)) return 0;
    double action = std::numeric_limits<double>::infinity();
    if (sweep_.points().known(i)) action = sweep_.points().action(i) * scales_.action;
    const FieldFind* found = searches_.find(i);
    return found == nullptr ? action : std::min(action, found->action);
  }

  // The same, with as many steps as its verification needs. A sweep takes few of them: vehicles on
  // a grid of 11 x 11 x 12 x 12 points then have actions that are good to 1e-5, which is enough to
  // tell one way from another, but no answer.
  [[nodiscard]] double verified_action_of(long i) {
    if (sweep_.points().known(i)) (void)sweep_.verify(i, scales_.q, allowed_error());
    return action_of(i);
  }

  // At the ends, in the units of the scene.
  [[nodiscard]] double allowed_error() const {
    const double largest = *std::max_element(scales_.q.begin(), scales_.q.end());
    return options_.search.absolute_tolerance.value_or(options_.search.tolerance * largest);
  }

  // Verifies all points; those that do not pass take what a search gives.
  void collect(Field& field) {
    const long size = grid_.size();
    const int n = scaled_.dynamics.dof;
    field.dof = n;
    field.action.assign(size, kNaN);
    field.p0.assign(size * n, kNaN);
    field.error.assign(size, kNaN);
    field.verification.assign(size, Verification::kSingle);
    field.label.assign(size, Label::kUnknown);
    field.reason.assign(size, Reason::kNone);
    const double allowed = allowed_error();
    const int threads = thread_count(options_.threads);
    constexpr long kBlock = 256;
    const long blocks = (size + kBlock - 1) / kBlock;
    parallel_for(static_cast<int>(blocks), threads, [&](int block) {
      if (!go_on()) return;
      for (long i = block * kBlock; i < std::min(size, (block + 1) * kBlock); ++i) {
        if (!sweep_.points().known(i)) continue;
        field.error[i] = sweep_.verify(i, scales_.q, allowed);
        const FieldPoint point = sweep_.points().point(i);
        field.action[i] = point.action * scales_.action;
        field.label[i] = labels_[point.origin];
        for (int j = 0; j < n; ++j) field.p0[i * n + j] = point.p0[j] * scales_.momentum(j);
      }
    });
    std::vector<long> poor;
    for (long i = 0; i < size; ++i) {
      const bool settled = searches_.tried(i) || searches_.rests(i);
      if (!(field.error[i] <= allowed) && !settled) poor.push_back(i);
    }
    searches_.keep(search(poor, options_.search.seed));
    course_.searches += static_cast<long>(poor.size());
    for (long i = 0; i < size; ++i) answer(i, allowed, field);
  }

  // What a search says of point i, where that is better; at the start, the path that does not move.
  void answer(long i, double allowed, Field& field) const {
    constexpr double kLower = 1e-12;
    const int n = field.dof;
    if (searches_.rests(i)) {
      field.action[i] = field.error[i] = 0;
      std::fill_n(field.p0.begin() + i * n, n, 0.0);
      field.label[i] = Label::kLocallyMinimal;  // nothing is less
      return;
    }
    const bool good = field.error[i] <= allowed;
    const FieldFind* found = searches_.find(i);
    if (found != nullptr && (!good || found->action < (1 - kLower) * field.action[i])) {
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

  const BoundaryValueProblem& own_;
  const FieldOptions& options_;
  const FieldGrid& own_grid_;
  NaturalScales scales_;
  BoundaryValueProblem scaled_;
  FieldGrid grid_;
  FieldSweep sweep_;
  FieldSearches searches_;
  std::vector<Label> labels_;  // of seeds
  Course course_;
  std::atomic<double> known_{0};
  std::atomic<bool> stopped_{false};
};

}  // namespace

Field solve_field(const BoundaryValueProblem& problem,
                  const std::vector<FieldAxis>& axes,
                  const FieldOptions& options) {
  require(static_cast<int>(problem.to.size()) == problem.dynamics.dof,
          "the target of a field has " + std::to_string(problem.to.size()) +
              " components, the scene has " + std::to_string(problem.dynamics.dof));
  validate(problem, axes);
  const FieldGrid grid = grid_of(problem, axes, options.search.mod_angles);
  const BoundaryValueProblem regular = to_a_regular_point(problem, grid);
  validate(regular);
  options.search.validate(regular);
  return FieldSolver(regular, grid, options).run();
}

}  // namespace carnot
