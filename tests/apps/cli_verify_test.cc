#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <map>
#include <set>

#include "command.h"

namespace carnot::apps::cli_verify_test {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

TEST(Verify, MeasuresEachMethodOnEachScene) {
  const Outcome outcome = run({"verify",
                               "heisenberg",
                               "rod-skate",
                               "--method",
                               "gauss4,radau5,rattle",
                               "--quick",
                               "--json"});
  EXPECT_EQ(outcome.status, 0);
  EXPECT_EQ(outcome.err, "");
  const auto json = outcome.json();
  EXPECT_THAT(
      keys(json),
      ElementsAre(
          "version", "arguments", "status", "message", "scenes", "rows", "elapsed_seconds"));
  EXPECT_EQ(json["status"], "as_declared");
  EXPECT_EQ(json["message"], "");
  ASSERT_EQ(json["scenes"].size(), 2);
  EXPECT_THAT(keys(json["scenes"][0]),
              ElementsAre("scene",
                          "kind",
                          "parameters",
                          "start_time",
                          "q",
                          "p",
                          "order_time",
                          "reference_error",
                          "step",
                          "energy_step",
                          "energy_steps"));
  EXPECT_EQ(json["scenes"][0]["energy_steps"], 2000);
  EXPECT_TRUE(json["scenes"][1]["energy_step"].is_null());

  // RATTLE without holonomic constraints is the midpoint composition: taken since it is named.
  std::multiset<std::string> rows;
  for (const auto& row : json["rows"]) {
    rows.insert(row["scene"].get<std::string>() + " " + row["method"].get<std::string>());
    EXPECT_EQ(row["as_declared"], true);
    EXPECT_EQ(row["order_verdict"], "holds");
    EXPECT_NEAR(row["measured_order"].get<double>(), row["order"].get<double>(), 0.2);
    const bool symplectic = row["symplectic"].get<bool>();
    EXPECT_EQ(row["symplecticity_verdict"], symplectic ? "holds" : "breaks");
    EXPECT_EQ(row["symplecticity_defect"].get<double>() < 1e-14, symplectic);
    EXPECT_EQ(row["reversibility_defect"].get<double>() < 1e-14, row["symmetric"].get<bool>());
    EXPECT_LT(row["constraint_error"].get<double>(), 1e-13);
  }
  EXPECT_THAT(
      rows,
      ElementsAre(
          "heisenberg gauss4", "heisenberg radau5", "heisenberg rattle", "rod-skate rattle"));
}

TEST(Verify, HasOneSchemaForAllRows) {
  const auto json = run({"verify",
                         "rod-skate",
                         "kapitza-pendulum",
                         "--method",
                         "gauss4,rattle",
                         "--quick",
                         "--json"})
                        .json();
  ASSERT_FALSE(json["rows"].empty());
  for (const auto& row : json["rows"]) {
    EXPECT_THAT(keys(row), keys(json["rows"][0]));
    EXPECT_THAT(keys(row),
                ::testing::IsSupersetOf({"method",
                                         "family",
                                         "scene",
                                         "order",
                                         "measured_order",
                                         "order_standard_error",
                                         "order_correlation",
                                         "order_points",
                                         "symplecticity_defect",
                                         "reversibility_defect",
                                         "mirrored_defect",
                                         "energy_steps",
                                         "energy_error",
                                         "energy_correlation",
                                         "energy_drift",
                                         "energy_growth",
                                         "energy_verdict",
                                         "constraint_error",
                                         "holonomic_error",
                                         "midpoint_constraint_error",
                                         "constraints_verdict",
                                         "remark"}));
  }
}

TEST(Verify, TellsWhatIsExpected) {
  const Outcome outcome =
      run({"verify", "heisenberg", "--method", "midpoint,radau5,gauss16", "--quick"});
  EXPECT_EQ(outcome.status, 0);
  EXPECT_THAT(outcome.out,
              AllOf(HasSubstr("heisenberg (velocity constraints)"),
                    HasSubstr("breaks symplecticity, reversal, energy, as it must"),
                    HasSubstr("holds; order open"),
                    HasSubstr("|g(q_mid).(q1 - q0)/h| <="),
                    HasSubstr("3 of 3 rows as declared")));
}

TEST(Verify, TakesAnySceneFromAGenericStart) {
  const auto json = run({"verify", "unicycle", "--method", "gauss4", "--quick", "--json"}).json();
  ASSERT_EQ(json["rows"].size(), 1);
  EXPECT_EQ(json["rows"][0]["as_declared"], true);
  EXPECT_EQ(json["rows"][0]["energy_verdict"], "not asked");
}

TEST(Verify, DoesNotDependOnTheThreads) {
  const auto rows = [](const char* threads) {
    const Outcome outcome = run({"verify",
                                 "heisenberg",
                                 "--method",
                                 "gauss4,lobatto4,midpoint",
                                 "--steps",
                                 "1000",
                                 "--threads",
                                 threads,
                                 "--json"});
    EXPECT_EQ(outcome.err, "");
    return outcome.json()["rows"].dump();
  };
  EXPECT_EQ(rows("1"), rows("3"));
}

TEST(Verify, RefusesBadInput) {
  const std::map<std::vector<std::string>, std::string> cases{
      {{"verify", "heisenbreg"}, "did you mean heisenberg?"},
      {{"verify", "heisenberg", "heisenberg"}, "given twice"},
      {{"verify", "heisenberg", "--method", "gaus4"}, "did you mean gauss4?"},
      {{"verify", "heisenberg", "--method", "gauss4,"}, "--method"},
      {{"verify", "rod-skate", "--method", "gauss4"}, "no scene suits it"},
      {{"verify", "heisenberg", "--steps", "10"}, "--steps"},
      {{"verify", "heisenberg", "--threads", "0"}, "--threads"},
      {{"verify", "heisenberg", "--output", "audit.csv"}, "--output"}};
  for (const auto& [arguments, message] : cases) expect_refused(arguments, HasSubstr(message));
}

}  // namespace
}  // namespace carnot::apps::cli_verify_test
