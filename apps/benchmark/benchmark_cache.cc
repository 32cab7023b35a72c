#include "benchmark/benchmark_cache.h"

#include <fmt/format.h>

#include <cstdlib>
#include <fstream>
#include <iterator>
#include <stdexcept>
#include <system_error>

#include "catalogue/scene_choice.h"
#include "text/json_text.h"
#include "text/output_file.h"
#include "text/version.h"

namespace carnot::apps {
namespace {

namespace fs = std::filesystem;

// All that the digits depend on.
Json key_of(const BenchmarkTrajectory& trajectory) {
  Json parameters = Json::object();
  for (const ParameterInfo& parameter : find_scene(trajectory.scene).parameters) {
    parameters[parameter.name] = parameter.default_value;
  }
  return {{"version", kVersion},
          {"scene", std::string(trajectory.scene)},
          {"parameters", parameters},
          {"start", benchmark_start<double>(trajectory)},
          {"time", trajectory.duration}};
}

// Nothing where the file is missing or not what it should be.
std::optional<BenchmarkReference> read_cache(const fs::path& path, const Json& key) {
  std::ifstream file(path, std::ios::binary);
  const std::string text{std::istreambuf_iterator<char>(file), {}};
  try {
    const Json json = Json::parse(text);
    if (json.at("key") != key) return std::nullopt;
    BenchmarkReference reference;
    reference.digits = json.at("digits").get<std::vector<std::string>>();
    reference.agreement = json.at("agreement").get<double>();
    if (reference.digits.size() != key.at("start").size()) return std::nullopt;
    if (!(reference.agreement < kReferenceAgreement)) return std::nullopt;
    read_digits(reference);
    return reference;
  } catch (const std::exception&) {
    return std::nullopt;
  }
}

void write_cache(const fs::path& path, const Json& key, const BenchmarkReference& reference) {
  std::error_code error;
  fs::create_directories(path.parent_path(), error);
  if (error) return;
  const Json json{{"key", key}, {"agreement", reference.agreement}, {"digits", reference.digits}};
  try {
    write_file(path.string(), json_text(json));
  } catch (const std::runtime_error&) {
    return;  // computed again next time
  }
}

}  // namespace

std::optional<fs::path> cache_directory() {
  const auto named = [](const char* variable) {
    const char* const value = std::getenv(variable);
    return fs::path(value == nullptr ? "" : value);
  };
  const fs::path cache = named("XDG_CACHE_HOME");
  if (cache.is_absolute()) return cache / "carnot";  // others are to be ignored, says the standard
  const fs::path home = named("HOME");
  if (home.is_absolute()) return home / ".cache" / "carnot";
  return std::nullopt;
}

BenchmarkReference cached_reference(const BenchmarkTrajectory& trajectory,
                                    const Progress& progress) {
  const auto directory = cache_directory();
  if (!directory) return compute_reference(trajectory, progress);
  const fs::path path =
      *directory / fmt::format("benchmark-{}-{}.json", trajectory.scene, kVersion);
  const Json key = key_of(trajectory);
  if (const auto known = read_cache(path, key)) return *known;
  BenchmarkReference reference = compute_reference(trajectory, progress);
  write_cache(path, key, reference);
  return reference;
}

}  // namespace carnot::apps
