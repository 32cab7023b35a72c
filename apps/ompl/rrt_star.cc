// carnot_rrt_star [FILE [SAMPLES]]: RRT* of the Open Motion Planning Library steers a unicycle
// through two obstacles; the tree and the path become a picture.
//
// Every edge of the tree is a geodesic of the sub-Riemannian problem on SE(2), so the robot, a
// disc, may turn on the spot, back up and drive cusps where that is shorter. The same number of
// samples (150) gives the same path.
#include <ompl/base/PlannerData.h>
#include <ompl/base/ProblemDefinition.h>
#include <ompl/base/terminationconditions/IterationTerminationCondition.h>
#include <ompl/geometric/PathGeometric.h>
#include <ompl/geometric/planners/rrt/RRTstar.h>
#include <ompl/util/Console.h>
#include <ompl/util/RandomNumbers.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstdlib>
#include <exception>
#include <iostream>
#include <memory>
#include <numbers>
#include <string>
#include <vector>

#include "carnot/make_dynamics.h"
#include "carnot/plots/series_plot.h"
#include "carnot/scenes/unicycle.h"
#include "carnot/shooting/ompl_state_space.h"

namespace {

namespace ob = ompl::base;
namespace og = ompl::geometric;
using carnot::plots::Series;

constexpr double kRadius = 0.15;  // of the robot
constexpr std::array<double, 4> kRoom{-0.5, 5.5, -1.5, 1.5};
const std::vector<double> kStart{0, 0, 0};
const std::vector<double> kGoal{5, 0, 0};

// Walls with an open end each: x from, x to, y from, y to.
constexpr std::array<std::array<double, 4>, 2> kObstacles{
    {{1.4, 1.8, -0.5, 1.5}, {3.2, 3.6, -1.5, 0.5}}};

bool is_free(double x, double y) {
  if (x < kRoom[0] + kRadius || x > kRoom[1] - kRadius) return false;
  if (y < kRoom[2] + kRadius || y > kRoom[3] - kRadius) return false;
  return std::none_of(kObstacles.begin(), kObstacles.end(), [&](const auto& box) {
    const double dx = std::max({box[0] - x, x - box[1], 0.0});
    const double dy = std::max({box[2] - y, y - box[3], 0.0});
    return std::hypot(dx, dy) < kRadius;
  });
}

struct Plan {
  ob::SpaceInformationPtr si;
  ob::ProblemDefinitionPtr problem;
  std::shared_ptr<og::RRTstar> planner;
};

Plan make_plan() {
  carnot::SteeringOptions options;
  options.starts = 2;
  options.memory = 100000;
  ob::RealVectorBounds bounds(2);
  for (unsigned j : {0U, 1U}) {
    bounds.setLow(j, kRoom[2 * j]);
    bounds.setHigh(j, kRoom[2 * j + 1]);
  }
  const auto space = std::make_shared<carnot::SteeringStateSpace>(
      carnot::SteeringFunction(carnot::make_dynamics(carnot::scenes::Unicycle{}), options), bounds);
  space->setLongestValidSegmentFraction(0.005);
  Plan plan;
  plan.si = std::make_shared<ob::SpaceInformation>(space);
  plan.si->setStateValidityChecker([space = space.get()](const ob::State* state) {
    const std::vector<double> q = space->configuration(state);
    return is_free(q[0], q[1]);
  });
  plan.si->setMotionValidator(std::make_shared<carnot::SteeringMotionValidator>(plan.si));
  plan.si->setup();
  plan.problem = std::make_shared<ob::ProblemDefinition>(plan.si);
  ob::ScopedState<> start(space);
  ob::ScopedState<> goal(space);
  space->set(start.get(), kStart);
  space->set(goal.get(), kGoal);
  plan.problem->setStartAndGoalStates(start, goal, 1e-3);
  plan.problem->setOptimizationObjective(std::make_shared<carnot::SteeringObjective>(plan.si));
  plan.planner = std::make_shared<og::RRTstar>(plan.si);
  plan.planner->setProblemDefinition(plan.problem);
  plan.planner->setRange(2);
  plan.planner->setGoalBias(0.1);
  plan.planner->setup();
  return plan;
}

// Appends the geodesic between two states, and a gap.
void add_geodesic(const carnot::SteeringStateSpace& space,
                  const ob::State* from,
                  const ob::State* to,
                  Series& series) {
  constexpr int kPoints = 24;
  const carnot::Steering way =
      space.steering().steer(space.configuration(from), space.configuration(to));
  std::vector<double> q(space.steering().dof());
  for (int i = 0; i <= kPoints && way.at(static_cast<double>(i) / kPoints, q); ++i) {
    series.x.push_back(q[0]);
    series.y.push_back(q[1]);
  }
  series.x.push_back(std::nan(""));
  series.y.push_back(std::nan(""));
}

Series outline(double x0, double x1, double y0, double y1, const std::string& title) {
  Series series;
  series.title = title;
  series.x = {x0, x1, x1, x0, x0};
  series.y = {y0, y0, y1, y1, y0};
  series.color = 0;
  series.width = 2.5;
  return series;
}

// The robot and its heading at `count` times of a geodesic.
void add_robots(const carnot::Steering& way, int count, Series& series) {
  constexpr int kCorners = 24;
  std::vector<double> q(3);
  for (int i = 0; i <= count && way.at(static_cast<double>(i) / count, q); ++i) {
    for (int k = 0; k <= kCorners; ++k) {
      const double angle = q[2] + 2 * std::numbers::pi * k / kCorners;
      series.x.push_back(q[0] + kRadius * std::cos(angle));
      series.y.push_back(q[1] + kRadius * std::sin(angle));
    }
    series.x.insert(series.x.end(), {q[0], std::nan("")});
    series.y.insert(series.y.end(), {q[1], std::nan("")});
  }
}

std::string draw(const std::string& file, const Plan& plan, og::PathGeometric& path) {
  const auto& space = *plan.si->getStateSpace()->as<carnot::SteeringStateSpace>();
  carnot::plots::SeriesPage page;
  page.title = "RRT* with geodesics of the unicycle";
  page.width = 900;
  page.height = 450;
  carnot::plots::SeriesPanel panel;
  panel.x = {"x [length]"};
  panel.y = {"y [length]"};
  panel.equal_axes = true;
  Series tree{"tree"};
  tree.color = 2;
  tree.width = 0.4;
  ob::PlannerData data(plan.si);
  plan.planner->getPlannerData(data);
  for (unsigned from = 0; from < data.numVertices(); ++from) {
    std::vector<unsigned> edges;
    data.getEdges(from, edges);
    for (const unsigned to : edges) {
      add_geodesic(space, data.getVertex(from).getState(), data.getVertex(to).getState(), tree);
    }
  }
  panel.series.push_back(tree);
  Series robots{"robot"};
  robots.color = 4;
  robots.width = 1;
  Series track{"path"};
  track.color = 5;
  track.width = 3;
  for (std::size_t i = 0; i + 1 < path.getStateCount(); ++i) {
    const carnot::Steering way = space.steering().steer(space.configuration(path.getState(i)),
                                                        space.configuration(path.getState(i + 1)));
    const int robot_count = std::max(1, static_cast<int>(way.distance() / (3 * kRadius)));
    add_robots(way, robot_count, robots);
    add_geodesic(space, path.getState(i), path.getState(i + 1), track);
  }
  panel.series.push_back(robots);
  panel.series.push_back(track);
  for (const auto& box : kObstacles) {
    const std::string title = &box == kObstacles.data() ? "obstacles and room" : "";
    panel.series.push_back(outline(box[0], box[1], box[2], box[3], title));
  }
  panel.series.push_back(outline(kRoom[0], kRoom[1], kRoom[2], kRoom[3], ""));
  page.panels.push_back(panel);
  return carnot::plots::write_series(file, page);
}

int run(const std::string& file, unsigned samples) {
  carnot::plots::validate_plot_file(file);
  ompl::msg::setLogLevel(ompl::msg::LOG_WARN);
  ompl::RNG::setSeed(1);
  const auto begin = std::chrono::steady_clock::now();
  const Plan plan = make_plan();
  ob::IterationTerminationCondition enough(samples);
  const ob::PlannerStatus status = plan.planner->solve(enough);
  if (status != ob::PlannerStatus::EXACT_SOLUTION) {
    std::cerr << "no path to the goal within " << samples << " samples: try more\n";
    return 1;
  }
  auto& path = *plan.problem->getSolutionPath()->as<og::PathGeometric>();
  const std::chrono::duration<double> elapsed = std::chrono::steady_clock::now() - begin;
  std::cout << "length " << path.cost(plan.problem->getOptimizationObjective()).value() << ", "
            << path.getStateCount() - 1 << " geodesics, " << plan.planner->numIterations()
            << " samples, " << elapsed.count() << " s\n";
  const std::string warnings = draw(file, plan, path);
  if (!warnings.empty()) std::cerr << warnings << '\n';
  std::cout << "written: " << file << '\n';
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  try {
    const std::string file = argc > 1 ? argv[1] : "rrt_star.png";
    return run(file, argc > 2 ? static_cast<unsigned>(std::stoul(argv[2])) : 150);
  } catch (const std::exception& error) {
    std::cerr << "carnot_rrt_star: " << error.what() << '\n';
    return 2;
  }
}
