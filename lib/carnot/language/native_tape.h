// Tapes as machine code, for this machine.
//
// The interpreter (tape_machine.h) spends most of its time on what surrounds an operation: the jump
// to the next step, loads of operands that were stored a moment ago, and addresses. The same steps,
// in the same order and with the same roundings, are one instruction each where values stay in
// registers: the results are those of the interpreter, bit for bit in arithmetic, and in sines
// where the compiler fuses no more than is written. Inputs are read where the caller has them, and
// results are written where the caller wants them.
//
// Registers are given out in one pass over the steps. Where none is left, the value that is needed
// again last gives up its register (Belady 1966, which for code without branches is close to the
// least number of loads), and goes to the slot that the tape has for it. Sines and cosines are
// written out (native_steps.h); the other functions are called, by the interpreter's own code, and
// around a call values live in their slots.
//
// Only x86-64 with AVX-512, or AVX2 and FMA, has such code, and only where the system lets a
// program make some. Elsewhere the interpreter does the same.
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <mutex>
#include <span>
#include <vector>

namespace carnot::language {

struct TapeStep;
struct TapeRows;

// What a tape is made of: its steps, where its inputs go, the slots of the results in groups, and
// how many slots there are.
struct TapeParts {
  std::span<const TapeStep> steps;
  std::span<const TapeRows> inputs;
  std::span<const std::vector<std::uint32_t>> outputs;
  int slots = 0;
};

// Of one tape. Safe to use by many threads.
class NativeTape {
 public:
  // Tape::run_rows(), with `memory` of at least bytes().
  using Code = bool (*)(const double* const* in, double* const* out, std::byte* memory);

  // Null before it is made, and where there is none.
  [[nodiscard]] Code code() const { return code_.load(std::memory_order_acquire); }
  [[nodiscard]] std::size_t bytes() const { return bytes_; }
  // Makes it, once: most tapes of a scene are never run on many points. Takes about 0.2 us a step,
  // and 20 us.
  Code make(const TapeParts& parts);

  // Where the code is.
  class Memory {
   public:
    virtual ~Memory() = default;
    [[nodiscard]] virtual Code code() const = 0;
    [[nodiscard]] virtual std::size_t bytes() const = 0;
  };

 private:
  std::once_flag once_;
  std::size_t bytes_ = 0;
  std::atomic<Code> code_ = nullptr;
  std::unique_ptr<const Memory> memory_;
};

}  // namespace carnot::language
