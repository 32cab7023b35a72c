// What the fuzzer has found worth keeping of texts, problems and journals, read again
// (fuzz/text_fuzz.cc).
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>

#include "testing/text_parsers.h"

namespace carnot::apps::text_corpus_test {
namespace {

TEST(TextCorpus, IsAcceptedOrRefused) {
  int accepted = 0;
  int refused = 0;
  const std::filesystem::path folder = CARNOT_SOURCE_DIR "/tests/fuzz/text_corpus";
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    std::ifstream file(entry.path(), std::ios::binary);
    const std::string bytes{std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
    ++(test::reads(bytes) ? accepted : refused);
  }
  EXPECT_GE(accepted, 10);
  EXPECT_GE(refused, 10);
}

}  // namespace
}  // namespace carnot::apps::text_corpus_test
