// The steps of a tape for a processor: values take the place of slots, which hold one value after
// the other, and sines and cosines become the steps of pack_lane::sin_cos().
#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <span>
#include <unordered_map>
#include <vector>

#include "carnot/language/native_tape.h"
#include "carnot/language/tape.h"

namespace carnot::language {

enum class NativeOperation : std::uint8_t {
  kAdd,        // a + b
  kSubtract,   // a - b
  kMultiply,   // a b
  kDivide,     // a / b
  kFused,      // c + a b
  kNegated,    // c - a b
  kCopy,       // a
  kSqrt,       // of a
  kNanBeyond,  // a, or NaN where |b| > kLargestAngle
  kTurnedSin,  // see pack_lane::turned(): a is the sine, b the cosine, c the shifted angle
  kTurnedCos,
  kCall,  // of the interpreter's function
};

// A value, or a constant.
struct NativeOperand {
  static constexpr int kNoValue = -1;
  int value = kNoValue;
  double constant = 0;
  [[nodiscard]] bool is_value() const { return value != kNoValue; }
};

struct NativeStep {
  NativeOperation operation = NativeOperation::kCopy;
  std::array<NativeOperand, 3> operands{};
  int result = NativeOperand::kNoValue;
  const TapeStep* called = nullptr;  // of kCall
};

class NativeSteps {
 public:
  static constexpr int kNever = std::numeric_limits<int>::max();

  explicit NativeSteps(const TapeParts& tape);

  [[nodiscard]] std::span<const NativeStep> steps() const { return steps_; }
  // How many values there are. The first ones are the inputs.
  [[nodiscard]] int count() const { return static_cast<int>(uses_.size()); }

  // A row of a group.
  struct Row {
    std::uint32_t group = 0;
    std::uint32_t row = 0;
  };
  [[nodiscard]] std::span<const Row> inputs() const { return inputs_; }
  [[nodiscard]] bool is_input(int value) const { return value < std::ssize(inputs_); }
  // Where a value is wanted as a result.
  [[nodiscard]] std::span<const Row> wanted(int value) const { return wanted_[value]; }
  // The slot that the tape has for a value; negative: none.
  [[nodiscard]] int slot(int value) const { return slots_[value]; }
  // The first step after step i that needs a value, or kNever.
  [[nodiscard]] int next_use(int value, int i) const;

 private:
  friend class RecordedNumber;

  int add_value(int slot);
  int add_step(NativeOperation operation, const std::array<NativeOperand, 3>& operands, int slot);
  void add_sines(const TapeStep& s, const NativeOperand& angle);

  std::vector<NativeStep> steps_;
  std::vector<std::vector<int>> uses_;  // the steps that need a value, in order
  std::vector<int> slots_;
  std::vector<Row> inputs_;
  std::vector<std::vector<Row>> wanted_;
  std::unordered_map<std::uint32_t, int> here_;  // what a slot holds
  int last_ = NativeOperand::kNoValue;           // the result of the step before
};

}  // namespace carnot::language
