// Tapes as machine code, for this machine.
//
// The interpreter (tape_machine.h) spends most of its time on what surrounds an operation: the jump
// to the next step, loads of operands that were stored a moment ago, and addresses. The same steps,
// in the same order and with the same roundings, are one instruction each where values stay in
// registers: the results are those of the interpreter, bit for bit.
//
// Registers are given out in one pass over the steps. Where none is left, the value that is needed
// again last gives up its register (Belady 1966, which for code without branches is close to the
// least number of loads), and goes to the slot that the tape has for it. Sines, cosines and the
// rest of the functions are called, by the interpreter's own code; around a call values live in
// their slots.
//
// Only x86-64 with AVX-512, or AVX2 and FMA, has such code, and only where the system lets a
// program make some. Elsewhere the interpreter does the same.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>

#include "carnot/language/tape.h"

namespace carnot::language {

// Immutable, and safe to run by many threads.
class NativeTape {
 public:
  // Null where there is none. `outputs` are the slots of the results that are wanted, once all
  // steps are done. Takes about 0.2 us a step.
  static std::shared_ptr<const NativeTape> make(std::span<const TapeStep> steps,
                                                std::span<const std::uint32_t> outputs);

  virtual ~NativeTape() = default;
  // Does all steps on the slots in `memory`, as Tape::execute() has them.
  using Code = void (*)(std::byte* memory);
  [[nodiscard]] Code code() const { return code_; }

 protected:
  Code code_ = nullptr;
};

}  // namespace carnot::language
