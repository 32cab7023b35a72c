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
