#include "carnot/language/native_steps.h"

#include <algorithm>

#include "carnot/numerics/pack.h"

namespace carnot::language {

// A number of a formula that is written for registers, which becomes steps.
class RecordedNumber {
 public:
  using N = RecordedNumber;
  explicit RecordedNumber(double constant) : operand_{NativeOperand::kNoValue, constant} {}
  RecordedNumber(NativeSteps& steps, const NativeOperand& operand)
      : steps_(&steps), operand_(operand) {}

  [[nodiscard]] const NativeOperand& operand() const { return operand_; }

  friend N operator+(const N& a, const N& b) { return step(NativeOperation::kAdd, a, b); }
  friend N operator-(const N& a, const N& b) { return step(NativeOperation::kSubtract, a, b); }
  friend N operator*(const N& a, const N& b) { return step(NativeOperation::kMultiply, a, b); }
  friend N operator-(const N& a) { return N(-0.0) - a; }
  friend N fma(const N& a, const N& b, const N& c) {
    return step(NativeOperation::kFused, a, b, c);
  }
  friend N fnma(const N& a, const N& b, const N& c) {
    return step(NativeOperation::kNegated, a, b, c);
  }
  friend N nan_beyond(const N& x, const N& r) { return step(NativeOperation::kNanBeyond, r, x); }
  friend pack_lane::SinCos<N> turned(const N& shifted, const pack_lane::SinCos<N>& x) {
    return {step(NativeOperation::kTurnedSin, x.sin, x.cos, shifted),
            step(NativeOperation::kTurnedCos, x.sin, x.cos, shifted)};
  }

 private:
  static N step(NativeOperation operation, const N& a, const N& b, const N& c = N(0.0)) {
    NativeSteps& steps = a.steps_ != nullptr   ? *a.steps_
                         : b.steps_ != nullptr ? *b.steps_
                                               : *c.steps_;
    const int result =
        steps.add_step(operation, {a.operand_, b.operand_, c.operand_}, NativeOperand::kNoValue);
    return {steps, {result, 0}};
  }

  NativeSteps* steps_ = nullptr;  // null: a constant
  NativeOperand operand_;
};

namespace {

NativeOperation native(TapeOperation operation) {
  switch (operation) {
    case TapeOperation::kAdd:
      return NativeOperation::kAdd;
    case TapeOperation::kSubtract:
      return NativeOperation::kSubtract;
    case TapeOperation::kMultiply:
      return NativeOperation::kMultiply;
    case TapeOperation::kDivide:
      return NativeOperation::kDivide;
    case TapeOperation::kFused:
      return NativeOperation::kFused;
    case TapeOperation::kNegated:
      return NativeOperation::kNegated;
    case TapeOperation::kCopy:
      return NativeOperation::kCopy;
    case TapeOperation::kSqrt:
      return NativeOperation::kSqrt;
    default:
      return NativeOperation::kCall;
  }
}

bool is_circular(TapeOperation operation) {
  return operation == TapeOperation::kSin || operation == TapeOperation::kCos ||
         operation == TapeOperation::kSinCos;
}

}  // namespace

NativeSteps::NativeSteps(const TapeParts& tape) {
  for (const TapeRows& rows : tape.inputs) {
    for (std::uint32_t i = 0; i < rows.count; ++i) {
      here_[rows.slot + i] = add_value(static_cast<int>(rows.slot + i));
      inputs_.push_back({rows.group, rows.row + i});
    }
  }
  for (const TapeStep& s : tape.steps) {
    const auto operand = [&](const TapeOperand& x) -> NativeOperand {
      if (x.where == TapeOperand::Where::kResult) return {last_, 0};
      if (x.where == TapeOperand::Where::kSlot) return {here_.at(x.slot), 0};
      return {NativeOperand::kNoValue, x.constant};
    };
    if (is_circular(s.operation)) {
      add_sines(s, operand(s.a));
    } else {
      last_ = add_step(native(s.operation),
                       {operand(s.a), operand(s.b), operand(s.c)},
                       s.stored ? static_cast<int>(s.to) : NativeOperand::kNoValue);
      if (steps_.back().operation == NativeOperation::kCall) steps_.back().called = &s;
    }
    if (s.stored) here_[s.to] = last_;
  }
  wanted_.resize(uses_.size());
  for (std::uint32_t group = 0; group < tape.outputs.size(); ++group) {
    for (std::uint32_t row = 0; row < tape.outputs[group].size(); ++row) {
      wanted_[here_.at(tape.outputs[group][row])].push_back({group, row});
    }
  }
}

int NativeSteps::next_use(int value, int i) const {
  const std::vector<int>& uses = uses_[value];
  const auto next = std::upper_bound(uses.begin(), uses.end(), i);
  return next == uses.end() ? kNever : *next;
}

int NativeSteps::add_value(int slot) {
  uses_.emplace_back();
  slots_.push_back(slot);
  return count() - 1;
}

int NativeSteps::add_step(NativeOperation operation,
                          const std::array<NativeOperand, 3>& operands,
                          int slot) {
  for (const NativeOperand& operand : operands) {
    if (operand.is_value()) uses_[operand.value].push_back(static_cast<int>(steps_.size()));
  }
  steps_.push_back({operation, operands, add_value(slot), nullptr});
  return steps_.back().result;
}

void NativeSteps::add_sines(const TapeStep& s, const NativeOperand& angle) {
  const auto both = pack_lane::sin_cos(RecordedNumber(*this, angle));
  last_ = (s.operation == TapeOperation::kCos ? both.cos : both.sin).operand().value;
  if (s.stored) slots_[last_] = static_cast<int>(s.to);
  if (s.operation != TapeOperation::kSinCos) return;
  here_[s.second] = both.cos.operand().value;
  slots_[both.cos.operand().value] = static_cast<int>(s.second);
}

}  // namespace carnot::language
