// The parsers of the program's texts and files behind one call, for the fuzzer and for what it has
// found: bytes are accepted or refused, and nothing else happens.
#pragma once

#include <unistd.h>

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <stdexcept>
#include <string>
#include <string_view>

#include "atlas/journal.h"
#include "atlas/problem_list.h"
#include "catalogue/limit_choice.h"
#include "catalogue/scene_choice.h"
#include "text/numbers.h"

namespace carnot::test {

inline void expect_finite(double x) {
  if (!std::isfinite(x)) std::abort();
}

// The bytes as the journal of a run of four chunks.
inline void read_journal(std::string_view bytes) {
  const std::string path =
      std::filesystem::temp_directory_path() / ("carnot-journal-" + std::to_string(getpid()));
  std::ofstream(path, std::ios::binary) << bytes;
  try {
    apps::JournalCall call;
    call.words = {{"scene", "vehicle"}};
    apps::Journal journal(path, call, true);
    for (long chunk = 0; chunk < 4; ++chunk) {
      if (journal.holds(chunk)) (void)journal.read(chunk);
    }
    journal.append(2, "text");
    if (!journal.holds(2) || journal.read(2) != "text") std::abort();
  } catch (...) {
    std::remove(path.c_str());
    throw;
  }
  std::remove(path.c_str());
}

// The first and the last problem of a list are numbers.
inline void expect_problems(const apps::ListOptions& options) {
  static const apps::Run kRun = [] {
    apps::RunOptions of_unicycle;
    of_unicycle.scene = "unicycle";
    return apps::check(of_unicycle);
  }();
  const auto list = apps::make_problem_list(options, kRun, {});
  for (const long i : {0L, list->size() - 1}) {
    const apps::AtlasProblem problem = list->at(i);
    for (const double x : problem.ends.from) expect_finite(x);
    for (const double x : problem.ends.to) expect_finite(x);
    expect_finite(problem.ends.time);
  }
  (void)list->identity();
}

inline void read_problem_file(std::string_view bytes) {
  apps::ListOptions options;
  options.problems =
      std::filesystem::temp_directory_path() / ("carnot-problems-" + std::to_string(getpid()));
  std::ofstream(options.problems, std::ios::binary) << bytes;
  try {
    expect_problems(options);
  } catch (...) {
    std::remove(options.problems.c_str());
    throw;
  }
  std::remove(options.problems.c_str());
}

// A limit of the vehicle.
inline void read_limit(const std::string& text) {
  const apps::SceneEntry& vehicle = apps::find_scene("vehicle");
  if (apps::choose_limits(vehicle, apps::parse_parameters(vehicle, {}), {{text}, {}}).empty()) {
    std::abort();
  }
}

inline void read_grid(std::string_view text) {
  apps::ListOptions options;
  options.from = "0,0,0";
  options.to = "0,0,0";
  options.grid = text;
  expect_problems(options);
}

// True where the parser that the first byte stands for accepts the others.
inline bool reads(std::string_view bytes) {
  if (bytes.empty()) return false;
  const std::string_view text = bytes.substr(1);
  try {
    switch (bytes[0]) {
      case 'r':
        expect_finite(apps::parse_real("--time", text));
        break;
      case 'p':
        expect_finite(apps::parse_positive("--time", text));
        break;
      case 't':
        expect_finite(apps::parse_tolerance("--tolerance", text));
        break;
      case 'v':
        for (const double x : apps::parse_vector("--from", text, {"x", "y", "theta"})) {
          expect_finite(x);
        }
        break;
      case 'e':
        for (const auto& x : apps::parse_end("--to", text, {"x", "y", "theta"})) {
          expect_finite(x.value_or(0));
        }
        break;
      case 'i':
        if (std::abs(apps::parse_integer("--count", text, -7, 1000)) > 1000) std::abort();
        break;
      case 's':
        (void)apps::parse_seed("--seed", text);
        break;
      case 'j':
        read_journal(text);
        break;
      case 'l':
        read_limit(std::string(text));
        break;
      case 'd':
        for (const double x : apps::parse_disc("--disc", std::string(text))) expect_finite(x);
        break;
      case 'g':
        read_grid(text);
        break;
      case 'f':
        read_problem_file(text);
        break;
      default:
        return false;
    }
  } catch (const std::invalid_argument&) {
    return false;
  } catch (const std::runtime_error&) {  // a file that cannot be used
    return false;
  }
  return true;
}

}  // namespace carnot::test
