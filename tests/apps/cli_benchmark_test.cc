#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <map>
#include <set>

#include "command.h"

namespace carnot::apps::cli_benchmark_test {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsSupersetOf;
using ::testing::UnorderedElementsAre;

TEST(Benchmark, HoldsItsContract) {
  const Sandbox sandbox;
  const std::string cache = "env XDG_CACHE_HOME=" + (sandbox.directory() / "cache").string();
  const Outcome outcome = sandbox.run({"benchmark",
                                       "heisenberg",
                                       "--quick",
                                       "--json",
                                       "--plot",
                                       "speed.png",
                                       "--output",
                                       "speed.md"},
                                      cache);
  EXPECT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_EQ(outcome.err, "");
  const auto json = outcome.json();
  EXPECT_THAT(keys(json),
              ElementsAre("version",
                          "arguments",
                          "status",
                          "message",
                          "processor",
                          "compiler",
                          "trajectories",
                          "rows",
                          "equal_error",
                          "left_out",
                          "elapsed_seconds"));
  EXPECT_EQ(json["status"], "completed");
  EXPECT_LT(json["trajectories"][0]["reference_agreement"].get<double>(), 1e-20);
  std::set<std::string> ways;
  for (const auto& row : json["rows"]) {
    EXPECT_THAT(keys(row),
                ElementsAre("scene",
                            "method",
                            "mode",
                            "peer",
                            "automatic",
                            "step_or_tolerance",
                            "error",
                            "seconds",
                            "evaluations",
                            "energy_drift"));
    EXPECT_EQ(row["scene"], "heisenberg");
    EXPECT_GT(row["seconds"].get<double>(), 0);
    EXPECT_GT(row["evaluations"].get<long>(), 0);
    EXPECT_GE(row["energy_drift"].get<double>(), 0);
    EXPECT_GT(row["error"].get<double>(), 0);
    EXPECT_EQ(row["peer"].get<bool>(), row["method"] == "dop853-adaptive");
    ways.insert(row["method"].get<std::string>() + " " + row["mode"].get<std::string>() +
                (row["automatic"].get<bool>() ? " automatic" : ""));
  }
  EXPECT_THAT(ways,
              IsSupersetOf({"midpoint single",
                            "gauss4 single",
                            "gauss16 single",
                            "gauss16 single automatic",
                            "gauss16 batch",
                            "dop853-adaptive single automatic"}));
  // A tolerance is kept: the error at the end was estimated. That of adaptive steps holds for one
  // of them.
  for (const auto& row : json["rows"]) {
    if (!row["automatic"].get<bool>() || row["peer"].get<bool>()) continue;
    const double allowed = row["mode"] == "batch" ? 1e4 : 2;
    EXPECT_LT(row["error"].get<double>(), allowed * row["step_or_tolerance"].get<double>());
  }
  EXPECT_THAT(sandbox.files(), UnorderedElementsAre("cache", "speed.md", "speed.png"));
  EXPECT_THAT(read_text(sandbox.directory() / "speed.md"),
              AllOf(HasSubstr("## heisenberg"), HasSubstr("| gauss16, batch |")));
  EXPECT_THAT(sandbox.run({"benchmark", "heisenberg", "--quick"}, cache).out,
              AllOf(HasSubstr("least error"), HasSubstr("gauss16, steps given")));
}

TEST(Benchmark, RefusesBadInput) {
  const std::map<std::vector<std::string>, std::string> cases{
      {{"benchmark", "vehicel"}, "did you mean vehicle?"},
      {{"benchmark", "unicycle"}, "vehicle-cosine, vehicle, heisenberg"},
      {{"benchmark", "vehicle", "vehicle"}, "given twice"},
      {{"benchmark", "--plot", "speed.txt"}, "--plot"},
      {{"benchmark", "--output", "speed.csv"}, "--output"}};
  for (const auto& [arguments, message] : cases) expect_refused(arguments, HasSubstr(message));
}

#ifdef CARNOT_PEERS
// Every library arrives, with an error that falls with the tolerance.
TEST(Benchmark, RunsPeers) {
  for (const std::string scene : {"vehicle", "vehicle-cosine", "heisenberg"}) {
    const auto json = run({"benchmark", scene, "--peers", "--quick", "--json"}).json();
    std::map<std::string, std::vector<double>> errors;
    for (const auto& row : json["rows"]) {
      if (row["peer"].get<bool>()) {
        errors[row["method"].get<std::string>()].push_back(row["error"].get<double>());
      }
    }
    EXPECT_THAT(json["left_out"], ElementsAre());
    EXPECT_EQ(errors.size(), 10);
    for (const auto& [method, of_method] : errors) {
      ASSERT_EQ(of_method.size(), 2) << method;
      constexpr double kFall = 100;  // of at least 1e4 / 100 when the tolerance falls by 1e4
      EXPECT_LT(of_method[1], of_method[0] / kFall) << method << " on " << scene;
    }
  }
}
#else
TEST(Benchmark, SaysHowToGetPeers) {
  expect_refused({"benchmark", "--peers"},
                 AllOf(HasSubstr("--peers"), HasSubstr("-D CARNOT_PEERS=ON")));
}
#endif

}  // namespace
}  // namespace carnot::apps::cli_benchmark_test
