// A tape on registers of another type than those of its own, and always by the interpreter.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "carnot/language/tape_machine.h"

namespace carnot::language {

// A friend of Tape.
template <class V>
struct TapeOn {
  explicit TapeOn(const Tape& of) : tape(of), code(TapeMachine<V>::bind(of)) {}
  bool run_rows(std::span<const double* const> in, std::span<double* const> out) const {
    return TapeMachine<V>::template run<kTapeLanes>(
        tape, [&](std::byte* memory) { TapeMachine<V>::execute(code.data(), memory); }, in, out);
  }
  // Whether the tape itself, once it has been run, is machine code.
  [[nodiscard]] bool is_native() const { return tape.native_->code() != nullptr; }

  const Tape& tape;
  std::vector<TapeInstruction> code;
};

}  // namespace carnot::language
