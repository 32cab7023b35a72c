#include "benchmark/benchmark_reference.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>

#include "benchmark/benchmark_cache.h"
#include "command.h"
#include "testing/reference.h"

namespace carnot::apps::benchmark_reference_test {
namespace {

BenchmarkTrajectory trajectory_of(const std::string& scene) {
  for (const auto& trajectory : benchmark_trajectories()) {
    if (trajectory.scene == scene) return trajectory;
  }
  return {};
}

TEST(BenchmarkReference, AgreesWithItselfAndWithOthers) {
  const test::Json known = test::own_reference("initial_values.json");
  const auto& values = known.at("scenes").at("vehicle_cosr_alpha1_beta1_L1").at("values").back();
  ASSERT_EQ(values.at("T"), "10");
  const BenchmarkReference reference = compute_reference(trajectory_of("vehicle-cosine"), {});
  EXPECT_LT(reference.agreement, kReferenceAgreement);
  EXPECT_GT(reference.agreement, 0);  // two runs, not one
  constexpr std::size_t kDigits = 26;
  for (std::size_t i = 0; i < 4; ++i) {
    for (const bool momentum : {false, true}) {
      BenchmarkReference other;
      other.digits = {values.at(momentum ? "p" : "q").at(i).get<std::string>().substr(0, kDigits)};
      read_digits(other);
      const std::size_t k = momentum ? i + 4 : i;
      EXPECT_EQ(other.high[0], reference.high[k]);
      EXPECT_NEAR(other.low[0], reference.low[k], 1e-21);
    }
  }
}

TEST(BenchmarkReference, TellsErrorsBelowRoundOff) {
  BenchmarkReference reference;
  reference.digits = {"1.00000000000000000001", "-3"};
  read_digits(reference);
  const double exact[] = {1, -3};
  EXPECT_NEAR(reference.error(exact), 1e-20, 1e-30);
  const double wrong[] = {1, INFINITY};
  EXPECT_EQ(reference.error(wrong), INFINITY);
  reference.digits = {"one"};
  EXPECT_THROW(read_digits(reference), std::runtime_error);
}

TEST(BenchmarkReference, IsKeptInTheCache) {
  const Sandbox sandbox;
  setenv("XDG_CACHE_HOME", sandbox.directory().c_str(), 1);
  const auto trajectory = trajectory_of("vehicle");
  const BenchmarkReference made = cached_reference(trajectory, {});
  const auto directory = sandbox.directory() / "carnot";
  ASSERT_EQ(cache_directory(), directory);
  std::vector<std::filesystem::path> files;
  for (const auto& entry : std::filesystem::directory_iterator(directory)) {
    files.push_back(entry.path());
  }
  ASSERT_EQ(files.size(), 1);
  // A digit that is not the right one shows that it is read.
  auto json = nlohmann::ordered_json::parse(read_text(files[0]));
  json["digits"][0] = "0.5";
  std::ofstream(files[0]) << json;
  EXPECT_EQ(cached_reference(trajectory, {}).high[0], 0.5);
  // What was made for another problem, or is no cache at all, is made again.
  json["key"]["time"] = 11;
  std::ofstream(files[0]) << json;
  EXPECT_EQ(cached_reference(trajectory, {}).digits, made.digits);
  EXPECT_EQ(nlohmann::ordered_json::parse(read_text(files[0]))["digits"], made.digits);
}

TEST(BenchmarkReference, NeedsNoCache) {
  setenv("XDG_CACHE_HOME", "/proc/none", 1);
  EXPECT_EQ(cached_reference(trajectory_of("vehicle"), {}).digits.size(), 8);
  setenv("XDG_CACHE_HOME", "relative", 1);
  unsetenv("HOME");
  EXPECT_EQ(cache_directory(), std::nullopt);
}

TEST(BenchmarkReference, StopsWhenAsked) {
  EXPECT_THROW((void)compute_reference(trajectory_of("vehicle"), [](double) { return false; }),
               std::runtime_error);
}

}  // namespace
}  // namespace carnot::apps::benchmark_reference_test
