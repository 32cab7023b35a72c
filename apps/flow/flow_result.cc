#include "flow/flow_result.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "carnot/plots/figure.h"
#include "text/csv_text.h"
#include "text/output_file.h"
#include "text/text_table.h"

namespace carnot::apps {
namespace {

struct EndPoint {
  std::vector<double> q;
  std::vector<double> p;
  std::vector<double> lambda;
  double hamiltonian = 0;
};

EndPoint end_point(const FlowRequest& request, const FlowOutcome& outcome) {
  const Dynamics& dynamics = request.run.dynamics;
  EndPoint end;
  end.q.assign(outcome.z.begin(), outcome.z.begin() + dynamics.dof);
  end.p.assign(outcome.z.begin() + dynamics.dof, outcome.z.end());
  end.lambda.assign(dynamics.multipliers, std::numeric_limits<double>::quiet_NaN());
  const Trajectory& trajectory = outcome.summary.trajectory;
  if (outcome.completed() && !trajectory.t.empty()) {
    end.lambda = trajectory.lambda.back();  // on the branch of the flow
    end.hamiltonian = trajectory.hamiltonian.back();
    return end;
  }
  std::vector<double> q_dot(dynamics.dof);
  end.hamiltonian =
      dynamics.evaluate(outcome.summary.report.time_reached, end.q, end.p, q_dot, end.lambda)
          .hamiltonian;
  return end;
}

// Values of the quantities that the scene calls worth reporting.
std::vector<std::pair<std::string, double>> extremes(const SceneInfo& info,
                                                     const Trajectory& trajectory) {
  std::vector<std::pair<std::string, double>> values;
  for (const Extreme& extreme : info.extremes) {
    double largest = 0;
    for (const auto& q : trajectory.q) {
      largest = std::max(largest, std::abs(extreme.value(q.data())));
    }
    values.emplace_back(extreme.name, largest);
  }
  return values;
}

Json matrix_json(const std::vector<double>& m, int size) {
  Json rows = Json::array();
  for (int i = 0; i < size; ++i) {
    rows.push_back(std::vector<double>(m.begin() + i * size, m.begin() + (i + 1) * size));
  }
  return rows;
}

Json flow_json(const FlowRequest& request,
               const FlowOutcome& outcome,
               const std::vector<std::string>& arguments) {
  const Run& run = request.run;
  const EndPoint end = end_point(request, outcome);
  Json json = result_head(arguments);
  json["scene"] = run.entry->info.name;
  json["parameters"] = parameters_json(run);
  json["method"] = run.method.name;
  json["time"] = request.time;
  json["step"] = outcome.plan.count > 0 ? Json(outcome.plan.step) : Json(nullptr);
  json["steps"] = outcome.summary.report.steps;
  json["status"] = outcome.completed() ? "completed" : "failed";
  json["message"] = outcome.message;
  json["time_reached"] = outcome.summary.report.time_reached;
  json["q"] = end.q;
  json["p"] = end.p;
  json["lambda"] = end.lambda;
  json["hamiltonian"] = end.hamiltonian;
  json["action"] = outcome.summary.action;
  json["energy_drift"] = outcome.summary.energy_drift;
  if (!run.dynamics.autonomous) {
    json["hamiltonian_conserved"] = false;
    json["energy_balance_error"] = outcome.summary.energy_balance;
  }
  json["constraint_error"] = outcome.summary.constraint_error;
  if (run.dynamics.holonomic > 0) json["holonomic_error"] = outcome.summary.holonomic_error;
  json["evaluations"] = outcome.summary.report.evaluations;
  json["elapsed_seconds"] = outcome.elapsed_seconds;
  if (!run.no_trajectory) json["trajectory"] = trajectory_json(outcome.summary.trajectory);
  if (outcome.tangent) {
    json["tangent"] = matrix_json(outcome.tangent->m, 2 * run.dynamics.dof);
    json["symplecticity_defect"] = outcome.tangent->defect;
    json["symplecticity_defect_relative"] = outcome.tangent->relative_defect;
  }
  return json;
}

std::string flow_text(const FlowRequest& request, const FlowOutcome& outcome) {
  const Run& run = request.run;
  const FlowReport& report = outcome.summary.report;
  const EndPoint end = end_point(request, outcome);
  std::string title = fmt::format("{}: {} steps of {} to t = {:g}, {}\n\n",
                                  run.entry->info.name,
                                  report.steps,
                                  run.method.name,
                                  report.time_reached,
                                  outcome.completed() ? "completed" : "failed");
  constexpr int kDigits = 15;
  std::vector<std::vector<std::string>> rows{
      {"q", text_vector(end.q, kDigits)},
      {"p", text_vector(end.p, kDigits)},
      {"hamiltonian", text_number(end.hamiltonian, kDigits)},
      {"energy drift", text_number(outcome.summary.energy_drift, 3)},
      {"constraint error", text_number(outcome.summary.constraint_error, 3)},
      {"action", text_number(outcome.summary.action, kDigits)},
      {"step", text_number(outcome.plan.step)},
      {"evaluations", std::to_string(report.evaluations)},
      {"seconds", text_number(outcome.elapsed_seconds, 3)}};
  if (!end.lambda.empty()) {
    rows.insert(rows.begin() + 2, {"lambda", text_vector(end.lambda, kDigits)});
  }
  if (!run.dynamics.autonomous) {
    rows.push_back({"H depends on time: |H - H0 - integral of H_t|",
                    text_number(outcome.summary.energy_balance, 3)});
  }
  if (run.dynamics.holonomic > 0) {
    rows.push_back({"holonomic error", text_number(outcome.summary.holonomic_error, 3)});
  }
  if (outcome.tangent) {
    rows.push_back({"symplecticity defect", text_number(outcome.tangent->defect, 3)});
    rows.push_back({"  relative", text_number(outcome.tangent->relative_defect, 3)});
  }
  for (const std::string& file : {run.destination.plot, run.destination.output}) {
    if (outcome.completed() && !file.empty()) rows.push_back({"written", file});
  }
  return title + text_table(rows);
}

// Path and panels on one page, unless something else is asked for.
plots::Figure figure_of(const Destination& destination, const SceneInfo& info) {
  const bool drawable = info.drawing.view != Drawing::View::kTimeOnly;
  if (destination.figure != plots::Figure::kAutomatic || !drawable) return destination.figure;
  return has_ending(destination.plot, ".gif") ? plots::Figure::kPath : plots::Figure::kOverview;
}

// A smooth picture needs more points than --samples may ask for.
std::string draw(const std::string& file, const FlowRequest& request, const StepPlan& plan) {
  constexpr long kPointsPerStep = 8;
  constexpr long kMostPoints = 4001;
  const Dynamics& dynamics = request.run.dynamics;
  MonitorOptions audit;
  audit.samples =
      std::max(request.run.samples, std::min(kMostPoints, kPointsPerStep * plan.count + 1));
  std::vector<double> z = request.z;
  const FlowSummary fine = dynamics.monitored_flow(plan, z, audit);
  return plots::write_figure(
      file,
      dynamics.info,
      {{"flow",
        &fine.trajectory,
        fine.action,
        std::isfinite(fine.length) ? std::optional(fine.length) : std::nullopt,
        extremes(dynamics.info, fine.trajectory)}},
      figure_of(request.run.destination, dynamics.info));
}

}  // namespace

Result flow_result(const FlowRequest& request,
                   const FlowOutcome& outcome,
                   const std::vector<std::string>& arguments) {
  const Dynamics& dynamics = request.run.dynamics;
  Result result;
  result.delivered = outcome.completed();
  result.message = "the flow failed: " + outcome.message;
  result.json = flow_json(request, outcome, arguments);
  result.text = [&] { return flow_text(request, outcome); };
  result.csv = [&] {
    return csv_text(dynamics.info, dynamics.multipliers, {&outcome.summary.trajectory});
  };
  result.draw = [&](const std::string& file) { return draw(file, request, outcome.plan); };
  return result;
}

}  // namespace carnot::apps
