// Formulas as straight-line programs that an interpreter runs on packs.
//
// A tape computes some expressions of a graph from the variables. Each step is one operation on
// numbers in a small memory of slots, for as many points side by side as a register of the machine
// holds. The function that does a step jumps to that of the next step, so that there is no loop
// with one unpredictable jump in it, and hands on its result in a register: a step that needs the
// result of the one before need not load it, and if nobody else needs it, it is not even stored.
// Which of its operands are in that register, in memory, or constants, is known when the tape is
// made; there is a function for each case.
//
// Jumps between functions need the optimisation of tail calls; without it (debug builds,
// sanitizers) a loop calls the same functions one after the other.
//
// A tape is immutable and can be run by many threads; each has a memory of its own, which grows to
// what the longest tape needs and then stays.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "carnot/language/expression.h"
#include "carnot/language/native_tape.h"
#include "carnot/language/variables.h"

namespace carnot::language {

// How many points are side by side in the rows of run().
inline constexpr int kTapeLanes = 8;

// Where a step finds an operand, and what it is.
struct TapeOperand {
  enum class Where : std::uint8_t { kResult, kSlot, kConstant };
  Where where = Where::kConstant;
  std::uint32_t slot = 0;
  double constant = 0;
};

enum class TapeOperation : std::uint8_t {
  kAdd,       // a + b
  kSubtract,  // a - b
  kMultiply,  // a b
  kDivide,    // a / b
  kFused,     // c + a b
  kNegated,   // c - a b
  kCopy,      // a
  kSqrt,
  kSin,
  kCos,
  kSinCos,    // sin a, and cos a into a second slot
  kFunction,  // another one of expression.h, number by number
  kAtan2,
};

// One step, before it is bound to the functions that do it.
struct TapeStep {
  TapeOperation operation = TapeOperation::kCopy;
  Operation function = Operation::kOne;  // of kFunction
  int index = 0;                         // of its function
  TapeOperand a;
  TapeOperand b;
  TapeOperand c;
  bool stored = false;
  std::uint32_t to = 0;
  std::uint32_t second = 0;
};

// Rows of a group that go into neighbouring slots.
struct TapeRows {
  std::uint32_t group = 0;
  std::uint32_t row = 0;
  std::uint32_t slot = 0;
  std::uint32_t count = 0;
};

// A step as the interpreter reads it. Slots are offsets in bytes.
struct TapeInstruction {
  union Operand {
    std::uint64_t slot;
    double constant;
  };
  void (*handler)() = nullptr;  // a TapeMachine::Handler
  std::array<Operand, 3> operands{};
  std::uint32_t to = 0;
  std::uint32_t second = 0;
};

class Tape {
 public:
  Tape() = default;
  // The variables come in groups, blocks of those of the graph that the expressions depend on, and
  // so do the outputs: run() takes a pointer to the numbers of each group. `outputs` are all of
  // them in order, `output_groups` how many are in each group.
  Tape(Graph& graph,
       std::span<const Block> inputs,
       std::span<const Expression> outputs,
       std::span<const int> output_groups);

  // At one point. `in` and `out` have a pointer for each group, in memory of the caller; null for
  // groups of which nothing is used, or wanted. Returns whether all the results that are wanted are
  // finite.
  bool run(std::span<const double* const> in, std::span<double* const> out) const;
  // At kTapeLanes points side by side: number k of a group is row k of kTapeLanes numbers.
  bool run_rows(std::span<const double* const> in, std::span<double* const> out) const {
    const NativeTape::Code code = native_->code();
    if (code == nullptr || native_->bytes() > kRoom) return run_rows_at_length(in, out);
    alignas(64) std::array<std::byte, kRoom> memory;
    return code(in.data(), out.data(), memory.data());
  }

  // How many steps there are, and slots.
  [[nodiscard]] int steps() const { return static_cast<int>(steps_.size()); }
  [[nodiscard]] int slots() const { return slots_; }

  // Bytes that a run may take of the stack.
  static constexpr std::size_t kRoom = 16384;

 private:
  // Makes machine code, interprets, or takes more memory.
  bool run_rows_at_length(std::span<const double* const> in, std::span<double* const> out) const;

  friend class TapeBuilder;
  template <class V, bool tail_calls>
  friend struct TapeMachine;
  template <class V>
  friend struct TapeOn;

  std::vector<TapeStep> steps_;
  std::vector<TapeRows> in_;
  std::vector<std::vector<std::uint32_t>> out_;  // the slots of each group
  int slots_ = 0;
  std::vector<TapeInstruction> single_;  // for one number
  std::vector<TapeInstruction> wide_;    // for registers
  std::shared_ptr<NativeTape> native_;   // in place of wide_, where there is one
};

}  // namespace carnot::language
