// The subcommands on scenes of every kind.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "command.h"

namespace carnot::apps::cli_kinds_test {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

constexpr double kEps = std::numeric_limits<double>::epsilon();

Words appell(const Words& more) {
  const Words words{"flow", "appell", "--from", "0,0,0", "--momentum", "1.2,0.5,0.7"};
  return with(with(words, {"--time", "2", "--steps", "20", "--json"}), more);
}

TEST(LagrangianScenes, LambdaPicksTheBranchAndTheFlowKeepsIt) {
  struct Case {
    const char* guess;
    double lambda;
  };
  for (const Case& c : {Case{"-0.1", -0.15}, Case{"-1.5", -5.0 / 3}}) {
    const Outcome outcome = run(appell({"--lambda", c.guess}));
    ASSERT_EQ(outcome.status, 0) << outcome.err;
    const auto json = outcome.json();
    for (const auto& lambda : json["trajectory"]["lambda"]) {
      EXPECT_NEAR(lambda[0].get<double>(), c.lambda, 64 * kEps);
    }
    EXPECT_NEAR(json["lambda"][0].get<double>(), c.lambda, 64 * kEps);
    EXPECT_LE(json["constraint_error"].get<double>(), 64 * kEps);
  }
}

TEST(LagrangianScenes, RestIsNotOfIndexOne) {
  const Outcome outcome = run({"flow",
                               "appell",
                               "--from",
                               "0,0,0",
                               "--momentum",
                               "0,0,0",
                               "--time",
                               "1",
                               "--steps",
                               "4",
                               "--json"});
  EXPECT_EQ(outcome.status, 1);
  const auto json = outcome.json();
  EXPECT_EQ(json["status"], "failed");
  EXPECT_THAT(json["message"].get<std::string>(), HasSubstr("index 1"));
}

TEST(LagrangianScenes, TimeDependenceIsSaid) {
  const Outcome outcome = run({"flow",
                               "kapitza-pendulum",
                               "--from",
                               "0.5",
                               "--momentum",
                               "0",
                               "--time",
                               "2",
                               "--step",
                               "0.01",
                               "--json"});
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  const auto json = outcome.json();
  EXPECT_EQ(json["hamiltonian_conserved"], false);
  EXPECT_GT(json["energy_drift"].get<double>(), 1e-3);
  EXPECT_LT(json["energy_balance_error"].get<double>(), 1e-10);
}

TEST(ControlScenes, GeodesicsAreFound) {
  struct Case {
    const char* scene;
    const char* from;
    const char* to;
    double action;
  };
  // Grushin: from the origin to (0, 1) by p_y = pi, half a swing: action = pi. Brockett: a circle
  // that encloses the area, action = pi |z| with this normalisation.
  for (const Case& c : {Case{"grushin", "0,0", "0,1", M_PI},
                        Case{"brockett", "0,0,0", "0,0,1", M_PI},
                        Case{"bicycle", "0,0,0,0", "1,0,0,0", 0.5}}) {
    const Outcome outcome = run({"geodesic", c.scene, "--from", c.from, "--to", c.to, "--json"});
    ASSERT_EQ(outcome.status, 0) << c.scene << ": " << outcome.out << outcome.err;
    const auto best = outcome.json()["geodesics"][0];
    EXPECT_NEAR(best["action"].get<double>(), c.action, 1e-9) << c.scene;
    EXPECT_LE(best["endpoint_error"].get<double>(), 1e-10) << c.scene;
  }
}

TEST(ControlScenes, ProblemsWithDriftAreSolved) {
  // Minimum energy from rest to rest over distance 1: cost 6 / T^3.
  const Outcome outcome = run({"geodesic",
                               "double-integrator",
                               "--from",
                               "0,0",
                               "--to",
                               "1,0",
                               "--time",
                               "2",
                               "--set",
                               "position_weight=0",
                               "--set",
                               "velocity_weight=0",
                               "--json"});
  ASSERT_EQ(outcome.status, 0) << outcome.out << outcome.err;
  const auto best = outcome.json()["geodesics"][0];
  EXPECT_NEAR(best["action"].get<double>(), 6.0 / 8, 1e-9);
  EXPECT_TRUE(best["length"].is_null());
}

TEST(HolonomicScenes, RattleIsTheirMethod) {
  const Outcome outcome = run({"flow",
                               "rod-skate",
                               "--from",
                               "0,0,1,0",
                               "--velocity",
                               "1,0,1,0",
                               "--time",
                               "1",
                               "--steps",
                               "50",
                               "--tangent",
                               "--json"});
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  const auto json = outcome.json();
  EXPECT_EQ(json["method"], "rattle");
  EXPECT_LE(json["holonomic_error"].get<double>(), 64 * kEps);
  EXPECT_LE(json["symplecticity_defect_relative"].get<double>(), 1e-13);
}

TEST(HolonomicScenes, BadInputIsRefused) {
  const Words flow{"flow", "rod-skate", "--time", "1", "--steps", "5"};
  const auto refused = [&](const Words& more, const std::string& option) {
    expect_refused(with(flow, more), HasSubstr(option));
  };
  refused({"--from", "0,0,1.1,0", "--momentum", "0,0,0,0"}, "--from");
  refused({"--from", "0,0,1,0", "--momentum", "0,0,1,0"}, "--momentum");
  refused({"--from", "0,0,1,0", "--velocity", "0,0,1,0"}, "--velocity");
  refused({"--from", "0,0,1,0", "--momentum", "0,0,0,0", "--method", "gauss16"}, "--method");
  expect_refused({"geodesic", "rod-skate", "--from", "0,0,1,0", "--to", "0,0,1.001,0"},
                 AllOf(HasSubstr("--to"), HasSubstr("holonomic")));
}

// A rod that is right to round-off is accepted in any unit of length, and one that is too long in
// none.
TEST(HolonomicScenes, AreInAnyUnit) {
  for (const std::string unit : {"e-9", "e0", "e9"}) {
    const Words flow{"flow",
                     "spherical-pendulum",
                     "--set",
                     "length=1" + unit,
                     "--set",
                     "gravity=1" + unit,
                     "--time",
                     "1",
                     "--steps",
                     "5",
                     "--momentum",
                     "0,1" + unit + ",0"};
    const Outcome right = run(with(flow, {"--from", "0.6" + unit + ",0,-0.8" + unit}));
    EXPECT_EQ(right.status, 0) << right.err;
    expect_refused(with(flow, {"--from", "0.6" + unit + ",0,-0.85" + unit}),
                   AllOf(HasSubstr("--from"), HasSubstr("relative residual 0.0335")));
  }
}

TEST(HolonomicScenes, GeodesicsAreFound) {
  // A free fall of the rod along itself would be straight; on the sphere a great circle.
  const Outcome outcome = run({"geodesic",
                               "spherical-pendulum",
                               "--set",
                               "gravity=0",
                               "--from",
                               "1,0,0",
                               "--to",
                               "0,1,0",
                               "--json"});
  ASSERT_EQ(outcome.status, 0) << outcome.out << outcome.err;
  const auto best = outcome.json()["geodesics"][0];
  EXPECT_NEAR(best["action"].get<double>(), M_PI * M_PI / 8, 1e-9);
  EXPECT_EQ(best["label"], "locally-minimal");
  EXPECT_EQ(outcome.json()["method"], "gauss16");
}

}  // namespace
}  // namespace carnot::apps::cli_kinds_test
