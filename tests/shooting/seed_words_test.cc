#include "carnot/shooting/search/seed_words.h"

#include <gtest/gtest.h>

#include <initializer_list>
#include <random>
#include <vector>

namespace carnot::internal::seed_words_test {
namespace {

// One route against the other: short and long requests, which have other strides.
void expect_standard(std::initializer_list<std::uint64_t> words) {
  for (const int count : {0, 1, 2, 6, 7, 10, 38, 39, 67, 68, 100, 622, 623, 624, 1000}) {
    std::vector<std::uint32_t> expected(count);
    std::seed_seq(words).generate(expected.begin(), expected.end());
    std::vector<std::uint32_t> own(count);
    SeedWords(words).generate(own.begin(), own.end());
    EXPECT_EQ(own, expected) << words.size() << " words, " << count;
  }
}

TEST(SeedWords, AreThoseOfTheStandardLibrary) {
  const std::uint64_t large = 0xfedcba9876543210U;
  expect_standard({});
  expect_standard({7});
  expect_standard({large, large >> 32U, 5});
  expect_standard({1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11});  // more than are asked for
}

TEST(SeedWords, SeedAGenerator) {
  SeedWords words{1, 2, 3};
  std::seed_seq sequence{1, 2, 3};
  EXPECT_EQ(std::mt19937_64(words), std::mt19937_64(sequence));
}

}  // namespace
}  // namespace carnot::internal::seed_words_test
