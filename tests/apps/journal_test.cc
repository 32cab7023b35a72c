#include "atlas/journal.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <random>
#include <stdexcept>

#include "atlas/crew.h"
#include "command.h"

namespace carnot::apps::journal_test {
namespace {

using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

constexpr long kChunks = 6;
const Json kWords{{"version", "1"}, {"options", {{"count", "2"}}}};
const JournalCall kCall{kWords, {}, {}};

struct JournalTest : testing::Test {
  Sandbox sandbox;
  std::string path = (sandbox.directory() / "a.journal").string();

  static std::string text(long chunk) {
    std::string line(100, static_cast<char>('a' + chunk));
    line.back() = '\n';
    return line;
  }
  void fill(long count) const {
    Journal journal(path, kCall, false);
    for (long k = 0; k < count; ++k) journal.append(k, text(k));
  }
  [[nodiscard]] std::string bytes() const { return read_text(path); }
  void put(const std::string& bytes) const { std::ofstream(path, std::ios::binary) << bytes; }
  // How many chunks it holds, each as it was written.
  static long held(const Journal& journal) {
    long count = 0;
    for (long k = 0; k < kChunks; ++k) {
      if (!journal.holds(k)) continue;
      ++count;
      EXPECT_EQ(journal.read(k), text(k));
    }
    return count;
  }
};

TEST_F(JournalTest, KeepsWhatWasAppended) {
  fill(4);
  Journal journal(path, kCall, true);
  EXPECT_EQ(held(journal), 4);
  EXPECT_EQ(journal.repaired(), 0);
  journal.append(5, text(5));
  EXPECT_EQ(held(journal), 5);
  journal.remove();
  EXPECT_TRUE(sandbox.files().empty());
}

TEST_F(JournalTest, BeginsWhereThereIsNone) {
  const Journal journal(path, kCall, true);
  EXPECT_EQ(held(journal), 0);
}

TEST_F(JournalTest, RefusesOtherCallsByName) {
  fill(1);
  JournalCall other = kCall;
  other.words["options"]["count"] = "3";
  EXPECT_THAT([&] { Journal(path, other, true); },
              ThrowsMessage<std::invalid_argument>(
                  HasSubstr("options.count is \"2\" there and \"3\" here")));
  EXPECT_THAT([&] { Journal(path, kCall, false); },
              ThrowsMessage<std::invalid_argument>(HasSubstr("--resume")));
  const Journal first(path, kCall, true);
  EXPECT_THAT([&] { Journal(path, kCall, true); },
              ThrowsMessage<std::invalid_argument>(HasSubstr("another run")));
}

// Of a list that may grow at its end.
JournalCall call_of(long size) {
  const auto words = [](long of) { return Json{{"version", "1"}, {"size", of}}; };
  return {words(size),
          [=](const Json& there) { return words(std::min(size, there.at("size").get<long>())); },
          [=](const Json& /*there*/) { return words(size); }};
}

TEST_F(JournalTest, GoesOnWithMoreThanThereWas) {
  {
    Journal journal(path, call_of(10), false);
    journal.append(0, text(0));
  }
  {
    Journal journal(path, call_of(20), true);
    EXPECT_EQ(held(journal), 1);
    EXPECT_EQ(journal.words(), call_of(20).words);
    EXPECT_EQ(journal.lines(0), 1);
    journal.drop(0);
    EXPECT_FALSE(journal.holds(0));
    journal.append(0, text(0));
    journal.append(5, text(5));
  }
  EXPECT_THAT([&] { Journal(path, call_of(15), true); },
              ThrowsMessage<std::invalid_argument>(HasSubstr("size is 20 there and 15 here")));
  const Journal journal(path, call_of(20), true);
  EXPECT_EQ(held(journal), 2);
  EXPECT_EQ(journal.repaired(), 0);
}

// Of chunks of 3 the last one was of 1; there are 2 problems in it now.
TEST_F(JournalTest, SolvesTheLastChunkAgainThatHasGrown) {
  Journal journal(path, kCall, false);
  journal.append(0, "a\nb\nc\n");
  journal.append(2, "g\n");
  const CrewWork before{7, 3, {}};
  before.drop_parts(journal);
  EXPECT_EQ(before.done(journal), 4);
  const CrewWork work{8, 3, {}};
  work.drop_parts(journal);
  EXPECT_TRUE(journal.holds(0));
  EXPECT_FALSE(journal.holds(2));
  EXPECT_EQ(work.done(journal), 3);
}

// Wherever the file is cut, what was whole before is there, and it goes on.
TEST_F(JournalTest, SurvivesATornEnd) {
  fill(3);
  const std::string whole = bytes();
  for (std::size_t size = 0; size < whole.size(); size += 13) {
    put(whole.substr(0, size));
    {
      Journal journal(path, kCall, true);
      for (long k = 0; k < kChunks; ++k) {
        if (!journal.holds(k)) journal.append(k, text(k));
      }
      EXPECT_EQ(held(journal), kChunks);
    }
    const Journal again(path, kCall, true);
    EXPECT_EQ(held(again), kChunks) << size;
    EXPECT_EQ(again.repaired(), 0) << size;
  }
}

// Whichever bit is flipped, at most one record is lost, and what is left is right.
TEST_F(JournalTest, FindsFlippedBits) {
  fill(4);
  const std::string whole = bytes();
  std::mt19937 random(3);
  for (int trial = 0; trial < 300; ++trial) {
    std::string damaged = whole;
    char& byte = damaged[random() % damaged.size()];
    byte = static_cast<char>(byte ^ (1 << (random() % 8)));
    put(damaged);
    const Journal journal(path, kCall, true);
    EXPECT_GE(held(journal), 3);
    EXPECT_EQ(journal.repaired(), 1);
  }
}

}  // namespace
}  // namespace carnot::apps::journal_test
