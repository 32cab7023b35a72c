// FNV-1a of 64 bits (Fowler, Noll and Vo), of bytes that come one after the other.
#pragma once

#include <cstdint>
#include <string_view>

namespace carnot {

class Checksum {
 public:
  void add(std::string_view bytes) {
    for (const char byte : bytes) {
      value_ = (value_ ^ static_cast<unsigned char>(byte)) * 1099511628211U;
    }
  }
  [[nodiscard]] std::uint64_t value() const { return value_; }

 private:
  std::uint64_t value_ = 14695981039346656037U;
};

}  // namespace carnot
