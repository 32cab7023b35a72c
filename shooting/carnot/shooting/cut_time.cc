#include "carnot/shooting/cut_time.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <stdexcept>
#include <utility>

#include "carnot/shooting/extremal/conjugate_times.h"
#include "carnot/shooting/find_geodesics.h"
#include "carnot/shooting/problem/scales.h"
#include "carnot/shooting/problem/stop.h"
#include "carnot/shooting/rays/meeting.h"
#include "carnot/shooting/rays/pair_symmetry.h"
#include "carnot/shooting/rays/ray.h"
#include "carnot/shooting/shoot/end_point.h"

namespace carnot {

using namespace internal;

namespace {

// A path that is shorter than the extremal by less, relative, is as long: ends of searches are good
// to 1e-10.
constexpr double kAsLong = 1e-9;

const char* name_of(PairSymmetry symmetry) {
  constexpr std::array kNames{"none", "mirror", "reversal", "mirror and reversal"};
  return kNames[static_cast<int>(symmetry)];
}

// All times are those of unit speed.
class CutSearch {
 public:
  CutSearch(const Dynamics& dynamics,
            const std::vector<double>& from,
            std::vector<double> p,
            double speed,
            const CutTimeOptions& options)
      : ray_(dynamics, from, std::move(p)),
        options_(options),
        stop_(options.time_limit, [this] { return !options_.progress || options_.progress(0); }),
        scale_(start_scales({dynamics, from, from}).radian) {
    horizon_ = options.max_time > 0 ? options.max_time * speed : natural_horizon();
  }

  void run() {
    find_conjugate_time();
    if (bracket()) {
      narrow();
    } else if (go_on() && conjugate_) {
      take_neighbour();
      if (!cut_) label_ = "conjugate";
      if (!cut_) cut_ = conjugate_;
    }
    if (partner_) label_ = name_of(symmetry_of_pair(ray_, *cut_, *partner_));
    stop_.rethrow();
  }

  // In the times of the extremal as it was given.
  [[nodiscard]] CutTime result(double speed) const {
    CutTime cut;
    cut.message = message_;
    cut.max_time = horizon_ / speed;
    cut.error = error_ / speed;
    cut.searches = searches_;
    cut.label = label_;
    if (cut_) cut.cut_time = *cut_ / speed;
    if (conjugate_) cut.conjugate_time = *conjugate_ / speed;
    if (partner_) {
      cut.partner_p0 = partner_->p;
      for (double& x : *cut.partner_p0) x *= speed;
    }
    if (stop_.late()) cut.message = "the time limit was up before the cut time was known";
    cut.status = cut.message.empty() ? CutStatus::kConverged : CutStatus::kNotConverged;
    if (stop_.asked()) cut.status = CutStatus::kInterrupted;
    if (stop_.asked()) cut.message = "interrupted";
    return cut;
  }

 private:
  // See CutTimeOptions. The velocity turns at the rate |dv/dt| / |v|, by differences. Coordinates
  // that grow in the meantime only add to it, so it is the least rate that counts.
  [[nodiscard]] double natural_horizon() const {
    constexpr double kTurns = 16;       // radians of the velocity; a cut is after a turn or two
    constexpr double kStraight = 1e-3;  // what turns less in a natural length is straight
    constexpr int kSamples = 64;
    const double longest = kNaturalHorizon * scale_;
    const double h = longest / kSamples;
    const long steps = ray_.enough_steps(h);
    std::vector<double> z = ray_.start();
    double turns = 0;
    Motion before = motion_at(ray_.dynamics(), z.data());
    for (int i = 0; i < kSamples; ++i) {
      if (!ray_.dynamics().flow(StepPlan::equal(i * h, h, steps), z).completed()) break;
      const Motion after = motion_at(ray_.dynamics(), z.data());
      const double turned = (after.velocity - before.velocity).norm() / after.velocity.norm();
      const double rate = turned / h;
      if (rate * scale_ > kStraight) turns = turns > 0 ? std::min(turns, rate) : rate;
      before = after;
    }
    return turns > 0 ? std::max(longest, kTurns / turns) : longest;
  }

  bool go_on() { return !stop_.reached(); }

  // The first one up to the horizon, on stretches that double: to locate it costs in proportion to
  // the stretch.
  void find_conjugate_time() {
    constexpr double kFirst = 1.0 / 64;
    ConjugateTimesOptions first;
    first.most = 1;
    for (double t = std::min(horizon_, kFirst * scale_); go_on(); t = std::min(2 * t, horizon_)) {
      const long steps = ray_.enough_steps(t);
      const BoundaryValueProblem problem = ray_.problem(t, steps);
      const Knots knots = knots_of(problem, ray_.p(), 1, steps);
      const ConjugateTimes times = conjugate_times(problem, knots, steps, first);
      // An abnormal extremal has many momenta: what is conjugate with one need not be so with
      // others.
      const bool abnormal = times.corank.value_or(0) > 0;
      if (times.known && !abnormal && !times.times.empty()) {
        conjugate_ = times.times.front();
        return;
      }
      if (t >= horizon_) return;
    }
  }

  // Extremals to where the ray is at t, least action first; the ray is one of them where it was
  // found. Where what is found is longer than the ray, the search was too short and is repeated.
  std::vector<Rival> search(double t) {
    constexpr int kAttempts = 3;
    const long steps = ray_.enough_steps(t);
    const BoundaryValueProblem problem = ray_.problem(t, steps);
    GeodesicOptions search;
    search.samples = 0;
    search.abnormal = false;
    search.mod_angles = options_.mod_angles;
    search.threads = options_.threads;
    search.progress = [this](double) { return go_on(); };
    std::vector<Rival> found;
    const auto add = [&](const BoundaryValueProblem& to, const std::vector<double>& signs) {
      search.seed = options_.seed + static_cast<std::uint64_t>(searches_++);
      search.time_limit = std::max(1e-3, stop_.left());
      for (const Geodesic& geodesic : find_geodesics(to, search).geodesics) {
        Rival rival{geodesic.p0, std::vector<double>(ray_.from().size(), 0.0), t, signs};
        for (std::size_t j = 0; j < geodesic.windings.size(); ++j) {
          rival.offset[j] = geodesic.windings[j] * ray_.dynamics().info.configuration[j].period;
        }
        found.push_back(std::move(rival));
      }
    };
    for (int attempt = 0; attempt < kAttempts && go_on(); ++attempt) {
      add(problem, {});
      const auto as_short = [&](const Rival& rival) { return excess_of(ray_, rival) <= kAsLong; };
      if (std::any_of(found.begin(), found.end(), as_short)) break;
    }
    if (!options_.signs.empty() && go_on()) {
      BoundaryValueProblem there = problem;
      for (std::size_t j = 0; j < there.to.size(); ++j) there.to[j] *= options_.signs[j];
      add(there, options_.signs);
    }
    return found;
  }

  [[nodiscard]] bool has_shorter(const std::vector<Rival>& rivals) const {
    return std::any_of(rivals.begin(), rivals.end(), [&](const Rival& rival) {
      return excess_of(ray_, rival) < -kAsLong;
    });
  }

  // Finds a time low_ at which the ray is the shortest, and a time high_ at which it is not.
  bool bracket() {
    // Just before the conjugate time: what is shorter there is not one of its neighbours.
    constexpr double kBefore = 1e-4;
    const double last = conjugate_ ? (1 - kBefore) * *conjugate_ : horizon_;
    // Near a conjugate time a search tells at once. Elsewhere rivals that cross early are easier to
    // find early.
    constexpr double kNear = 8;
    double t = last <= kNear * scale_ ? last : std::min(last, scale_);
    while (go_on()) {
      if (look_at(t)) return true;
      if (t >= last) break;
      t = 2 * t >= last ? last : 2 * t;
    }
    return false;
  }

  // Sets cut_ and partner_ to the first meeting before `end` with one of the rivals.
  bool nearest_meeting(double end) {
    bool better = false;
    for (const Rival& rival : rivals_) {
      const long steps = ray_.enough_steps(rival.t);
      const auto meeting = meet(ray_, rival, steps);
      constexpr double kSameTime = 1e-10;  // both are the same to what is known of them
      if (!meeting || !(meeting->rival.t < (1 - kSameTime) * end)) continue;
      end = meeting->rival.t;
      cut_ = end;
      partner_ = meeting->rival;
      error_ = meeting->error;
      better = true;
    }
    return better;
  }

  // Where nothing is shorter before the conjugate time, a neighbour may be as long.
  void take_neighbour() {
    const auto meeting = meet_neighbours(ray_, *conjugate_);
    if (!meeting) return;
    cut_ = meeting->rival.t;
    partner_ = meeting->rival;
    error_ = meeting->error;
  }

  // From a bracket to the cut time. What crosses the ray before is shorter at the cut time and, if
  // it crosses early, some time before.
  void narrow() {
    // The bracket is halved where nothing meets the ray: after so many rounds it is 4,096 times as
    // short, and another search would tell nothing new.
    constexpr int kRounds = 12;
    constexpr double kBefore = 1e-2;
    for (int round = 0; round < kRounds && go_on(); ++round) {
      if (!nearest_meeting(high_)) {
        const double middle = 0.5 * (low_ + high_);
        look_at(middle);
        continue;
      }
      if (look_at((1 - kBefore) * *cut_) || look_at(*cut_)) continue;
      return;
    }
    cut_.reset();
    partner_.reset();
    if (go_on()) message_ = "what is shorter could not be followed back to the cut time";
  }

  // Whether something is shorter than the ray at time t; the bracket is narrowed.
  bool look_at(double t) {
    std::vector<Rival> rivals = search(t);
    const bool shorter = has_shorter(rivals);
    (shorter ? high_ : low_) = t;
    if (shorter) rivals_ = std::move(rivals);
    return shorter;
  }

  Ray ray_;
  const CutTimeOptions& options_;
  Stop stop_;
  double scale_;  // a natural length
  double horizon_ = 0;
  double low_ = 0;
  double high_ = 0;
  std::vector<Rival> rivals_;  // what the last search found
  std::optional<double> conjugate_;
  std::optional<double> cut_;
  std::optional<Rival> partner_;
  double error_ = 0;
  std::string label_ = "none-found";
  std::string message_;
  int searches_ = 0;
};

// Whether the velocity at S z is S times the velocity at z, but for round-off.
bool moves_alike(const Dynamics& dynamics,
                 const std::vector<double>& z,
                 const std::vector<double>& signs) {
  constexpr double kRounding = 1e-10;
  const std::size_t n = signs.size();
  std::vector<double> there = z;
  for (std::size_t j = 0; j < 2 * n; ++j) there[j] *= signs[j % n];
  const Motion one = motion_at(dynamics, z.data());
  Eigen::VectorXd other = motion_at(dynamics, there.data()).velocity;
  for (std::size_t j = 0; j < n; ++j) other[static_cast<Eigen::Index>(j)] *= signs[j];
  return (one.velocity - other).norm() <= kRounding * one.velocity.norm();
}

}  // namespace

void check_signs(const Dynamics& dynamics,
                 const std::vector<double>& from,
                 const std::vector<double>& signs) {
  if (signs.empty()) return;
  const std::size_t n = from.size();
  if (signs.size() != n) throw std::invalid_argument("signs need one number for each coordinate");
  std::vector<double> p(n);
  for (std::size_t j = 0; j < n; ++j) {
    if (std::abs(signs[j]) != 1) throw std::invalid_argument("signs must be 1 or -1");
    p[j] = std::cos(1.0 + static_cast<double>(j));
  }
  // Signs may be right at the start, which is a special place, or for special momenta. So a ray
  // that moves in all coordinates is tried, at its start and where it has moved on.
  const double speed = speed_of(dynamics, from, p);
  for (double& x : p) x /= speed;
  const Ray ray(dynamics, from, p);
  for (const std::vector<double>& z : {ray.start(), ray.follow(1).z}) {
    if (z.empty() || moves_alike(dynamics, z, signs)) continue;
    throw std::invalid_argument("the scene is another one where the signs are changed");
  }
}

CutTime cut_time(const Dynamics& dynamics,
                 const std::vector<double>& from,
                 const std::vector<double>& p0,
                 const CutTimeOptions& options) {
  const auto began = std::chrono::steady_clock::now();
  if (!(options.max_time >= 0 && std::isfinite(options.max_time))) {
    throw std::invalid_argument("max_time must be finite and >= 0");
  }
  if (!(options.time_limit > 0)) throw std::invalid_argument("time_limit must be > 0");
  const double speed = validated_speed(dynamics, from, p0);
  check_signs(dynamics, from, options.signs);
  std::vector<double> p = p0;
  for (double& x : p) x /= speed;
  CutSearch search(dynamics, from, std::move(p), speed, options);
  search.run();
  CutTime cut = search.result(speed);
  const std::chrono::duration<double> elapsed = std::chrono::steady_clock::now() - began;
  cut.elapsed_seconds = elapsed.count();
  return cut;
}

}  // namespace carnot
