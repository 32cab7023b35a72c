#include "atlas/problem_list.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "atlas/problem_file.h"
#include "carnot/language/nearest.h"
#include "catalogue/scene_choice.h"
#include "run/random_target.h"
#include "text/numbers.h"

namespace carnot::apps {
namespace {

constexpr long kMostProblems = 1000000000;
constexpr long kMostOnAxis = 10000000;  // 80 MB

std::string trimmed(const std::string& text) {
  const std::size_t first = text.find_first_not_of(" \t\n");
  if (first == std::string::npos) return "";
  return text.substr(first, text.find_last_not_of(" \t\n") - first + 1);
}

// The ends that --from and --to give, where they do; zeros elsewhere.
Ends given_ends(const ListOptions& options, const Run& run) {
  const std::vector<std::string> names = coordinate_names(*run.entry);
  const std::vector<std::optional<double>> zeros(names.size(), 0.0);
  Ends ends = ends_of(options.from.empty() ? zeros : parse_end("--from", options.from, names),
                      options.to.empty() ? zeros : parse_end("--to", options.to, names));
  ends.time = parse_positive("--time", options.time);
  return ends;
}

// ---- a grid

// NAME=START:STOP:COUNT.
Axis parse_axis(const std::string& grid, const std::string& text, const SceneInfo& info) {
  constexpr const char* kAccepted =
      "'NAME=START:STOP:COUNT, ...' with coordinates' names, such as 'x=-3:3:61, theta=-pi:pi:72'";
  constexpr double kRounded = 1e-12;
  const std::size_t equals = text.find('=');
  if (equals == std::string::npos) refuse("--grid", grid, "an axis without '='", kAccepted);
  Axis axis;
  axis.name = trimmed(text.substr(0, equals));
  std::vector<std::string> names;
  for (const Coordinate& coordinate : info.configuration) names.push_back(coordinate.name);
  const auto found = std::find(names.begin(), names.end(), axis.name);
  if (found == names.end()) {
    refuse("--grid",
           grid,
           fmt::format(
               "there is no coordinate '{}'{}", axis.name, language::suggestion(axis.name, names)),
           kAccepted);
  }
  axis.coordinate = static_cast<int>(found - names.begin());
  const Coordinate& coordinate = info.configuration[axis.coordinate];
  axis.unit = coordinate.unit;
  const std::vector<std::string> parts = split(text.substr(equals + 1), ':');
  if (parts.size() != 3) refuse("--grid", grid, "not START:STOP:COUNT", kAccepted);
  const double start = parse_real("--grid", trimmed(parts[0]));
  const double stop = parse_real("--grid", trimmed(parts[1]));
  if (!std::isfinite(stop - start)) refuse("--grid", grid, "too wide an axis", kAccepted);
  const long count = parse_integer("--grid", trimmed(parts[2]), 1, kMostOnAxis);
  // Around a circle the last point would be the first one again.
  const bool around =
      coordinate.period > 0 &&
      std::abs(std::abs(stop - start) - coordinate.period) < kRounded * coordinate.period;
  const double intervals = static_cast<double>(around ? count : std::max(1L, count - 1));
  for (long i = 0; i < count; ++i) {
    const bool last = !around && i == count - 1 && count > 1;
    axis.values.push_back(last ? stop
                               : start + static_cast<double>(i) * (stop - start) / intervals);
  }
  return axis;
}

class GridList : public ProblemList {
 public:
  GridList(const ListOptions& options, const Run& run)
      : ends_(given_ends(options, run)), parameters_(run.parameters) {
    if (options.from.empty()) refuse_missing("--from", end_accepted(coordinate_names(*run.entry)));
    const SceneInfo& info = run.dynamics.info;
    std::vector<bool> named(run.dynamics.dof, !options.to.empty());
    double size = 1;
    for (const std::string& text : split(options.grid, ',')) {
      axes_.push_back(parse_axis(options.grid, text, info));
      const Axis& axis = axes_.back();
      for (std::size_t i = 0; i + 1 < axes_.size(); ++i) {
        if (axes_[i].name == axis.name) {
          refuse("--grid", options.grid, axis.name + " is given twice", "each coordinate once");
        }
      }
      named[axis.coordinate] = true;
      ends_.free_to[axis.coordinate] = false;
      size *= static_cast<double>(axis.values.size());
      if (size > static_cast<double>(kMostProblems)) {
        refuse("--grid", options.grid, "too many points", fmt::format("at most {}", kMostProblems));
      }
    }
    const auto missing = std::find(named.begin(), named.end(), false);
    if (missing != named.end()) {
      const auto& coordinate = info.configuration[missing - named.begin()];
      refuse("--grid",
             options.grid,
             fmt::format("nothing says what {} is at the target", coordinate.name),
             "an axis for it, or --to");
    }
    size_ = static_cast<long>(size);
  }

  [[nodiscard]] long size() const override { return size_; }
  [[nodiscard]] std::vector<Axis> axes() const override { return axes_; }
  [[nodiscard]] bool has_free() const override { return apps::has_free(ends_); }
  [[nodiscard]] AtlasProblem at(long i) const override {
    AtlasProblem problem{ends_, parameters_};
    for (std::size_t a = axes_.size(); a-- > 0;) {
      const auto count = static_cast<long>(axes_[a].values.size());
      problem.ends.to[axes_[a].coordinate] = axes_[a].values[i % count];
      i /= count;
    }
    return problem;
  }
  [[nodiscard]] Json identity() const override {
    Json axes = Json::object();
    for (const Axis& axis : axes_) {
      axes[axis.name] = {axis.values.front(), axis.values.back(), axis.values.size()};
    }
    return {{"from", end_json(ends_.from, ends_.free_from)},
            {"to", end_json(ends_.to, ends_.free_to)},
            {"time", ends_.time},
            {"grid", axes}};
  }

 private:
  Ends ends_;
  ParameterValues parameters_;
  std::vector<Axis> axes_;
  long size_ = 0;
};

// ---- random targets

class RandomList : public ProblemList {
 public:
  RandomList(const ListOptions& options, const Run& run, std::vector<Limit> limits)
      : ends_(given_ends(options, run)),
        fixed_start_(!options.from.empty()),
        size_(parse_integer("--random", options.random, 1, kMostProblems)),
        dynamics_(run.dynamics),
        limits_(std::move(limits)),
        parameters_(run.parameters),
        seed_(run.seed) {
    if (!options.to.empty()) refuse("--to", options.to, "given besides --random", "one of the two");
  }

  [[nodiscard]] long size() const override { return size_; }
  [[nodiscard]] bool has_free() const override { return apps::has_free(ends_); }
  [[nodiscard]] AtlasProblem at(long i) const override {
    AtlasProblem problem{ends_, parameters_};
    const int number = static_cast<int>(i);
    if (dynamics_.holonomic > 0 && !fixed_start_) {
      problem.ends.from = random_target(dynamics_, ~seed_, number);
    }
    problem.ends.to = trial_target(dynamics_, limits_, seed_, number);
    return problem;
  }
  [[nodiscard]] Json identity() const override {
    Json json{{"random", size_}, {"time", ends_.time}};
    if (fixed_start_) json["from"] = end_json(ends_.from, ends_.free_from);
    return json;
  }
  [[nodiscard]] Json identity_then(const Json& there) const override {
    Json json = identity();
    const Json size = there.value("random", Json(nullptr));
    if (size.is_number_integer() && size < size_) json["random"] = size;
    return json;
  }

 private:
  Ends ends_;
  bool fixed_start_;
  long size_;
  Dynamics dynamics_;
  std::vector<Limit> limits_;
  ParameterValues parameters_;
  std::uint64_t seed_;
};

}  // namespace

std::unique_ptr<ProblemList> make_problem_list(const ListOptions& options,
                                               const Run& run,
                                               const std::vector<Limit>& limits) {
  constexpr const char* kAccepted = "one of --problems FILE.csv, --grid '...' and --random N";
  const auto given = static_cast<int>(!options.problems.empty()) +
                     static_cast<int>(!options.grid.empty()) +
                     static_cast<int>(!options.random.empty());
  if (given == 0) refuse_missing("--problems", kAccepted);
  if (given > 1) {
    refuse(options.grid.empty() ? "--random" : "--grid",
           options.grid.empty() ? options.random : options.grid,
           "given besides another list of problems",
           kAccepted);
  }
  if (!options.grid.empty()) return std::make_unique<GridList>(options, run);
  if (!options.random.empty()) return std::make_unique<RandomList>(options, run, limits);
  return std::make_unique<ProblemFile>(options, run, given_ends(options, run));
}

}  // namespace carnot::apps
