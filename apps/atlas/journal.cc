#include "atlas/journal.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <boost/crc.hpp>
#include <cerrno>
#include <cstring>
#include <optional>
#include <stdexcept>

#include "text/numbers.h"

namespace carnot::apps {
namespace {

constexpr std::uint32_t kMagic = 0x4a6e7263;  // "crnJ"
constexpr std::int64_t kCallRecord = -1;

struct Head {
  std::uint32_t magic = kMagic;
  std::uint32_t checksum = 0;  // of what follows and of the text
  std::uint32_t identity = 0;
  std::uint32_t unused = 0;
  std::int64_t chunk = 0;
  std::int64_t length = 0;
};
static_assert(sizeof(Head) == 32);

std::uint32_t checksum_of(std::string_view text) {
  boost::crc_32_type sum;
  sum.process_bytes(text.data(), text.size());
  return sum.checksum();
}

std::uint32_t checksum_of(const Head& head, std::string_view text) {
  constexpr std::size_t kSummed = 2 * sizeof(std::uint32_t);
  boost::crc_32_type sum;
  sum.process_bytes(reinterpret_cast<const char*>(&head) + kSummed, sizeof head - kSummed);
  sum.process_bytes(text.data(), text.size());
  return sum.checksum();
}

// `length` bytes from `offset`; fewer at the end of the file.
std::string bytes_at(int file, std::int64_t offset, std::int64_t length) {
  std::string bytes(static_cast<std::size_t>(length), '\0');
  std::size_t got = 0;
  while (got < bytes.size()) {
    const ssize_t more =
        pread(file, bytes.data() + got, bytes.size() - got, offset + static_cast<off_t>(got));
    if (more < 0 && errno == EINTR) continue;
    if (more <= 0) break;
    got += static_cast<std::size_t>(more);
  }
  bytes.resize(got);
  return bytes;
}

struct Found {
  Head head;
  std::string text;
};

// The record at `offset` of a file of `size` bytes; nothing where there is no whole one.
std::optional<Found> record_at(int file, std::int64_t offset, std::int64_t size) {
  Found found;
  const std::string bytes = bytes_at(file, offset, sizeof(Head));
  if (bytes.size() < sizeof(Head)) return std::nullopt;
  std::memcpy(&found.head, bytes.data(), sizeof(Head));
  const std::int64_t left = size - offset - static_cast<std::int64_t>(sizeof(Head));
  const Head& head = found.head;
  if (head.magic != kMagic || head.length < 0 || head.length > left) return std::nullopt;
  found.text = bytes_at(file, offset + static_cast<std::int64_t>(sizeof(Head)), head.length);
  if (checksum_of(head, found.text) != head.checksum) return std::nullopt;
  return found;
}

// Where the next magic number is, from `offset` on; `size` where there is none.
std::int64_t next_magic(int file, std::int64_t offset, std::int64_t size) {
  constexpr std::int64_t kBlock = 1 << 20;
  const std::string magic(reinterpret_cast<const char*>(&kMagic), sizeof kMagic);
  while (offset < size) {
    const std::string block = bytes_at(file, offset, kBlock);
    const std::size_t at = block.find(magic);
    if (at != std::string::npos) return offset + static_cast<std::int64_t>(at);
    if (static_cast<std::int64_t>(block.size()) < kBlock) break;
    offset += kBlock - static_cast<std::int64_t>(magic.size()) + 1;
  }
  return size;
}

// What differs first.
std::string difference(const Json& there, const Json& here) {
  for (const auto& [key, value] : here.items()) {
    const Json other = there.contains(key) ? there.at(key) : Json(nullptr);
    if (other == value) continue;
    if (other.is_object() && value.is_object()) return key + "." + difference(other, value);
    return fmt::format("{} is {} there and {} here", key, json_line(other), json_line(value));
  }
  return "it has more to say of it";
}

[[noreturn]] void refuse_other(const std::string& path, const std::string& why) {
  refuse("--resume", path, "it belongs to another call: " + why, "a journal of the same call");
}

}  // namespace

Journal::Journal(const std::string& path, const JournalCall& call, bool resume)
    : path_(path),
      words_(call.words),
      file_(open(path.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0644)),
      identity_(checksum_of(json_line(call.words))) {
  if (file_ < 0) fail("cannot open");
  try {
    if (flock(file_, LOCK_EX | LOCK_NB) != 0) {
      refuse("--output", path, "another run is writing it", "the name of another file");
    }
    struct stat status {};
    if (fstat(file_, &status) != 0) fail("cannot read");
    end_ = status.st_size;
    if (end_ > 0 && !resume) {
      refuse("--output",
             path,
             "an earlier run did not finish and left it",
             "--resume to go on, or the name of another file");
    }
    scan(call);
    const Json now = call.now ? call.now(words_) : call.words;
    if (end_ == 0 || now != words_) write(kCallRecord, json_line(now));
    words_ = now;
  } catch (...) {
    close(file_);
    throw;
  }
}

Journal::~Journal() {
  (void)fsync(file_);
  close(file_);
}

void Journal::fail(const std::string& what) const {
  throw std::runtime_error(fmt::format("{} '{}': {}", what, path_, std::strerror(errno)));
}

void Journal::scan(const JournalCall& call) {
  std::int64_t offset = 0;
  std::int64_t good = 0;  // where the last whole record ends
  while (offset < end_) {
    const std::optional<Found> found = record_at(file_, offset, end_);
    if (!found) {
      ++repaired_;
      offset = next_magic(file_, offset + 1, end_);
      while (offset < end_ && !record_at(file_, offset, end_)) {
        offset = next_magic(file_, offset + 1, end_);
      }
      continue;
    }
    const Head& head = found->head;
    if (head.chunk == kCallRecord) {
      words_ = Json::parse(found->text);
      const Json then = call.then ? call.then(words_) : call.words;
      if (then != words_) refuse_other(path_, difference(words_, then));
      if (good == 0) identity_ = head.identity;
    }
    if (head.identity != identity_) {
      refuse_other(path_, "its first record is damaged, the others are of another one");
    }
    offset += static_cast<std::int64_t>(sizeof(Head));
    if (head.chunk >= 0) hold(head.chunk, offset, found->text);
    offset += head.length;
    good = offset;
  }
  if (good < end_ && ftruncate(file_, good) != 0) fail("cannot write");
  end_ = good;
}

void Journal::hold(std::int64_t chunk, std::int64_t offset, std::string_view text) {
  if (chunk >= std::ssize(places_)) places_.resize(chunk + 1);
  places_[chunk] = {offset,
                    static_cast<std::int64_t>(text.size()),
                    static_cast<long>(std::count(text.begin(), text.end(), '\n'))};
}

void Journal::write(std::int64_t chunk, std::string_view text) {
  Head head;
  head.identity = identity_;
  head.chunk = chunk;
  head.length = static_cast<std::int64_t>(text.size());
  head.checksum = checksum_of(head, text);
  std::string bytes(reinterpret_cast<const char*>(&head), sizeof head);
  bytes += text;
  std::size_t written = 0;
  while (written < bytes.size()) {
    const ssize_t more = pwrite(
        file_, bytes.data() + written, bytes.size() - written, end_ + static_cast<off_t>(written));
    if (more < 0 && errno == EINTR) continue;
    if (more <= 0) {
      const std::string why = std::strerror(more < 0 ? errno : ENOSPC);
      (void)ftruncate(file_, end_);
      throw std::runtime_error(
          fmt::format("cannot write '{}': {}; what was done is kept there: make room, then go on "
                      "with --resume",
                      path_,
                      why));
    }
    written += static_cast<std::size_t>(more);
  }
  end_ += static_cast<std::int64_t>(bytes.size());
}

void Journal::append(long chunk, std::string_view text) {
  constexpr auto kInterval = std::chrono::seconds(1);
  const std::int64_t offset = end_ + static_cast<std::int64_t>(sizeof(Head));
  write(chunk, text);
  hold(chunk, offset, text);
  const auto now = std::chrono::steady_clock::now();
  if (now - synced_ < kInterval) return;
  if (fsync(file_) != 0) fail("cannot write");
  synced_ = now;
}

std::string Journal::read(long chunk) const {
  std::string text = bytes_at(file_, places_[chunk].offset, places_[chunk].length);
  if (static_cast<std::int64_t>(text.size()) != places_[chunk].length) fail("cannot read");
  return text;
}

void Journal::remove() { (void)unlink(path_.c_str()); }

}  // namespace carnot::apps
