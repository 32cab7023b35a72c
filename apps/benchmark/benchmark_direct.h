// carnot benchmark --limits and --drift: geodesics that keep to limits, or of scenes with drift,
// against a direct method.
//
// carnot finds them without a guess, and its answer is exact: with limits, where arcs or touches
// can be told. A direct method solves the equations of a grid, and keeps to limits at its nodes. It
// is asked twice: from blind starts, whether it finds the same action on a coarse grid; and from
// carnot's path on finer and finer grids, where its action ends as the grid does. The errors of its
// midpoint rule fall as the square of the interval, so three grids tell the limit and how well it
// is known.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "carnot/shooting/boundary_value_problem.h"
#include "catalogue/limit_choice.h"

namespace carnot::apps {

struct DirectOptions {
  bool quick = false;  // coarser grids and fewer starts
  std::uint64_t seed = 0;
};

struct DirectProblem {
  std::string name;
  std::string scene;  // with drift: of drift_texts()
  std::vector<double> from;
  std::vector<double> to;
  AskedLimits asked;
  double time = 1;
  bool drift = false;
};

// What carnot found.
struct OwnAnswer {
  bool solved = false;
  double action = 0;
  double violation = 0;
  std::string verification;  // "single", "knots" or "grid"
  std::string label;
  int contacts = 0;  // arcs and touches
  double seconds = 0;
};

// What a direct method made of it.
struct DirectAnswer {
  std::string solver;
  int starts = 0;       // blind ones
  int solved = 0;       // of these, by its own word
  int least_found = 0;  // of these, at the action of carnot but for what the grid makes
  double seconds_per_start = 0;
  std::optional<double> action;  // the limit of grids, from carnot's path
  double action_error = 0;       // how well that is known
  double violation = 0;          // on the finest grid, between nodes
  double seconds = 0;            // on the finest grid
};

struct DirectRow {
  DirectProblem problem;
  OwnAnswer own;
  std::optional<DirectAnswer> direct;
};

// A path on a grid of equal intervals, (intervals + 1) x n and intervals x m.
struct GridPath {
  std::vector<double> q;
  std::vector<double> u;  // the controls of each interval; empty where the scene has none
};

// A direct method on the midpoint grid. The ends of the path stay. Nothing where it does not
// converge; else the action.
struct DirectSolver {
  std::string name;
  std::function<std::optional<double>(const BoundaryValueProblem&, GridPath&)> solve;
};

const std::vector<DirectProblem>& limits_problems();
const std::vector<DirectProblem>& drift_problems();

// Nothing when stopped.
std::optional<std::vector<DirectRow>> run_direct_benchmark(
    const std::vector<DirectProblem>& problems,
    const DirectOptions& options,
    const std::optional<DirectSolver>& direct,
    const Progress& progress);

}  // namespace carnot::apps
