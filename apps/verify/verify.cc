// carnot verify: every method on a scene of every kind, held against the laws it declares.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <chrono>
#include <memory>
#include <mutex>
#include <set>

#include "carnot/language/nearest.h"
#include "carnot/numerics/parallel.h"
#include "catalogue/method_table.h"
#include "catalogue/scene_choice.h"
#include "run/deferred.h"
#include "run/delivery.h"
#include "run/subcommands.h"
#include "text/numbers.h"
#include "text/progress_bar.h"
#include "verify/audit_text.h"

namespace carnot::apps {
namespace {

constexpr const char* kVerifyFooter = R"(
Without names one scene of each kind is taken, and every method that suits it. What is measured:
  measured     slope of log(error) over log(step) above round-off, at least three points; in
               parentheses where double does not resolve it: always above order 12
  M'JM-J       max-norm over max(1, |M|^2), on the manifold of holonomic constraints
  reversal     20 steps of h and of -h, and of h with p flipped where the scene allows it
  H error      largest |H - H0| (less the integral of H_t) of a long run with a large step, its
               correlation with time, the fitted drift over the run relative to it, and how much
               it grew after the first tenth
  constraints  |g(q, q')| and |h(q)|, |Dh q'| over that run
A star marks a law that is broken. Methods that do not declare a law must break it: they show that
the measurement sees something.

Examples
  carnot verify
  carnot verify vehicle heisenberg --method gauss4,radau5 --json
  carnot verify rod-skate --quick

Exit status: 0 every method behaves as declared, 1 one does not, 2 bad input, 130 interrupted.)";

constexpr long kQuickSteps = 2000;
constexpr long kFewestSteps = 1000;  // so that a tenth of them still tells
constexpr long kMostSteps = 100000000;

struct VerifyCall {
  std::vector<std::string> scenes;
  std::string methods;
  std::string steps;
  std::string threads;
  bool quick = false;
  Destination destination;
};

struct Scene {
  AuditSubject subject;
  ReferenceRun reference;
};

// What to audit: a method on a scene.
struct Task {
  const Scene* scene = nullptr;
  const Method* method = nullptr;
};

std::vector<const Method*> check_methods(const std::string& text) {
  std::vector<std::string> known;
  for (const Method& method : methods()) known.push_back(method.name);
  std::vector<const Method*> chosen;
  std::size_t begin = 0;
  while (begin <= text.size() && !text.empty()) {
    const std::size_t end = std::min(text.find(',', begin), text.size());
    const std::string name = text.substr(begin, end - begin);
    const Method* const method = find_method(name);
    if (method == nullptr) {
      refuse("--method",
             name,
             "no such method" + language::suggestion(name, known),
             fmt::format("{}", fmt::join(known, ",")));
    }
    chosen.push_back(method);
    begin = end + 1;
  }
  return chosen;
}

std::vector<Scene> check_scenes(const VerifyCall& options) {
  std::vector<Scene> scenes;
  std::set<std::string> seen;
  for (const std::string& name : options.scenes.empty() ? default_audit_scenes() : options.scenes) {
    const SceneEntry& entry = find_scene(name);
    if (!seen.insert(name).second) refuse("SCENE", name, "given twice", "each scene once");
    const auto subject = audit_subject(entry);
    if (!subject) refuse("SCENE", name, "no start was found for it", "another scene");
    scenes.push_back({*subject, {}});
    if (subject->energy_step == 0) continue;
    if (options.quick) scenes.back().subject.energy_steps = kQuickSteps;
    if (options.steps.empty()) continue;
    scenes.back().subject.energy_steps =
        parse_integer("--steps", options.steps, kFewestSteps, kMostSteps);
  }
  return scenes;
}

// In the order of the scenes, then of the methods. RATTLE without holonomic constraints is the
// midpoint composition of the same order and only taken where it is named.
std::vector<Task> all_tasks(const std::vector<Scene>& scenes,
                            const std::vector<const Method*>& named) {
  std::vector<Task> tasks;
  for (const Scene& scene : scenes) {
    const SceneEntry& entry = *scene.subject.entry;
    for (const Method& method : methods()) {
      const bool wanted = std::find(named.begin(), named.end(), &method) != named.end();
      const bool of_scene = entry.holonomic > 0 || method.family != kRattleFamily;
      if (entry.suits(method) && (wanted || (named.empty() && of_scene))) {
        tasks.push_back({&scene, &method});
      }
    }
  }
  return tasks;
}

std::vector<MethodAudit> audit_all(const std::vector<Task>& tasks,
                                   int threads,
                                   const Progress& progress) {
  std::vector<MethodAudit> rows(tasks.size());
  std::vector<double> done(tasks.size(), 0.0);
  std::mutex mutex;
  const auto work = [&](int i) {
    if (!progress(0)) return;
    const Progress of_row = [&, i](double fraction) {
      const std::lock_guard lock(mutex);
      done[i] = fraction;
      double sum = 0;
      for (const double part : done) sum += part;
      return progress(sum / static_cast<double>(done.size()));
    };
    const Task& task = tasks[i];
    rows[i] = audit_method(task.scene->subject, *task.method, task.scene->reference, of_row);
    of_row(1);
  };
  parallel_for(static_cast<int>(tasks.size()), thread_count(threads), work);
  return rows;
}

std::string verify_text(const std::vector<Scene>& scenes, const std::vector<MethodAudit>& rows) {
  std::string text;
  for (const Scene& scene : scenes) {
    std::vector<MethodAudit> own;
    for (const MethodAudit& row : rows) {
      if (row.scene == scene.subject.entry->info.name) own.push_back(row);
    }
    if (own.empty()) continue;
    text += subject_text(scene.subject) + audit_table(own);
    for (const MethodAudit& row : own) {
      if (!(row.midpoint_constraint >= 0)) continue;
      text += fmt::format("{}: |g(q_mid).(q1 - q0)/h| <= {:.2g} between its nodes\n",
                          row.method.name,
                          row.midpoint_constraint);
    }
    text += '\n';
  }
  const auto good = std::count_if(
      rows.begin(), rows.end(), [](const MethodAudit& row) { return row.as_declared(); });
  return text + fmt::format("{} of {} rows as declared\n", good, rows.size());
}

Result verify_result(const std::vector<Scene>& scenes,
                     const std::vector<MethodAudit>& rows,
                     double seconds,
                     const std::vector<std::string>& arguments) {
  std::vector<std::string> failed;
  Result result;
  Json subjects = Json::array();
  Json list = Json::array();
  for (const Scene& scene : scenes)
    subjects.push_back(subject_json(scene.subject, scene.reference));
  for (const MethodAudit& row : rows) {
    list.push_back(audit_json(row));
    if (!row.as_declared()) failed.push_back(row.method.name + " on " + row.scene);
  }
  result.delivered = failed.empty();
  if (!failed.empty()) {
    result.message = fmt::format("not as declared: {}", fmt::join(failed, ", "));
  }
  result.json = result_head(arguments);
  result.json["status"] = failed.empty() ? "as_declared" : "not_as_declared";
  result.json["message"] = result.message;
  result.json["scenes"] = subjects;
  result.json["rows"] = list;
  result.json["elapsed_seconds"] = seconds;
  result.text = [=] { return verify_text(scenes, rows); };
  return result;
}

int run_verify(const VerifyCall& options, const std::vector<std::string>& arguments) {
  const auto begin = std::chrono::steady_clock::now();
  check_table_output(options.destination);
  const auto named = check_methods(options.methods);
  std::vector<Scene> scenes = check_scenes(options);
  const int threads = parse_threads(options.threads);
  const std::vector<Task> tasks = all_tasks(scenes, named);
  if (tasks.empty()) {
    refuse("--method", options.methods, "no scene suits it", "methods that suit the scenes");
  }
  ProgressBar bar("rows", static_cast<double>(tasks.size()), options.destination.quiet);
  parallel_for(static_cast<int>(scenes.size()), thread_count(threads), [&](int i) {
    scenes[i].reference = audit_reference(scenes[i].subject);
  });
  const auto rows = audit_all(tasks, threads, bar.callback());
  const double seconds =
      std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  return deliver(verify_result(scenes, rows, seconds, arguments), options.destination);
}

}  // namespace

void add_verify(CLI::App& app, Invocation& invocation) {
  auto options = std::make_shared<VerifyCall>();
  CLI::App& verify = add_deferred_command(app, "verify");
  verify.add_option("SCENE", options->scenes, "names from `carnot scenes` (one of each kind)")
      ->type_name("");
  verify.add_option("--method", options->methods, "names from `carnot methods`, with commas (all)")
      ->type_name("NAME,...");
  verify.add_flag("--quick", options->quick, "2000 steps for the energy");
  verify.add_option("--steps", options->steps, "steps for the energy (100000; 10000 where costly)")
      ->type_name("N");
  verify
      .add_option("--threads", options->threads, "threads; the answer does not depend on it (all)")
      ->type_name("N");
  add_table_options(verify, options->destination);
  verify.footer(kVerifyFooter);
  verify.callback([options, &invocation] {
    invocation.exit_status = run_verify(*options, invocation.arguments);
  });
}

}  // namespace carnot::apps
