// The face of shooting: what is installed, and what it includes.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <regex>
#include <set>
#include <sstream>
#include <string>
#include <vector>

namespace carnot::face_test {
namespace {

namespace fs = std::filesystem;

std::string text_of(const fs::path& file) {
  std::ifstream in(file);
  EXPECT_TRUE(in) << file;
  std::ostringstream text;
  text << in.rdbuf();
  return text.str();
}

// All that the pattern's first group matches.
std::vector<std::string> all(const std::string& text, const std::string& pattern) {
  const std::regex expression(pattern);
  std::vector<std::string> found;
  for (auto at = std::sregex_iterator(text.begin(), text.end(), expression);
       at != std::sregex_iterator();
       ++at) {
    found.push_back((*at)[1]);
  }
  return found;
}

const fs::path& root() {
  static const fs::path kRoot = CARNOT_SOURCE_DIR;
  return kRoot;
}

// The headers that shooting/CMakeLists.txt installs, as they are included.
std::set<std::string> face() {
  const auto list =
      all(text_of(root() / "shooting/CMakeLists.txt"), R"(\s(carnot/shooting/[a-z_/]+\.h))");
  return {list.begin(), list.end()};
}

// Every header that `header` includes, directly or not.
void collect(const std::string& header, std::set<std::string>& seen) {
  if (!seen.insert(header).second) return;
  for (const char* const layer : {"shooting", "lib"}) {
    const fs::path file = root() / layer / header;
    if (!fs::exists(file)) continue;
    for (const std::string& next : all(text_of(file), R"(#include [<"]([^>"]+)[>"])")) {
      collect(next, seen);
    }
  }
}

TEST(Face, HoldsTheHeadersThatUsersInclude) {
  EXPECT_THAT(face(),
              testing::IsSupersetOf({"carnot/shooting/boundary_value_problem.h",
                                     "carnot/shooting/continuation.h",
                                     "carnot/shooting/find_geodesics.h",
                                     "carnot/shooting/steering_function.h",
                                     "carnot/shooting/warm_start.h"}));
}

TEST(Face, IncludesNeitherEigenNorInternals) {
  for (const std::string& header : face()) {
    std::set<std::string> seen;
    collect(header, seen);
    for (const std::string& other : seen) {
      EXPECT_FALSE(other.starts_with("Eigen/")) << header;
      if (other.starts_with("carnot/shooting/")) {
        EXPECT_TRUE(face().contains(other)) << header << " includes " << other;
      }
    }
  }
}

TEST(Face, OthersAreInternal) {
  for (const auto& entry : fs::recursive_directory_iterator(root() / "shooting")) {
    if (entry.path().extension() != ".h") continue;
    const std::string name = fs::relative(entry.path(), root() / "shooting").generic_string();
    const bool internal =
        text_of(entry.path()).find("namespace carnot::internal {") != std::string::npos;
    EXPECT_NE(internal, face().contains(name)) << name;
  }
}

}  // namespace
}  // namespace carnot::face_test
