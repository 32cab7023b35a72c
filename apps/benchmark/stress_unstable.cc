// Motions that part exponentially.
//
// Straight ahead at unit speed, with p_x = 1, the vehicle's angles are small. With l theta' = phi -
// theta the action to second order is 1/2 of the integral of beta phi'^2 + phi^2 + alpha theta'^2,
// and e^{rt} solves its equation where
//
//   (1 - beta r^2) (1 - l^2 r^2) = alpha r^2,
//
// a quadratic in r^2. At unit parameters r is the golden ratio, and its inverse. On the circle an
// error grows with the rate sqrt(3/2), so that one of eps is of size 1 at -ln(eps) / sqrt(3/2).
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <limits>

#include "benchmark/stress_case.h"
#include "catalogue/scene_choice.h"
#include "text/text_table.h"

namespace carnot::apps {
namespace {

constexpr const char* kUnstableGroup = "unstable motions";
using Tangent = Eigen::Matrix<double, 8, 8, Eigen::RowMajor>;

// The logarithms of the two largest eigenvalues per time, relative to the rates.
double error_of_rates(const Tangent& m, double time, std::pair<double, double> rates) {
  std::vector<double> sizes;
  for (const auto& value : Eigen::EigenSolver<Tangent>(m).eigenvalues()) {
    sizes.push_back(std::log(std::abs(value)) / time);
  }
  std::sort(sizes.rbegin(), sizes.rend());
  return std::max(std::abs(sizes[0] / rates.first - 1), std::abs(sizes[1] / rates.second - 1));
}

StressCase line_case(const ParameterValues& parameters) {
  constexpr double kTime = 1;
  constexpr double kAside = 1e-6;  // of the differences
  const Dynamics vehicle = find_scene("vehicle").make(parameters, "gauss16");
  const StepPlan plan = StepPlan::equal(0, kTime, 64);
  const std::vector<double> start{0, 0, 0, 0, 1, 0, 0, 0};
  const auto rates =
      rates_of_line(parameters.at("alpha"), parameters.at("beta"), parameters.at("length"));
  Tangent m;
  std::vector<double> end = start;
  const bool done = vehicle.tangent_flow(plan, end, {m.data(), 64}).completed();
  Tangent differences;
  for (int j = 0; j < 8; ++j) {
    std::vector<double> moved = start;
    moved[j] += kAside;
    if (!vehicle.flow(plan, moved).completed()) moved[0] = std::nan("");
    for (int i = 0; i < 8; ++i) differences(i, j) = (moved[i] - end[i]) / kAside;
  }
  StressCase one{kUnstableGroup,
                 "straight ahead, rates " + text_number(rates.first, 4) + " and " +
                     text_number(rates.second, 4),
                 "growth of the tangent flow",
                 std::nan(""),
                 // Round-off of the smaller eigenvalue is that of the larger one.
                 64 * kUnitRoundOff * std::exp((rates.first - rates.second) * kTime) / rates.second,
                 "differences of flows"};
  if (done) one.figure = error_of_rates(m, kTime, rates);
  one.naive_figure = differences.allFinite() ? error_of_rates(differences, kTime, rates)
                                             : std::numeric_limits<double>::infinity();
  return one;
}

// The naive guess is that motions of a smooth system stay near what they should be: for ever.
StressCase circle_case(int bits, const char* precision) {
  const double rate = std::sqrt(1.5);
  const double law = bits * std::log(2.0) / rate;
  // A factor of e^5 either way, for how round-off adds up, and for 0.1 in place of 1.
  constexpr double kLuck = 5;
  const double left = departure_from_circle(bits);
  return {kUnstableGroup,
          std::string("circle in ") + precision + ", left at " + text_number(left, 4),
          "-ln(eps) / rate = " + text_number(law, 4),
          std::abs(left - law),
          kLuck / rate,
          "trusting round-off to stay, T = 96",
          std::abs(96 - law)};
}

}  // namespace

std::pair<double, double> rates_of_line(double alpha, double beta, double length) {
  const double square = length * length;
  const double half = 0.5 * (beta + square + alpha);
  const double root = std::sqrt(half * half - beta * square);
  return {std::sqrt((half + root) / (beta * square)), std::sqrt(1 / (half + root))};
}

std::vector<StressCase> unstable_cases(const SuiteOptions& options, const Progress& progress) {
  std::vector<StressCase> cases;
  for (const ParameterValues& parameters :
       {ParameterValues{{"alpha", 1}, {"beta", 1}, {"length", 1}},
        ParameterValues{{"alpha", 0.1}, {"beta", 0.02}, {"length", 2.5}}}) {
    cases.push_back(line_case(parameters));
  }
  cases.push_back(circle_case(53, "double"));
  cases.push_back(circle_case(64, "long double"));
  if (progress && !progress(0.5)) return {};
  if (!options.brief) cases.push_back(circle_case(113, "quadruple"));
  return cases;
}

}  // namespace carnot::apps
