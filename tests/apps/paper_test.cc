// What `carnot paper` measures, against closed forms and against runs of another method.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <stdexcept>

#include "catalogue/scene_choice.h"
#include "paper/paper_circle.h"
#include "paper/paper_cosine.h"
#include "paper/paper_parts.h"
#include "paper/paper_separatrix.h"
#include "testing/reference.h"

namespace carnot::apps::paper_test {
namespace {

using ::testing::HasSubstr;

constexpr double kPi = std::numbers::pi;
constexpr double kEps = std::numeric_limits<double>::epsilon();
constexpr double kQuadrature = 1e-9;  // of the quadratures, relative

const CircleMotion kOther{0.7, 0.4, 1.3, 0.8};

TEST(Separatrix, GrowthRateOfUnitParameters) {
  EXPECT_NEAR(CircleMotion{}.growth_rate(), std::sqrt(1.5), 4 * kEps);
}

// Values of shared/reference/circular_straight.json: from 1e-16 rad to 1 rad.
TEST(Separatrix, TimesHaveTheReferenceValues) {
  EXPECT_NEAR(separatrix_time({}, 1e-16, 1), 30.0540666963365111931, 30 * kQuadrature);
  EXPECT_NEAR(
      separatrix_time({0.1, 0.02, 2.5, 1}, 1e-16, 1), 2.08558522243196634077, 2 * kQuadrature);
  EXPECT_NEAR(separatrix_time({1, 1, 1, 0.5}, 1e-16, 1), 60.1081333926730223862, 60 * kQuadrature);
  EXPECT_NEAR(2 * separatrix_time({}, 1e-16, kPi / 2), 60.8418257367691757449, 60 * kQuadrature);
}

// From rest the saddle is left like perturbation * cosh(mu t), on the separatrix like exp(mu t).
TEST(Separatrix, APerturbationAtRestLagsByLogTwo) {
  for (const CircleMotion& motion : {CircleMotion{}, kOther}) {
    for (const double perturbation : {1e-3, 1e-6, 1e-12}) {
      const double lag =
          halfway_time(motion, perturbation) - separatrix_time(motion, perturbation, kPi / 2);
      EXPECT_NEAR(lag * motion.growth_rate(), std::numbers::ln2, 2 * perturbation + 1e-8);
    }
  }
}

// A run of Gauss 16 of the vehicle with these parameters, phi perturbed.
Trajectory exact_run(const CircleMotion& motion, double perturbation, double time, long samples) {
  const double l = motion.length;
  const Dynamics dynamics = find_scene("vehicle").make(
      {{"alpha", motion.alpha}, {"beta", motion.beta}, {"length", l}}, "gauss16");
  std::vector<double> z{l,
                        0,
                        0,
                        kPi / 2 + perturbation,
                        0,
                        0,
                        motion.turn * (l * l + motion.alpha),
                        motion.turn * motion.beta};
  PaperWork work({}, 1);
  return work.flow(dynamics, StepPlan::of_length(0, time, 0.1), z, samples).trajectory;
}

TEST(Separatrix, HalfwayTimeIsThatOfTheFlow) {
  for (const CircleMotion& motion : {CircleMotion{}, kOther}) {
    for (const double perturbation : {1e-4, 0.05, 0.5}) {
      const double time = halfway_time(motion, perturbation);
      const auto end = exact_run(motion, perturbation, time, 2).q.back();
      EXPECT_NEAR(end[3] - end[2], kPi, 1e-8) << perturbation;
    }
  }
}

// After twice that time the vehicle is as near to the next circle as it was to the first.
TEST(Separatrix, CentreShiftIsThatOfTheFlow) {
  constexpr double kPerturbation = 1e-6;
  for (const CircleMotion& motion : {CircleMotion{}, kOther}) {
    const double time = 2 * halfway_time(motion, kPerturbation);
    const auto end = exact_run(motion, kPerturbation, time, 2).q.back();
    EXPECT_NEAR(end[3] - end[2], 3 * kPi / 2, 2 * kPerturbation);
    const double x = end[0] - motion.length * std::cos(end[2]);
    const double y = end[1] - motion.length * std::sin(end[2]);
    EXPECT_NEAR(std::hypot(x, y), centre_shift(motion), 10 * kPerturbation);
  }
}

TEST(Fits, FindTheRate) {
  std::vector<double> t;
  std::vector<double> y;
  for (int i = 0; i < 100; ++i) {
    t.push_back(0.1 * i);
    y.push_back(1e-6 * std::exp(1.5 * t.back()) + (i > 60 ? 1 : 0));
  }
  const LineFit line = fit_growth(t, y, 1e-5, 1e-2);
  EXPECT_NEAR(line.slope, 1.5, 1e-12);
  EXPECT_NEAR(line.correlation, 1, 1e-12);
  EXPECT_GT(line.points, 30);
}

TEST(Work, StopsWhenItIsTold) {
  PaperWork work([](double /*fraction*/) { return false; }, 1);
  EXPECT_THROW(paper_heisenberg(work), std::runtime_error);
}

TEST(Work, TellsOfAFailedRun) {
  PaperWork work({}, 1);
  const Dynamics dynamics = paper_dynamics("vehicle", "midpoint");
  std::vector<double> z(8, std::nan(""));
  try {
    work.flow(dynamics, StepPlan::equal(0, 1, 10), z);
    ADD_FAILURE();
  } catch (const std::runtime_error& error) {
    EXPECT_THAT(error.what(), HasSubstr("a run of vehicle by midpoint failed at t = 0"));
  }
}

// All parts, run once.
class Paper : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    double reached = 0;
    PaperWork work(
        [&](double fraction) {
          EXPECT_GE(fraction, reached);
          reached = fraction;
          return true;
        },
        kPaperSteps);
    for (const auto& part :
         {paper_cosine, paper_straight, paper_circle, paper_returns, paper_heisenberg}) {
      parts().push_back(part(work));
    }
    EXPECT_GT(reached, 0.9) << "of the progress bar";
    EXPECT_LT(reached, 1.1);
  }
  static void TearDownTestSuite() { parts().clear(); }

  static std::vector<PaperPart>& parts() {
    static std::vector<PaperPart> all;
    return all;
  }
  // The first row of that name.
  static PaperRow row(const std::string& what) {
    for (const PaperPart& part : parts()) {
      for (const PaperRow& candidate : part.rows) {
        if (candidate.what == what) return candidate;
      }
    }
    ADD_FAILURE() << "no row " << what;
    return {};
  }
};

TEST_F(Paper, HoldsOrIsAMisprint) {
  EXPECT_EQ(count_failures(parts()), 0U);
  int misprints = 0;
  for (const PaperPart& part : parts()) {
    EXPECT_GE(part.rows.size(), 7U) << part.title;
    EXPECT_GE(part.figures.size(), 1U) << part.title;
    for (const PaperRow& each : part.rows) {
      EXPECT_NE(each.verdict, PaperVerdict::kFails) << each.what << ": " << each.here;
      misprints += each.verdict == PaperVerdict::kMisprint ? 1 : 0;
      if (each.value) {
        EXPECT_TRUE(std::isfinite(*each.value)) << each.what;
      }
    }
  }
  EXPECT_EQ(misprints, 2) << "lambda of the circle and of the Heisenberg problem";
}

TEST_F(Paper, RatesAreThoseOfTheLinearisation) {
  // The midpoint rule's own rate is s (1 + s^2 h^2/12): 9e-5 off at h = 0.02.
  constexpr double kMidpoint = 2e-4;
  const double golden = (1 + std::sqrt(5.0)) / 2;
  for (const char* perturbation : {"1e-04", "1e-08", "1e-12"}) {
    const std::string what = std::string("growth rate, phi perturbed by ") + perturbation;
    std::vector<double> rates;
    for (const PaperPart& part : parts()) {
      for (const PaperRow& each : part.rows) {
        if (each.what == what) rates.push_back(each.value.value());
      }
    }
    ASSERT_EQ(rates.size(), 2U) << what;
    EXPECT_NEAR(rates[0], golden, kMidpoint * golden);
    EXPECT_NEAR(rates[1], std::sqrt(1.5), 1e-3);
  }
}

TEST_F(Paper, TheLineIsExactlyStraight) {
  EXPECT_EQ(row("theta, phi and y on the line, 1e5 steps").value, 0);
}

TEST_F(Paper, TheOrderIsTwo) { EXPECT_NEAR(*row("order of the midpoint rule").value, 2, 0.005); }

TEST_F(Paper, MultipliersAreThoseOfTheEquations) {
  EXPECT_EQ(row("lambda on the circle").here, "(0, -1)");
  EXPECT_EQ(row("lambda at q = 0, p = (0.1, 0.3, 1)").here, "-1");
}

TEST_F(Paper, TextAndJsonHoldEveryRow) {
  const std::string text = paper_text(parts());
  Json json;
  add_paper_json(parts(), json);
  std::size_t rows = 0;
  for (const PaperPart& part : parts()) {
    EXPECT_THAT(text, HasSubstr(part.title));
    rows += part.rows.size();
    for (const PaperRow& each : part.rows) EXPECT_THAT(text, HasSubstr(each.what));
  }
  EXPECT_EQ(json["rows"].size(), rows);
}

TEST(PaperReport, ShowsWhatFails) {
  const PaperRow good{"sky", "blue", "blue"};
  const PaperRow bad{
      "sea", "blue", "grey", PaperVerdict::kFails, std::string(30, 'w') + " and why"};
  const std::vector<PaperPart> parts{{"Colours", {good, bad}}};
  EXPECT_EQ(count_failures(parts), 1U);
  EXPECT_EQ(
      paper_text(parts),
      "Colours\n-------\n     paper  here\nsky  blue   blue  holds\nsea  blue   grey  FAILS [1]\n"
      "  [1] wwwwwwwwwwwwwwwwwwwwwwwwwwwwww and why\n\n");
  Json json;
  add_paper_json(parts, json);
  EXPECT_EQ(json["rows"][1]["verdict"], "fails");
  EXPECT_TRUE(json["rows"][0]["value"].is_null());
}

// The end point at T = 10 that the Heisenberg part compares with is that of the reference file.
TEST(PaperReference, IsThatOfTheFile) {
  const test::Json file = test::own_reference("initial_values.json");
  ASSERT_FALSE(file.is_null());
  for (const test::Json& value : file["scenes"]["heisenberg_MI"]["values"]) {
    if (value["T"] != "10") continue;
    const Dynamics dynamics = paper_dynamics("heisenberg", "gauss16");
    std::vector<double> z{0, 0, 0, 0.1, 0.3, 1};
    PaperWork work({}, 1);
    work.flow(dynamics, StepPlan::of_length(0, 10, 0.25), z);
    for (std::size_t i = 0; i < 3; ++i) {
      EXPECT_NEAR(z[i], test::number(value["q"][i]), 16 * kEps);
      EXPECT_NEAR(z[i + 3], test::number(value["p"][i]), 16 * kEps);
    }
  }
}

// Growth rates of shared/reference, where it stands beside the checkout.
TEST(PaperReference, GrowthRatesOfTheCircle) {
  const test::Json file = test::shared_reference("circular_straight.json");
  if (file.is_null()) return;
  for (const test::Json& entry : file["circular"]["growth"]) {
    const CircleMotion motion{test::number(entry["alpha"]),
                              test::number(entry["beta"]),
                              test::number(entry["L"]),
                              test::number(entry["a"])};
    const double rate = test::number(entry["growth_rate_mu"]);
    EXPECT_NEAR(motion.growth_rate(), rate, 4 * kEps * rate);
  }
}

TEST(PaperCircle, DistanceIsFromAnyCircle) {
  Trajectory trajectory;
  trajectory.q = {{0, 0, 1, 1 + kPi / 2}, {0, 0, 1, 1 - kPi / 2}, {0, 0, 1, 1}};
  trajectory.p = {{0, 0, 2, 1}, {0, 0, 2, 1.5}, {0, 0, 2, 1}};
  EXPECT_NEAR(circle_distance(trajectory, 0), 0, 4 * kEps);
  EXPECT_NEAR(circle_distance(trajectory, 1), 0.5, 4 * kEps);
  EXPECT_NEAR(circle_distance(trajectory, 2), 1, 4 * kEps);
  EXPECT_NEAR(circle_excess(trajectory, 2), -kPi / 2, 4 * kEps);
}

}  // namespace
}  // namespace carnot::apps::paper_test
