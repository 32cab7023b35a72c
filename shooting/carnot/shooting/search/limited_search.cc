#include "carnot/shooting/search/limited_search.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <sstream>
#include <utility>

#include "carnot/numerics/parallel.h"
#include "carnot/shooting/extremal/ranking.h"
#include "carnot/shooting/linear/round_off.h"
#include "carnot/shooting/path/relaxation.h"
#include "carnot/shooting/problem/stop.h"
#include "carnot/shooting/search/candidate_list.h"
#include "carnot/shooting/search/drift_starts.h"
#include "carnot/shooting/search/limited_finish.h"
#include "carnot/shooting/search/limited_problem.h"
#include "carnot/shooting/search/relaxed_start.h"
#include "carnot/shooting/search/starts.h"

namespace carnot::internal {
namespace {

// Whether two geodesics begin with the same momentum, as far as either is known.
bool same_start(const Geodesic& a, const Geodesic& b) {
  constexpr double kSame = 1e-7;
  double apart = 0;
  double size = 0;
  for (std::size_t j = 0; j < a.p0.size(); ++j) {
    apart = std::max({apart, std::abs(a.p0[j] - b.p0[j]), std::abs(a.from[j] - b.from[j])});
    size = std::max(size, std::abs(a.p0[j]));
  }
  return apart <= kSame * size && std::abs(a.action - b.action) <= kSame * std::abs(a.action);
}

class LimitedSearch {
 public:
  // Keeps references.
  LimitedSearch(const BoundaryValueProblem& problem,
                const GeodesicOptions& options,
                const std::vector<Geodesic>& free);

  LimitedAnswer run();

 private:
  void draw_in(Path& path) const;
  // Paths to begin with, from number `first` on; without those that drift starts do not find.
  [[nodiscard]] std::vector<std::optional<Path>> starts(int first, int count, int threads) const;
  [[nodiscard]] Start start(int i) const;
  // Solves on the grid of the path.
  [[nodiscard]] std::optional<Candidate> solve(Path path) const;
  // Takes candidates of heavier problems down, rung by rung, to the problem itself.
  void go_down(int threads);
  [[nodiscard]] std::size_t rivals(const std::vector<Candidate*>& open,
                                   const std::vector<Geodesic>& known) const;
  // Says in the answer where time was up before all of them were finished.
  void finish_candidates(int threads, LimitedAnswer& answer);
  [[nodiscard]] bool enough() const;
  [[nodiscard]] std::string infeasible() const;

  const GeodesicOptions& options_;
  const std::vector<Geodesic>& free_;
  LimitedProblem shared_;
  LimitedFinish finish_;
  std::optional<DriftStarts> drift_;
  int intervals_ = 64;
  CandidateList candidates_;
  Stop stop_;
};

LimitedSearch::LimitedSearch(const BoundaryValueProblem& problem,
                             const GeodesicOptions& options,
                             const std::vector<Geodesic>& free)
    : options_(options), free_(free), shared_(problem, free), finish_(shared_, options) {
  if (!problem.dynamics.has_transcription()) {
    drift_.emplace(shared_.unlimited, options.seed);
    intervals_ = std::max(intervals_, drift_->intervals());
  }
}

// Pulls a path towards the straight line while it is far beyond a limit that is wide enough for the
// line. Where coordinates end beyond the limit, as those of a bicycle do, paths that begin there
// stay there: 15 of 212 starts converged without this, for one target.
void LimitedSearch::draw_in(Path& path) const {
  constexpr double kFar = 1;  // of the size of the wall
  constexpr double kShare = 0.7;
  constexpr int kMost = 12;
  const auto far = [&](const double* q) {
    std::vector<double> s(shared_.walls.size());
    shared_.walls.evaluate(q, s.data(), nullptr, nullptr);
    for (int w = 0; w < shared_.walls.size(); ++w) {
      const Limit& limit = shared_.problem.limits[shared_.walls[w].limit];
      const bool closed = std::isfinite(limit.upper - limit.lower);
      if (closed && s[w] < -kFar * shared_.interior.sizes[w]) return true;
    }
    return false;
  };
  const int n = path.dof;
  const std::vector<double> first(path.configuration(0), path.configuration(1));
  const std::vector<double> last(path.q.end() - n, path.q.end());
  for (int round = 0; round < kMost; ++round) {
    bool any = false;
    for (int i = 1; i < path.intervals && !any; ++i) any = far(path.configuration(i));
    if (!any) return;
    for (int i = 1; i < path.intervals; ++i) {
      const double s = static_cast<double>(i) / path.intervals;
      for (int j = 0; j < n; ++j) {
        const double line = (1 - s) * first[j] + s * last[j];
        path.configuration(i)[j] = line + kShare * (path.configuration(i)[j] - line);
      }
    }
  }
}

Start LimitedSearch::start(int i) const {
  // What a path that is beyond a wall by its size costs, over the action of the best path without
  // limits. Measured on a vehicle whose steering angle ends at 0.3: 22 of 24 starts converge.
  constexpr double kWallRate = 100;
  // Where something is light, half of the starts begin on the rung that this grid is fine enough
  // for, and half on the problem itself, which has more extremals. Measured with 40 random targets
  // of a vehicle with beta = 0.001 whose front wheel keeps to a heading of 0.6, two seeds: 4 of 80
  // answers miss the least action. Where all begin on the problem itself 3 do, in 1.45 times the
  // time; where none does, 14 do. With beta = 0.01 none is missed by either.
  const int rung = (i + i / 2) % 2 == 0 ? shared_.ladder.rung_for(intervals_) : 0;
  Start start = make_start(shared_.ladder.on(rung), options_.seed, i, intervals_);
  draw_in(start.path);
  start.relaxation.wall_rate = kWallRate * shared_.interior.rate;
  start.relaxation.wall_sizes = shared_.interior.sizes;
  start.path.rung = rung;
  return start;
}

std::vector<std::optional<Path>> LimitedSearch::starts(int first, int count, int threads) const {
  std::vector<std::optional<Path>> paths(count);
  if (drift_) {
    parallel_for(count, threads, [&](int i) {
      if (stop_.reached()) return;
      const RelaxedStart start = drift_->start(first + i, intervals_, stop_);
      if (start.found) paths[i] = start.path;
    });
    return paths;
  }
  std::vector<Start> starts(count);
  parallel_for(count, threads, [&](int i) { starts[i] = start(first + i); });
  const std::vector<StartPack> packs = packs_of(starts, threads);
  parallel_for(static_cast<int>(packs.size()), threads, [&](int p) {
    if (stop_.reached()) return;
    std::vector<RelaxationTask> tasks;
    for (const std::size_t i : packs[p]) {
      tasks.push_back({starts[i].relaxation, &starts[i].path, {}});
    }
    relax(shared_.ladder.on(starts[packs[p].front()].path.rung), tasks);
    for (const std::size_t i : packs[p]) paths[i] = std::move(starts[i].path);
  });
  return paths;
}

std::optional<Candidate> LimitedSearch::solve(Path path) const {
  Candidate candidate;
  candidate.mu = shared_.interior.first_mu;
  LimitedPath near;
  near.path = std::move(path);
  const bool solved = finish_.solve(std::move(near), kFirstGridMu, candidate);
  return solved && std::isfinite(candidate.action) ? std::optional(std::move(candidate))
                                                   : std::nullopt;
}

void LimitedSearch::go_down(int threads) {
  const bool all = options_.all || options_.count > 1;
  for (int rung = shared_.ladder.height(); rung > 0; --rung) {
    const std::vector<std::size_t> next = candidates_.waiting_on(rung, all);
    std::vector<std::optional<Candidate>> found(next.size());
    parallel_for(static_cast<int>(next.size()), threads, [&](int i) {
      if (stop_.reached()) return;
      Candidate candidate = candidates_[next[i]];
      if (finish_.refine(candidate, kFirstGridMu)) found[i] = std::move(candidate);
    });
    for (std::size_t i = 0; i < next.size(); ++i) {
      std::optional<std::size_t> to;
      if (found[i]) to = candidates_.note(std::move(*found[i]));
      candidates_.went_down(next[i], to);
    }
  }
}

bool LimitedSearch::enough() const {
  constexpr int kOften = 3;
  return !options_.all && options_.count == 1 && candidates_.hits_of_least() >= kOften;
}

std::string LimitedSearch::infeasible() const {
  // The limit that is violated most by the best path without limits.
  std::string name = shared_.problem.limits.front().name;
  double worst = 0;
  if (!free_.empty()) {
    if (const auto path = shared_.path_along(free_.front(), intervals_)) {
      for (const Limit& limit : shared_.problem.limits) {
        for (int i = 0; i <= intervals_; ++i) {
          const double slack = limit.slack(limit.value(path->configuration(i), nullptr, nullptr));
          if (slack < worst) {
            worst = slack;
            name = limit.name;
          }
        }
      }
    }
  }
  return "no path was found that keeps to the limits; without them the best one is beyond '" +
         name + "': there may be none, or try more --starts or another --seed";
}

// How many of the open candidates are finished at least: some more than are wanted, since the grid
// may have them in another order, but no more than can be among those of least action.
std::size_t LimitedSearch::rivals(const std::vector<Candidate*>& open,
                                  const std::vector<Geodesic>& known) const {
  constexpr std::size_t kMore = 2;
  // Of the action. On the grid it was within 0.8 % of what was finished, for 183 of 183 in the
  // tests.
  constexpr double kRival = 0.1;
  const auto count = static_cast<std::size_t>(options_.count);
  if (options_.all || open.size() + known.size() <= count) return open.size();
  std::vector<double> actions;
  actions.reserve(open.size() + known.size());
  for (const Geodesic& geodesic : known) actions.push_back(geodesic.action);
  for (const Candidate* candidate : open) actions.push_back(candidate->action);
  std::sort(actions.begin(), actions.end());
  const double last = actions[count - 1];
  const double scale = std::max(std::abs(last), shared_.interior.rate * shared_.problem.time);
  const auto near = std::count_if(open.begin(), open.end(), [&](const Candidate* candidate) {
    return candidate->action <= last + kRival * scale;
  });
  return std::min(count + kMore, static_cast<std::size_t>(near));
}

// From the least on, until all rivals are finished and as many as are wanted.
void LimitedSearch::finish_candidates(int threads, LimitedAnswer& answer) {
  std::vector<Geodesic>& geodesics = answer.geodesics;
  constexpr std::size_t kMostTried = 24;
  constexpr std::size_t kAtOnce = 12;  // a second or two on one core
  const auto count = static_cast<std::size_t>(options_.count);
  std::vector<Candidate*> open = candidates_.open();
  const std::size_t wanted = rivals(open, geodesics);
  if (!options_.all && open.size() > wanted + kMostTried) open.resize(wanted + kMostTried);
  std::size_t next = 0;
  while (next < open.size() && (next < wanted || geodesics.size() < count)) {
    // The least ones are finished in any case: they are what the time was spent for. Once it is up
    // they are as many as are wanted.
    const bool late = stop_.reached();
    if (late && (next > 0 || stop_.asked())) return;
    const std::size_t at_once = late ? count : kAtOnce;
    const std::size_t round = std::min({wanted, at_once, open.size() - next});
    std::vector<std::optional<LimitedExtremal>> finished(round);
    parallel_for(static_cast<int>(round), threads, [&](int i) {
      finished[i] = finish_.finish(*open[next + i], stop_);
      if (finished[i]) finished[i]->geodesic.hits = open[next + i]->hits;
    });
    for (std::size_t i = next; i < next + round; ++i) open[i]->tried = true;
    next += round;
    for (auto& found : finished) {
      if (!found || found->geodesic.length.value_or(0) > options_.max_length) continue;
      Geodesic& geodesic = found->geodesic;
      const bool known =
          std::any_of(geodesics.begin(), geodesics.end(), [&](const Geodesic& other) {
            return same_start(other, geodesic);
          });
      if (!known) geodesics.push_back(std::move(geodesic));
    }
  }
}

LimitedAnswer LimitedSearch::run() {
  constexpr int kRound = 12;
  constexpr int kMostStarts = 96;
  LimitedAnswer answer;
  const int threads = thread_count(options_.threads);
  for (const Geodesic& geodesic : free_) {
    if (auto judged = shared_.within(geodesic)) answer.geodesics.push_back(std::move(*judged));
    // What is past a conjugate time is no minimum: something is shorter, with the limits perhaps.
    const bool best = &geodesic == &free_.front() && geodesic.label != Label::kConjugatePassed;
    if (best && !answer.geodesics.empty() && options_.count == 1 && !options_.all) return answer;
  }
  for (const Geodesic& geodesic : free_) {
    auto path = shared_.path_along(geodesic, intervals_);
    auto candidate = path ? solve(std::move(*path)) : std::nullopt;
    if (candidate) candidates_.note(std::move(*candidate));
  }
  const int most = options_.starts > 0 ? options_.starts : kMostStarts;
  const auto lacks = [&] {
    return answer.geodesics.size() < static_cast<std::size_t>(options_.count);
  };
  stop_ = Stop(options_.time_limit, [&] {
    return !options_.progress || options_.progress(static_cast<double>(answer.starts) / most);
  });
  while (answer.starts < most && (!enough() || lacks()) && !stop_.reached()) {
    const int count = std::min(kRound, most - answer.starts);
    std::vector<std::optional<Path>> paths = starts(answer.starts, count, threads);
    std::vector<std::optional<Candidate>> found(count);
    parallel_for(count, threads, [&](int i) {
      if (paths[i] && !stop_.reached()) found[i] = solve(std::move(*paths[i]));
    });
    answer.starts += count;
    for (auto& candidate : found) {
      if (!candidate) continue;
      ++answer.converged;
      candidates_.note(std::move(*candidate));
    }
    go_down(threads);
    if (enough()) finish_candidates(threads, answer);
  }
  finish_candidates(threads, answer);
  stop_.rethrow();
  answer.timed_out = stop_.late();
  answer.finished = !stop_.asked();
  rank(answer.geodesics);
  if (!options_.all && answer.geodesics.size() > static_cast<std::size_t>(options_.count)) {
    answer.geodesics.resize(options_.count);
  }
  if (answer.geodesics.empty()) {
    answer.reason = Reason::kLimitsInfeasible;
    answer.message = infeasible();
  }
  return answer;
}

}  // namespace

std::string beyond_limit_at_end(const BoundaryValueProblem& problem) {
  // An end on a wall, as the free end of another answer may be, is beyond it by a rounding.
  constexpr double kRoundings = 8;
  const int n = problem.dynamics.dof;
  std::vector<double> gradient(n);
  for (const bool start : {true, false}) {
    const std::vector<double>& q = start ? problem.from : problem.to;
    for (const Limit& limit : problem.limits) {
      const double value = limit.value(q.data(), gradient.data(), nullptr);
      bool moves = false;  // a free coordinate may mend it
      for (int j = 0; j < n; ++j) {
        const bool free = start ? problem.is_free_from(j) : problem.is_free_to(j);
        moves = moves || (free && gradient[j] != 0);
      }
      const double rounded = kRoundings * kEpsilon * std::abs(value);
      if (moves || limit.slack(value) >= -rounded) continue;
      const char* const end = start ? "start" : "target";
      std::ostringstream text;
      if (std::isnan(value)) {
        text << "the limit '" << limit.name << "' has no value at the " << end << ": move it";
      } else {
        text << "the " << end << " is beyond the limit '" << limit.name << "' by "
             << -limit.slack(value) << ": move it, or widen the limit";
      }
      return text.str();
    }
  }
  return "";
}

bool is_within_limits(const BoundaryValueProblem& problem, const Geodesic& geodesic) {
  return LimitedProblem(problem, {geodesic}).within(geodesic).has_value();
}

LimitedAnswer search_with_limits(const BoundaryValueProblem& problem,
                                 const GeodesicOptions& options,
                                 const std::vector<Geodesic>& free) {
  return LimitedSearch(problem, options, free).run();
}

}  // namespace carnot::internal
