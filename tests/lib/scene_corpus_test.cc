// What the fuzzer has found worth keeping, read again: accepted or refused, and nothing else.
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <stdexcept>
#include <string>

#include "carnot/load_scene.h"

namespace carnot::scene_corpus_test {
namespace {

TEST(SceneCorpus, IsAcceptedOrRefused) {
  int accepted = 0;
  int refused = 0;
  const std::filesystem::path folder = CARNOT_SOURCE_DIR "/tests/fuzz/corpus";
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    std::ifstream file(entry.path(), std::ios::binary);
    const std::string text{std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
    try {
      (void)scene_from_text(text);
      ++accepted;
    } catch (const std::invalid_argument&) {
      ++refused;
    }
  }
  EXPECT_GE(accepted, 5);
  EXPECT_GE(refused, 20);
}

}  // namespace
}  // namespace carnot::scene_corpus_test
