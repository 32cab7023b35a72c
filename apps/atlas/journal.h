// What a long run has done so far, on disk: an append-only file of records.
//
// A record is a head of 32 bytes (magic, checksum, identity, chunk, length) and a text of lines.
// The first record says in words which call the journal belongs to, and every head has the checksum
// of these words. A call that goes on with more problems than there were says so in a record of
// words of its own. What a power cut or a full disk left of a record, and records that were damaged
// since, are found by their checksums and left out. One process at a time holds the journal
// (flock).
#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <iterator>
#include <string>
#include <string_view>
#include <vector>

#include "text/json_text.h"

namespace carnot::apps {

// What tells a call from others: an object.
struct JournalCall {
  Json words;  // in a new journal
  // Where a journal has the words `there`: what this call would have said then, and what it says
  // now that it goes on. Without them, the same as `words`.
  std::function<Json(const Json& there)> then;
  std::function<Json(const Json& there)> now;
};

class Journal {
 public:
  // Opens or makes `path`. Without `resume` there must be none; with it one of the same call is
  // read, if there is one. Throws std::invalid_argument where that is not so or another process
  // holds it, and std::runtime_error where the file cannot be used.
  Journal(const std::string& path, const JournalCall& call, bool resume);
  ~Journal();
  Journal(const Journal&) = delete;
  Journal& operator=(const Journal&) = delete;

  // What it says of the call.
  [[nodiscard]] const Json& words() const { return words_; }
  [[nodiscard]] bool holds(long chunk) const {
    return chunk < std::ssize(places_) && places_[chunk].offset >= 0;
  }
  // Of a chunk that it holds.
  [[nodiscard]] long lines(long chunk) const { return places_[chunk].lines; }
  // It does not hold this chunk any more.
  void drop(long chunk) { places_[chunk] = {}; }
  // Damaged stretches that were found.
  [[nodiscard]] long repaired() const { return repaired_; }
  // Not from two threads at once. Reaches the disk within a second. Throws std::runtime_error where
  // it cannot be written; what was there before stays.
  void append(long chunk, std::string_view text);
  // Of a chunk that it holds. Throws std::runtime_error.
  [[nodiscard]] std::string read(long chunk) const;
  // The file is not needed any more.
  void remove();

 private:
  struct Place {
    std::int64_t offset = -1;  // of the text
    std::int64_t length = 0;
    long lines = 0;
  };

  void write(std::int64_t chunk, std::string_view text);
  void scan(const JournalCall& call);
  void hold(std::int64_t chunk, std::int64_t offset, std::string_view text);
  [[noreturn]] void fail(const std::string& what) const;

  std::string path_;
  Json words_;
  int file_ = -1;
  std::uint32_t identity_ = 0;
  std::int64_t end_ = 0;
  std::vector<Place> places_;
  long repaired_ = 0;
  std::chrono::steady_clock::time_point synced_ = std::chrono::steady_clock::now();
};

}  // namespace carnot::apps
