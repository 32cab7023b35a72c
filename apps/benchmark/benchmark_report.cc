#include "benchmark/benchmark_report.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "catalogue/scene_choice.h"
#include "text/text_table.h"
#include "text/version.h"

namespace carnot::apps {
namespace {

using Cells = std::vector<std::vector<std::string>>;

std::string microseconds(double seconds) { return fmt::format("{:.4g}", 1e6 * seconds); }

// "12.3 us (2.1x)", or a dash where no row has this error.
std::string time_and_ratio(const std::vector<BenchmarkCurve>& curves,
                           const BenchmarkCurve& curve,
                           double error) {
  const auto seconds = seconds_at(curve, error);
  if (!seconds) return "-";
  const auto ratio = speed_ratio(curves, curve, error);
  const std::string faster = ratio ? fmt::format(" ({:.3g}x)", *ratio) : "";
  return fmt::format("{:.3g}{}", 1e6 * *seconds, faster);
}

// The first row is the header.
Cells equal_error_table(const BenchmarkScene& scene) {
  Cells cells{{"method"}};
  for (const double error : kBenchmarkErrors) cells[0].push_back(fmt::format("{:.0e}", error));
  cells[0].emplace_back("least error");
  const auto curves = benchmark_curves(scene.rows);
  for (const BenchmarkCurve& curve : curves) {
    std::vector<std::string> line{curve.title()};
    for (const double error : kBenchmarkErrors) {
      line.push_back(time_and_ratio(curves, curve, error));
    }
    double least = curve.rows.front().error;
    for (const BenchmarkRow& row : curve.rows) least = std::min(least, row.error);
    line.push_back(fmt::format("{:.1e}", least));
    cells.push_back(line);
  }
  return cells;
}

Cells row_table(const BenchmarkScene& scene) {
  Cells cells{{"method", "step or tolerance", "error", "us", "evaluations", "energy drift"}};
  for (const BenchmarkCurve& curve : benchmark_curves(scene.rows)) {
    for (const BenchmarkRow& row : curve.rows) {
      cells.push_back({curve.title(),
                       text_number(row.step_or_tolerance, 4),
                       fmt::format("{:.2e}", row.error),
                       microseconds(row.seconds),
                       fmt::format("{:.0f}", row.evaluations),
                       fmt::format("{:.1e}", row.energy_drift)});
    }
  }
  return cells;
}

std::string heading(const BenchmarkScene& scene) {
  return fmt::format("T = {:g}, (q, p) = {}, reference good to {:.0e}",
                     scene.problem.trajectory.duration,
                     text_vector(scene.problem.start),
                     scene.reference.agreement);
}

std::string explanation() {
  return fmt::format(
      "CPU time of one trajectory in us at equal error, interpolated; in parentheses the time of "
      "{} over it",
      kContrast);
}

std::string failures_text(const BenchmarkScene& scene) {
  std::string text;
  for (const BenchmarkFailure& failure : scene.failures) {
    text += fmt::format(
        "{} at {:.3g} left out: {}\n", failure.method, failure.step_or_tolerance, failure.message);
  }
  return text;
}

Json trajectory_of(const BenchmarkScene& scene) {
  const auto half = static_cast<std::ptrdiff_t>(scene.problem.trajectory.dof);
  const auto split = [half](const auto& values) {
    return Json{{"q", std::vector(values.begin(), values.begin() + half)},
                {"p", std::vector(values.begin() + half, values.end())}};
  };
  Json parameters = Json::object();
  for (const ParameterInfo& parameter : find_scene(scene.problem.trajectory.scene).parameters) {
    parameters[parameter.name] = parameter.default_value;
  }
  return {{"scene", std::string(scene.problem.trajectory.scene)},
          {"parameters", parameters},
          {"start", split(scene.problem.start)},
          {"time", scene.problem.trajectory.duration},
          {"reference", split(scene.reference.digits)},
          {"reference_agreement", scene.reference.agreement}};
}

Json row_json(const BenchmarkRow& row) {
  return {{"scene", row.scene},
          {"method", row.method},
          {"mode", row.mode},
          {"peer", row.peer},
          {"automatic", row.automatic},
          {"step_or_tolerance", row.step_or_tolerance},
          {"error", row.error},
          {"seconds", row.seconds},
          {"evaluations", std::lround(row.evaluations)},
          {"energy_drift", row.energy_drift}};
}

void add_equal_error(const BenchmarkScene& scene, Json& list) {
  const auto curves = benchmark_curves(scene.rows);
  for (const BenchmarkCurve& curve : curves) {
    for (const double error : kBenchmarkErrors) {
      list.push_back({{"scene", std::string(scene.problem.trajectory.scene)},
                      {"method", curve.method},
                      {"mode", curve.mode},
                      {"peer", curve.peer},
                      {"automatic", curve.automatic},
                      {"error", error},
                      {"seconds", or_null(seconds_at(curve, error))},
                      {"ratio", or_null(speed_ratio(curves, curve, error))}});
    }
  }
}

}  // namespace

void add_benchmark_json(const std::vector<BenchmarkScene>& scenes, Json& json) {
  Json trajectories = Json::array();
  Json rows = Json::array();
  Json equal_error = Json::array();
  Json left_out = Json::array();
  for (const BenchmarkScene& scene : scenes) {
    trajectories.push_back(trajectory_of(scene));
    for (const BenchmarkRow& row : scene.rows) rows.push_back(row_json(row));
    add_equal_error(scene, equal_error);
    for (const BenchmarkFailure& failure : scene.failures) {
      left_out.push_back({{"scene", failure.scene},
                          {"method", failure.method},
                          {"mode", failure.mode},
                          {"step_or_tolerance", failure.step_or_tolerance},
                          {"message", failure.message}});
    }
  }
  json["trajectories"] = trajectories;
  json["rows"] = rows;
  json["equal_error"] = equal_error;
  json["left_out"] = left_out;
}

std::string benchmark_text(const std::vector<BenchmarkScene>& scenes) {
  std::string text;
  for (const BenchmarkScene& scene : scenes) {
    text += fmt::format("{}: {}\n\n{}{}\n",
                        scene.problem.trajectory.scene,
                        heading(scene),
                        text_table(equal_error_table(scene)),
                        failures_text(scene));
  }
  return text + explanation() + "\n";
}

std::string markdown_head(const std::vector<std::string>& arguments) {
  return fmt::format("# carnot {}\n\ncarnot {}, {}, g++ {}\n",
                     fmt::join(arguments, " "),
                     kVersion,
                     processor_name(),
                     __VERSION__);
}

std::string benchmark_markdown(const std::vector<BenchmarkScene>& scenes,
                               const std::vector<std::string>& arguments) {
  std::string text = fmt::format("{}\n{}.\n", markdown_head(arguments), explanation());
  for (const BenchmarkScene& scene : scenes) {
    text += fmt::format("\n## {}\n\n{}\n\n{}\n{}\n{}",
                        scene.problem.trajectory.scene,
                        heading(scene),
                        markdown_table(equal_error_table(scene)),
                        markdown_table(row_table(scene)),
                        scene.failures.empty() ? "" : "\n" + failures_text(scene));
  }
  return text;
}

}  // namespace carnot::apps
