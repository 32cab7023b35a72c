// Section 5 with V = 0: leaving the circle and returning to it.
//
// The circle is a saddle of a system of one degree of freedom (paper_separatrix.h) and the vehicle
// follows its separatrix to the next circle and back. phi is perturbed with the momenta kept.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "carnot/plots/series_plot.h"
#include "paper/paper_circle.h"

namespace carnot::apps {
namespace {

using plots::Legend;
using plots::Series;
using plots::SeriesPage;
using plots::SeriesPanel;

constexpr double kTime = 150;

// A return to a circular motion: where the distance from it is least.
struct Return {
  double time = 0;
  double distance = 0;
  double delta = 0;                   // phi - theta
  double centre_x = 0, centre_y = 0;  // the rear wheel
};

struct Excursions {
  double perturbation = 0;
  Trajectory nodes;
  std::vector<double> distance;  // from a circular motion, at the nodes
  std::vector<double> middles;   // times half-way between two circles, sin(delta) = 0
  std::vector<Return> returns;
};

Return return_at(const Excursions& run, std::size_t i) {
  const auto& q = run.nodes.q[i];
  return {
      run.nodes.t[i], run.distance[i], q[3] - q[2], q[0] - std::cos(q[2]), q[1] - std::sin(q[2])};
}

Excursions excursions(PaperWork& work, double perturbation) {
  constexpr double kNear = 0.1;
  Excursions run{perturbation, circle_run(work, perturbation, kTime), {}, {}, {}};
  const std::vector<double>& t = run.nodes.t;
  std::size_t nearest = 0;
  for (std::size_t i = 0; i < t.size(); ++i) {
    run.distance.push_back(circle_distance(run.nodes, i));
    if (i == 0) continue;
    if (run.distance[i] < run.distance[nearest]) nearest = i;
    const double before = std::cos(circle_excess(run.nodes, i - 1));  // sin(delta)
    const double after = std::cos(circle_excess(run.nodes, i));
    if (before * after > 0) continue;
    if (run.distance[nearest] < kNear && nearest > 0) {
      run.returns.push_back(return_at(run, nearest));
    }
    run.middles.push_back(t[i] - (t[i] - t[i - 1]) * after / (after - before));
    nearest = i;
  }
  return run;
}

// The part of the deviation that grows like exp(mu t), while it is small.
std::vector<double> unstable_part(const Excursions& run) {
  const CircleMotion motion;
  std::vector<double> part;
  for (std::size_t i = 0; i < run.nodes.t.size(); ++i) {
    const double eta = run.nodes.p[i][3] - 1;
    part.push_back(
        std::abs(circle_excess(run.nodes, i) + motion.kappa() / motion.growth_rate() * eta) / 2);
  }
  return part;
}

void add_return_rates(const std::vector<Excursions>& runs, PaperPart& part) {
  constexpr double kLinear = 0.02;
  const double mu = CircleMotion{}.growth_rate();
  for (const Excursions& run : runs) {
    const double rate = fit_growth(run.nodes.t, unstable_part(run), 0, kLinear).slope;
    part.rows.push_back({fmt::format("growth rate, phi perturbed by {:.0e}", run.perturbation),
                         "appears unstable",
                         fmt::format("{:.5f}", rate),
                         holds(std::abs(rate / mu - 1) < 0.01),
                         &run == &runs.front()
                             ? "a L sqrt(1/beta + 1/(L^2 + alpha)) = sqrt(3/2) = 1.22474; fitted "
                               "to the growing part of the deviation, up to 0.02"
                             : "",
                         rate,
                         mu});
  }
}

// The first half of the passage to the next circle; the second is its mirror image.
void add_passages(const std::vector<Excursions>& runs, PaperPart& part) {
  constexpr double kAccepted = 1e-3;  // the midpoint rule's own, mu^2 h^2/12, is 5e-5
  const CircleMotion motion;
  PaperTable table{
      "From the circle half-way to the next one, phi - theta = pi, after perturbing phi",
      {"perturbation", "here", "exact", "separatrix + log(2)/mu"},
      {}};
  std::vector<double> logs;
  std::vector<double> times;
  for (const Excursions& run : runs) {
    const double time = run.middles.empty() ? std::nan("") : run.middles.front();
    const double exact = halfway_time(motion, run.perturbation);
    const double separatrix = separatrix_time(motion, run.perturbation, kPi / 2) +
                              std::numbers::ln2 / motion.growth_rate();
    table.rows.push_back({run.perturbation, time, exact, separatrix});
    logs.push_back(-std::log(run.perturbation));
    times.push_back(time);
    part.rows.push_back({fmt::format("half a passage, phi perturbed by {:.0e}", run.perturbation),
                         "leaves the circle",
                         fmt::format("{:.4f}, exact {:.4f}", time, exact),
                         holds(std::abs(time / exact - 1) < kAccepted),
                         &run == &runs.front()
                             ? "time to phi - theta = pi; exact by quadrature; starting on the "
                               "separatrix it would be shorter by log(2)/mu = 0.566"
                             : "",
                         time,
                         exact});
  }
  const double rate = 1 / fit_line(logs, times).slope;
  part.rows.push_back({"slope of log(1/perturbation) over that time",
                       "-",
                       fmt::format("{:.5f}", rate),
                       holds(std::abs(rate / motion.growth_rate() - 1) < kAccepted),
                       "the passage takes (2/mu) log(1/perturbation) and a constant",
                       rate,
                       motion.growth_rate()});
  part.tables.push_back(table);
}

// The longest and the shortest time between two middles.
std::pair<double, double> extreme_intervals(const Excursions& run) {
  double shortest = std::numeric_limits<double>::infinity();
  double longest = 0;
  for (std::size_t i = 1; i < run.middles.size(); ++i) {
    shortest = std::min(shortest, run.middles[i] - run.middles[i - 1]);
    longest = std::max(longest, run.middles[i] - run.middles[i - 1]);
  }
  return {shortest, longest};
}

void add_returns(const std::vector<Excursions>& runs, PaperPart& part) {
  constexpr double kAccepted = 1e-3;
  const CircleMotion motion;
  for (const Excursions& run : runs) {
    const auto [shortest, longest] = extreme_intervals(run);
    const bool above = run.perturbation * run.perturbation > 100 * kEps;
    const double exact = 2 * halfway_time(motion, run.perturbation);
    const bool right =
        std::abs(shortest / exact - 1) < kAccepted && std::abs(longest / exact - 1) < kAccepted;
    part.rows.push_back(
        {fmt::format("returns until t = {:g}, after {:.0e}", kTime, run.perturbation),
         "repeatedly",
         fmt::format("{}, every {:.2f} to {:.2f}", run.returns.size(), shortest, longest),
         holds(above ? right : run.returns.size() >= 2),
         above
             ? fmt::format("exact {:.3f}", exact)
             : fmt::format("exact {:.3f}, out of reach: an error eps on the way makes the nearest "
                           "return sqrt(eps), here {:.0e}, and none takes much longer than {:.1f}",
                           exact,
                           run.returns.empty() ? std::nan("") : run.returns.front().distance,
                           2 * halfway_time(motion, std::sqrt(kEps))),
         longest});
  }
}

void add_next_circle(const Excursions& run, PaperPart& part) {
  if (run.returns.empty()) {
    part.rows.push_back({"the next circle", "the same", "not reached", PaperVerdict::kFails});
    return;
  }
  const Return& first = run.returns.front();
  part.rows.push_back({"phi - theta on the next circle",
                       "relative homoclinic?",
                       fmt::format("{:.4f}", first.delta),
                       holds(std::abs(first.delta - 3 * kPi / 2) < 1e-3),
                       "3 pi/2: heteroclinic, to the circle driven backwards; up to half turns of "
                       "the wheel and rigid motions it is the same circle: relative homoclinic",
                       first.delta,
                       3 * kPi / 2});
  const double shift = std::hypot(first.centre_x, first.centre_y);
  const double exact = centre_shift(CircleMotion{});
  part.rows.push_back({"its centre, from that of the first",
                       "returns to the orbit",
                       fmt::format("{:.4f} L away", shift),
                       holds(std::abs(shift / exact - 1) < 0.01),
                       fmt::format("exact {:.4f} by quadrature on the separatrix: radius and speed "
                                   "are the same, the centre is not",
                                   exact),
                       shift,
                       exact});
}

SeriesPanel path_panel(const Excursions& run) {
  SeriesPanel panel;
  Series front{"front wheel", {}, {}};
  Series centres{"centres of the circles", {0}, {0}, Series::Mark::kPoints};
  front.width = 1;
  for (const auto& q : run.nodes.q) {
    front.x.push_back(q[0]);
    front.y.push_back(q[1]);
  }
  for (const Return& back : run.returns) {
    centres.x.push_back(back.centre_x);
    centres.y.push_back(back.centre_y);
  }
  panel.title =
      fmt::format("path, \u03c6 perturbed by 10^{{\u2212{:.0f}}}", -std::log10(run.perturbation));
  panel.x = {"x [length]", false, {}};
  panel.y = {"y [length]", false, {}};
  panel.series = {front, centres};
  panel.equal_axes = true;
  return panel;
}

SeriesPanel distance_panel(const std::vector<Excursions>& runs) {
  SeriesPanel panel;
  for (const Excursions& run : runs) {
    Series series;
    series.title = fmt::format("10^{{\u2212{:.0f}}}", -std::log10(run.perturbation));
    series.x = run.nodes.t;
    series.y = run.distance;
    panel.series.push_back(series);
  }
  panel.title = "distance from a circular motion";
  panel.x = {"t [time]", false, {}};
  panel.y = {"|(cos(\u03c6 \u2212 \u03b8), p_{\u03c6}/(\u03b2a) \u2212 1)|", true, {}};
  panel.slopes = {{"exp(1.225 t)", CircleMotion{}.growth_rate(), 4, 1e-12, 24}};
  return panel;
}

SeriesPanel passage_panel(const std::vector<Excursions>& runs) {
  const CircleMotion motion;
  SeriesPanel panel;
  Series here{"midpoint rule", {}, {}, Series::Mark::kPoints};
  Series exact{"exact", {}, {}};
  Series separatrix{"on the separatrix", {}, {}};
  separatrix.dashed = true;
  for (const Excursions& run : runs) {
    if (run.middles.empty()) continue;
    here.x.push_back(run.perturbation);
    here.y.push_back(run.middles.front());
  }
  for (double exponent = -13; exponent <= -1; exponent += 0.5) {
    const double perturbation = std::pow(10.0, exponent);
    exact.x.push_back(perturbation);
    exact.y.push_back(halfway_time(motion, perturbation));
    separatrix.x.push_back(perturbation);
    separatrix.y.push_back(separatrix_time(motion, perturbation, kPi / 2));
  }
  panel.title = "half the way to the next circle";
  panel.x = {"perturbation of \u03c6 [rad]", true, {}};
  panel.y = {"t [time]", false, {}};
  panel.series = {exact, separatrix, here};
  panel.legend = Legend::kTopRight;
  return panel;
}

}  // namespace

PaperPart paper_returns(PaperWork& work) {
  std::vector<Excursions> runs;
  for (const double perturbation : {1e-4, 1e-8, 1e-12}) {
    runs.push_back(excursions(work, perturbation));
  }
  PaperPart part;
  part.title = "Section 5: V = 0, leaving the circle and returning, midpoint rule";
  add_return_rates(runs, part);
  add_passages(runs, part);
  add_returns(runs, part);
  add_next_circle(runs.back(), part);
  SeriesPage page;
  page.title = "vehicle, V = 0: leaving the circle and returning to another";
  page.panels = {path_panel(runs.front()), distance_panel(runs), passage_panel(runs)};
  part.figures.push_back({"circle_returns",
                          "path, distance from a circular motion, passage times",
                          [page](const auto& file) { return plots::write_series(file, page); }});
  return part;
}

}  // namespace carnot::apps
