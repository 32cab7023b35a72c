// carnot atlas: many problems, on all cores, resumable.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <chrono>
#include <filesystem>
#include <functional>
#include <memory>
#include <utility>

#include "atlas/atlas_call.h"
#include "atlas/atlas_output.h"
#include "atlas/atlas_plot.h"
#include "atlas/atlas_record.h"
#include "atlas/atlas_summary.h"
#include "atlas/crew.h"
#include "atlas/field_crew.h"
#include "atlas/field_report.h"
#include "atlas/field_state.h"
#include "atlas/journal.h"
#include "atlas/models.h"
#include "atlas/problem_list.h"
#include "carnot/shooting/distance_field.h"
#include "carnot/shooting/solve_many.h"
#include "catalogue/scene_choice.h"
#include "run/deferred.h"
#include "run/delivery.h"
#include "run/search_options.h"
#include "run/subcommands.h"
#include "text/interrupt.h"
#include "text/numbers.h"
#include "text/output_file.h"
#include "text/progress_bar.h"

namespace carnot::apps {
namespace {

constexpr const char* kAtlasFooter = R"(
Each problem is solved as `carnot geodesic` solves it, on one thread, many at a time. Number i is the
same in any order and on any number of threads. Problems come from one of
  --problems FILE.csv   columns from_NAME, to_NAME, where wanted time and set_PARAMETER; * is free
  --grid 'NAME=START:STOP:COUNT, ...'   with --from; coordinates not named keep the value of --to;
                        around a whole period the repeated end is left out
  --random N            targets as `carnot stress` draws them
The result has one row (.csv), line (.jsonl) or entry of each data set (.h5, shaped like the grid) for
each. What is done is kept in OUTPUT.journal until all is: after Ctrl-C, a kill or a full disk the same
call with --resume goes on, and writes what an undisturbed one would have written, but for `seconds`,
which --no-times leaves out. Lines may have been added to the file of problems since, or N may be more.
With --field the points of a grid are reached from their neighbours by Newton's method, and only some
are searched: thousands a second on each core. It keeps the geodesic of least action; its state is kept
in OUTPUT.journal.state, from which --resume goes on. Three figures tell how far it can be trusted:
promises of less by a neighbour that were not kept, triangles between neighbours that are violated, and
points that had less when --check of them were searched again. A FILE.field has distances alone, for
planners: DistanceField in C++ reads it.
In a build with CARNOT_MPI=ON the same call works on many ranks, under mpirun or srun.
docs/clusters.md says how, and what to expect.

Examples
  carnot atlas vehicle --problems poses.csv --output parked.csv
  carnot atlas unicycle --from 0,0,0 --grid 'x=-3:3:13, y=-3:3:13, theta=-pi:pi:12' --output field.h5
  carnot atlas unicycle --from 0,0,0 --grid 'x=-3:3:61, y=-3:3:61, theta=-pi:pi:36' --field --mod-angles --output field.h5
  carnot atlas unicycle --from 0,0,0 --grid 'x=-3:3:61, y=-3:3:61, theta=-pi:pi:36' --field --mod-angles --output left.field
  carnot atlas trailer1 --random 1000 --seed 7 --output random.jsonl

Exit status: 0 all were tried, 1 a file could not be written, 2 bad input or another call's journal,
130 interrupted: --resume goes on.)";

constexpr const char* kDistances = ".field";  // the ending of a DistanceField

class Atlas {
 public:
  Atlas(const AtlasCall& call, std::vector<std::string> arguments)
      : call_(call), arguments_(std::move(arguments)), run_(check(call.run)) {
    check_output();
    run_.samples = parse_integer("--trajectories", call.trajectories, 0, 100000);
    options_ = check(call.search, run_);
    list_ = make_problem_list(call.list, run_, limits_of(call.search.asked, run_));
    models_ = std::make_unique<Models>(call_.search, run_);
    if (call_.field) check_field();
    if (!run_.destination.plot.empty()) {
      if (list_->axes().size() < 2) {
        refuse("--plot", run_.destination.plot, "no plane to draw", "a --grid with two axes");
      }
      plot_ = std::make_unique<AtlasPlot>(run_.dynamics.info, list_->axes(), run_.dynamics.dof);
    }
    if (options_.all && has_ending(call_.output, ".h5")) {
      refuse(
          "--output", call_.output, "arrays have no room for --all", "--count K, or .csv, .jsonl");
    }
  }

  int work() {
    Ranks ranks;  // nothing of the call is refused any more
    return call_.field ? work_on_field(ranks) : work_on_list(ranks);
  }

 private:
  int work_on_list(Ranks& ranks) {
    const auto began = std::chrono::steady_clock::now();
    const int threads = run_.threads > 0 ? run_.threads : ranks.threads();
    if (!ranks.leads()) {
      const long chunk = ranks.agree(0);
      return chunk == 0 || follow(ranks, crew_work(chunk, threads)) ? kSuccess : kInterrupted;
    }
    const auto opened = open_journal(ranks);
    Journal& journal = *opened;
    const CrewWork work = crew_work(journal.words().at("chunk"), threads);
    work.drop_parts(journal);
    const long resumed = work.done(journal);
    if (!lead(ranks, work, journal, run_.destination.quiet)) {
      return interrupted_after(journal, work);
    }
    const AtlasSummary summary =
        write([&](const auto& visit) { for_records(journal, work.chunks(), visit); });
    journal.remove();
    Result result;
    result.json = summary_json(summary, resumed, journal.repaired());
    const std::chrono::duration<double> elapsed = std::chrono::steady_clock::now() - began;
    result.json["elapsed_seconds"] = elapsed.count();
    result.text = [&] { return atlas_text(result.json) + "written: " + call_.output + '\n'; };
    return deliver_with_plot(result);
  }

  int work_on_field(Ranks& ranks) {
    const std::string path = call_.output + ".journal";
    if (!ranks.leads()) {
      if (ranks.agree(0) == 0) return kSuccess;
      FieldState state(path);
      const auto interrupts = [](double) { return !interrupted(); };
      return solve_field(ranks, state, interrupts).finished ? kSuccess : kInterrupted;
    }
    const bool goes_on = call_.resume && std::filesystem::exists(path);
    const auto journal = open_journal(ranks);
    FieldState state(path);
    if (!goes_on) state.remove();
    Field field;
    try {
      ProgressBar bar("points", static_cast<double>(list_->size()), run_.destination.quiet);
      field = solve_field(ranks, state, bar.callback());
    } catch (...) {
      if (!state.exists()) journal->remove();
      throw;
    }
    if (!field.finished) {
      if (state.exists()) {
        complain("the field is not done: the same call with --resume goes on");
      } else {
        journal->remove();
      }
      return kInterrupted;
    }
    const AtlasSummary summary = write(field);
    state.remove();
    journal->remove();
    Result result;
    result.json = summary_json(summary, field.resumed, journal->repaired() + state.repaired());
    result.json["field"] = field_json(field);
    result.json["elapsed_seconds"] = field.elapsed_seconds;
    result.text = [&] {
      return atlas_text(result.json) + field_text(field) + "written: " + call_.output + '\n';
    };
    return deliver_with_plot(result);
  }

  [[nodiscard]] BoundaryValueProblem field_problem() const {
    return problem_between(run_.dynamics, problem(0).ends);
  }
  [[nodiscard]] std::vector<FieldAxis> field_axes() const {
    std::vector<FieldAxis> axes;
    for (const Axis& axis : list_->axes()) axes.push_back({axis.coordinate, axis.values});
    return axes;
  }

  Field solve_field(Ranks& ranks, FieldState& state, const Progress& progress) const {
    FieldOptions options = field_;
    options.search = options_;
    options.threads = run_.threads;
    options.progress = progress;
    return solve_together(ranks, state, field_problem(), field_axes(), std::move(options));
  }

  AtlasSummary write(const Field& field) const {
    const auto records = [&](const auto& visit) {
      for (long i = 0; i < list_->size(); ++i) visit(field_record(i, problem(i), field));
    };
    if (!has_ending(call_.output, kDistances)) return write(records);
    AtlasSummary summary;
    records([&](const Json& record) { note(record, summary); });
    NewFile file(call_.output);
    DistanceField(field_problem(), field_axes(), options_.mod_angles, field)
        .write(file.temporary());
    file.finish();
    return summary;
  }

  int deliver_with_plot(Result& result) const {
    if (plot_) result.draw = [&](const std::string& file) { return plot_->draw(file); };
    return deliver(result, run_.destination);
  }

  void check_field() {
    field_.branches = static_cast<int>(parse_integer("--branches", call_.branches, 1, 64));
    field_.check = parse_integer("--check", call_.check, 0, 1000000);
    if (list_->axes().empty()) refuse_missing("--grid", "a grid of targets for --field");
    const SearchOptions& search = call_.search;
    if (options_.all || options_.count > 1) {
      refuse("--field", "", "keeps one geodesic for each point", "--count 1");
    }
    if (search.asked.any() || !run_.dynamics.info.limits.empty()) {
      refuse("--field", "", "knows no limits", "a grid without --field");
    }
    if (list_->has_free() || run_.samples > 0) {
      refuse("--field", "", "does without free ends and --trajectories", "none of these");
    }
    if (has_ending(call_.output, kDistances)) check_distances();
  }

  void check_distances() const {
    const std::vector<Axis> axes = list_->axes();
    const bool long_enough = std::all_of(
        axes.begin(), axes.end(), [](const Axis& axis) { return axis.values.size() >= 3; });
    if (static_cast<int>(axes.size()) != run_.dynamics.dof || !long_enough) {
      refuse("--output",
             call_.output,
             "distances are between points of the whole space",
             "a --grid of all coordinates with 3 values each, or .h5, .csv, .jsonl");
    }
  }

  [[nodiscard]] Json summary_json(const AtlasSummary& summary, long resumed, long repaired) const {
    Json json = result_head(arguments_);
    json["scene"] = run_.entry->info.name;
    json["parameters"] = parameters_json(run_);
    json["method"] = run_.method.name;
    json["problems"] = list_->size();
    json["solved"] = summary.solved;
    json["failed"] = list_->size() - summary.solved;
    json["resumed"] = resumed;
    json["repaired"] = repaired;
    json["labels"] = summary.labels;
    json["reasons"] = summary.reasons;
    return json;
  }

  void check_output() const {
    if (call_.output.empty()) refuse_missing("--output", "a file ending in .h5, .csv or .jsonl");
    std::vector<std::string> endings{".h5", ".csv", ".jsonl"};
    if (call_.field) endings.emplace_back(kDistances);
    check_output_file("--output", call_.output, endings);
  }

  [[nodiscard]] AtlasProblem problem(long i) const {
    AtlasProblem problem = list_->at(i);
    problem.ends.limits = models_->of(problem.parameters)->limits;
    return problem;
  }

  // Throws where there is none; the other ranks are told, and what a chunk is.
  std::unique_ptr<Journal> open_journal(Ranks& ranks) const {
    try {
      auto journal = std::make_unique<Journal>(
          call_.output + ".journal", journal_call(call_, run_, *list_), call_.resume);
      (void)ranks.agree(journal->words().at("chunk").get<long>());
      return journal;
    } catch (...) {
      (void)ranks.agree(0);
      throw;
    }
  }

  // On so many threads of this process.
  [[nodiscard]] CrewWork crew_work(long chunk, int threads) const {
    return {
        list_->size(),
        chunk,
        [this, chunk, threads](const auto& next, const auto& hand_in, const Progress& progress) {
          ManyOptions options;
          options.each = options_;
          options.threads = threads;
          options.chunk = chunk;
          options.next = next;
          options.progress = progress;
          return solve(options, hand_in);
        }};
  }

  // Hands in the records of chunks. False when stopped.
  bool solve(const ManyOptions& options,
             const std::function<void(long chunk, const std::string& text)>& hand_in) const {
    ManyProblems problems;
    problems.count = list_->size();
    problems.at = [&](long i) {
      const AtlasProblem one = problem(i);
      const Dynamics& dynamics = models_->of(one.parameters)->dynamics;
      check_ends(one.ends, dynamics);
      return problem_between(dynamics, one.ends);
    };
    return solve_many(problems, options, [&](long first, std::span<const GeodesicReport> reports) {
      std::string text;
      for (std::size_t i = 0; i < reports.size(); ++i) {
        const long index = first + static_cast<long>(i);
        text += json_line(atlas_record(index, problem(index), list_->parameters(), reports[i]));
        text += '\n';
      }
      hand_in(first / options.chunk, text);
      return true;
    });
  }

  int interrupted_after(Journal& journal, const CrewWork& work) const {
    const long known = work.done(journal);
    if (known == 0) journal.remove();
    complain(fmt::format("{} of {} problems are done{}",
                         known,
                         list_->size(),
                         known > 0 ? ": the same call with --resume goes on" : ""));
    return kInterrupted;
  }

  // `records(visit)` visits all of them, in the order of the problems.
  template <class Records>
  AtlasSummary write(const Records& records) const {
    AtlasLayout layout;
    layout.coordinates = coordinate_names(*run_.entry);
    layout.axes = list_->axes();
    layout.parameters = list_->parameters();
    layout.problems = list_->size();
    layout.multipliers = run_.dynamics.multipliers;
    layout.count = options_.all ? 0 : options_.count;
    layout.samples = run_.samples;
    layout.limited = !problem(0).ends.limits.empty();
    layout.times = !call_.no_times;
    layout.free_ends = list_->has_free();
    layout.head = identity_of(call_, run_, list_->identity());
    AtlasSummary summary;
    NewFile file(call_.output);
    {
      const auto writer = make_atlas_writer(file.temporary(), call_.output, layout);
      records([&](const Json& record) {
        note(record, summary);
        writer->add(record);
      });
      writer->finish();
    }
    file.finish();
    return summary;
  }

  void note(const Json& record, AtlasSummary& summary) const {
    summary.add(record);
    if (plot_) plot_->add(record);
  }

  template <class Visit>
  static void for_records(const Journal& journal, long chunks, const Visit& visit) {
    for (long k = 0; k < chunks; ++k) {
      const std::string text = journal.read(k);
      for (std::size_t at = 0; at < text.size();) {
        const std::size_t end = text.find('\n', at);
        visit(Json::parse(text.begin() + static_cast<std::ptrdiff_t>(at),
                          text.begin() + static_cast<std::ptrdiff_t>(end)));
        at = end + 1;
      }
    }
  }

  const AtlasCall& call_;
  std::vector<std::string> arguments_;
  Run run_;
  GeodesicOptions options_;
  FieldOptions field_;  // `branches` and `check` of it
  std::unique_ptr<ProblemList> list_;
  std::unique_ptr<Models> models_;
  std::unique_ptr<AtlasPlot> plot_;  // where there is to be one
};

}  // namespace

void add_atlas(CLI::App& app, Invocation& invocation) {
  auto call = std::make_shared<AtlasCall>();
  call->run.searches = true;
  CLI::App& atlas = add_deferred_command(app, "atlas");
  add_model_options(atlas, call->run);
  const auto add = [&](const char* name, std::string& value, const char* type, const char* help) {
    atlas.add_option(name, value, help)->type_name(type);
  };
  add("--problems", call->list.problems, "FILE", "problems, one a line, in a .csv file");
  add("--grid", call->list.grid, "'NAME=A:B:N, ...'", "targets on a grid");
  add("--random", call->list.random, "N", "random targets");
  add("--from", call->list.from, "Q0", "configuration at the start, where it is always the same");
  add("--to", call->list.to, "Q1", "configuration at the end, of coordinates not told elsewhere");
  add("--time", call->list.time, "T", "how long it takes, > 0 (1)");
  add_search_options(atlas, call->search);
  add_effort_options(atlas, call->run);
  add("--trajectories",
      call->trajectories,
      "N",
      "times of each path to keep, both ends included (0)");
  add("--output", call->output, "FILE", "the result: .csv, .jsonl, .h5, and .field with --field");
  add("--plot", call->run.destination.plot, "FILE", "slices of a grid as a .png, .svg or .pdf");
  atlas.add_flag("--field", call->field, "least actions of a grid from neighbour to neighbour");
  add("--branches",
      call->branches,
      "K",
      "geodesics that a field keeps for each point, to find the least in the end (1)");
  add("--check", call->check, "N", "points of a field that are searched once more (100)");
  atlas.add_flag("--resume", call->resume, "go on where the same call was ended");
  atlas.add_flag("--no-times", call->no_times, "leave out seconds, the only thing that differs");
  atlas.add_flag("--json", call->run.destination.json, "print a summary as one JSON object");
  atlas.add_flag("--quiet", call->run.destination.quiet, "no progress bar");
  atlas.footer(kAtlasFooter);
  atlas.callback(
      [call, &invocation] { invocation.exit_status = Atlas(*call, invocation.arguments).work(); });
}

}  // namespace carnot::apps
