// Numbers as bytes and back, for what a computation is kept in to go on from on the same machine.
#pragma once

#include <cstddef>
#include <cstdint>
#include <istream>
#include <ostream>
#include <span>
#include <stdexcept>
#include <string_view>
#include <type_traits>
#include <vector>

#include "carnot/numerics/checksum.h"

namespace carnot::internal {

template <class T>
concept Bytes = std::is_trivially_copyable_v<T>;

class ByteWriter {
 public:
  // Keeps a reference.
  explicit ByteWriter(std::ostream& out) : out_(out) {}

  template <Bytes T>
  void add(const T& value) {
    add(reinterpret_cast<const char*>(&value), sizeof(T));
  }
  template <Bytes T>
  void add(const std::vector<T>& values) {
    add(static_cast<std::uint64_t>(values.size()));
    add(reinterpret_cast<const char*>(values.data()), values.size() * sizeof(T));
  }
  // Without their number.
  template <Bytes T>
  void add_all(std::span<const T> values) {
    add(reinterpret_cast<const char*>(values.data()), values.size_bytes());
  }
  // Adds the checksum of all.
  void finish() { add(checksum_.value()); }

 private:
  void add(const char* bytes, std::size_t count) {
    checksum_.add({bytes, count});
    out_.write(bytes, static_cast<std::streamsize>(count));
  }

  std::ostream& out_;
  Checksum checksum_;
};

// Bytes are missing, or are not those that were written.
class DamagedBytes : public std::runtime_error {
 public:
  DamagedBytes() : std::runtime_error("the state of a field is damaged") {}
};

// Everything throws DamagedBytes.
class ByteReader {
 public:
  // Keeps a reference.
  explicit ByteReader(std::istream& in) : in_(in) {}

  template <Bytes T>
  T take() {
    T value{};
    take(reinterpret_cast<char*>(&value), sizeof(T));
    return value;
  }
  // At most so many: no memory is taken for a size that is damaged.
  template <Bytes T>
  std::vector<T> take_all(std::size_t most) {
    const auto size = take<std::uint64_t>();
    if (size > most) fail();
    std::vector<T> values(size);
    take(reinterpret_cast<char*>(values.data()), size * sizeof(T));
    return values;
  }
  // As many as there are.
  template <Bytes T>
  void take_into(std::span<T> values) {
    take(reinterpret_cast<char*>(values.data()), values.size_bytes());
  }
  // What was written last is the checksum.
  void finish() {
    const std::uint64_t sum = checksum_.value();
    if (take<std::uint64_t>() != sum) fail();
  }
  [[noreturn]] static void fail() { throw DamagedBytes(); }

 private:
  void take(char* bytes, std::size_t count) {
    if (!in_.read(bytes, static_cast<std::streamsize>(count))) fail();
    checksum_.add({bytes, count});
  }

  std::istream& in_;
  Checksum checksum_;
};

}  // namespace carnot::internal
