#include "carnot/language/native_tape.h"

#ifdef CARNOT_NATIVE_TAPES

#include <xbyak/xbyak.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cassert>
#include <exception>
#include <map>
#include <type_traits>
#include <unordered_map>
#include <utility>
#include <vector>

#include "carnot/language/tape_machine.h"

namespace carnot::language {
namespace {

// The registers of the interpreter, as the assembler calls them. Without fused multiplications
// there is no such code.
template <class V>
struct Machine {
  static constexpr bool exists = false;
};
#if XSIMD_WITH_AVX512F
template <class V>
requires(sizeof(V) == 64) struct Machine<V> {
  static constexpr bool exists = true;
  using Register = Xbyak::Zmm;
  static constexpr int kRegisters = 32;
};
#endif
#if XSIMD_WITH_FMA3_AVX2
template <>
struct Machine<xsimd::batch<double, xsimd::fma3<xsimd::avx2>>> {
  static constexpr bool exists = true;
  using Register = Xbyak::Ymm;
  static constexpr int kRegisters = 16;
};
#endif

constexpr int kNone = -1;

// The steps with names for values instead of places: a slot holds one value after the other.
class Values {
 public:
  struct Step {
    std::array<int, 3> operands{kNone, kNone, kNone};  // kNone: a constant, or not there
    int result = kNone;
    int second = kNone;
  };

  // A row of a group.
  struct Row {
    std::uint32_t group = 0;
    std::uint32_t row = 0;
  };

  explicit Values(const TapeParts& tape) {
    for (const TapeRows& rows : tape.inputs) {
      for (std::uint32_t i = 0; i < rows.count; ++i) {
        here_[rows.slot + i] = add(rows.slot + i);
        inputs_.push_back({rows.group, rows.row + i});
      }
    }
    int last = kNone;
    for (const TapeStep& s : tape.steps) {
      Step step;
      const std::array operands{s.a, s.b, s.c};
      for (std::size_t i = 0; i < operands.size(); ++i) {
        if (operands[i].where == TapeOperand::Where::kResult) step.operands[i] = last;
        if (operands[i].where == TapeOperand::Where::kSlot)
          step.operands[i] = here_.at(operands[i].slot);
        if (step.operands[i] != kNone) {
          uses_[step.operands[i]].push_back(static_cast<int>(steps_.size()));
        }
      }
      if (s.operation == TapeOperation::kSinCos) step.second = here_[s.second] = add(s.second);
      step.result = add(s.to);
      if (s.stored) here_[s.to] = step.result;
      last = step.result;
      steps_.push_back(step);
    }
    wanted_.resize(uses_.size());
    for (std::uint32_t group = 0; group < tape.outputs.size(); ++group) {
      for (std::uint32_t row = 0; row < tape.outputs[group].size(); ++row) {
        wanted_[here_.at(tape.outputs[group][row])].push_back({group, row});
      }
    }
  }

  [[nodiscard]] int count() const { return static_cast<int>(uses_.size()); }
  [[nodiscard]] const Step& step(int i) const { return steps_[i]; }
  [[nodiscard]] std::uint32_t slot(int value) const { return slots_[value]; }
  // The first values are the inputs: where they are.
  [[nodiscard]] std::span<const Row> inputs() const { return inputs_; }
  // Where it is wanted as a result.
  [[nodiscard]] std::span<const Row> wanted(int value) const { return wanted_[value]; }
  // The first step after step i that needs it; a large number where none does.
  [[nodiscard]] int next_use(int value, int i) const {
    const std::vector<int>& uses = uses_[value];
    const auto next = std::upper_bound(uses.begin(), uses.end(), i);
    return next == uses.end() ? kNever : *next;
  }
  static constexpr int kNever = std::numeric_limits<int>::max();

 private:
  int add(std::uint32_t slot) {
    uses_.emplace_back();
    slots_.push_back(slot);
    return count() - 1;
  }

  std::vector<Step> steps_;
  std::vector<std::vector<int>> uses_;  // the steps that need a value, in order
  std::vector<std::uint32_t> slots_;
  std::vector<Row> inputs_;
  std::vector<std::vector<Row>> wanted_;
  std::unordered_map<std::uint32_t, int> here_;  // what a slot holds
};

bool is_called(const TapeStep& s) {
  switch (s.operation) {
    case TapeOperation::kSin:
    case TapeOperation::kCos:
    case TapeOperation::kSinCos:
    case TapeOperation::kFunction:
    case TapeOperation::kAtan2:
      return true;
    default:
      return false;
  }
}

// Writes the code of a tape, a NativeTape::Code. rbx is `memory`, r12 `in` and r13 `out`. Two
// registers add up 0 x for the results x that are wanted: zero where all of them are finite.
template <class V>
class Writer {
 public:
  // `calls` are those of the steps that are called, and stay where they are.
  Writer(const TapeParts& tape,
         const std::vector<TapeInstruction>& calls,
         Xbyak::CodeGenerator& code)
      : tape_(tape),
        calls_(calls),
        code_(code),
        values_(tape),
        register_of_(values_.count(), kNone),
        in_slot_(values_.count(), false) {
    value_in_.fill(kNone);
  }

  void write() {
    const std::array kept{code_.rbx, code_.r12, code_.r13};  // and the stack is aligned for calls
    for (const auto& x : kept) code_.push(x);
    code_.mov(code_.r12, code_.rdi);
    code_.mov(code_.r13, code_.rsi);
    code_.mov(code_.rbx, code_.rdx);
    clear_sums();
    for (int value = 0; value < std::ssize(values_.inputs()); ++value) {
      if (values_.wanted(value).empty()) continue;
      code_.vmovupd(reg(0), home_of(value));
      deliver(value, 0);
    }
    std::size_t calls = 0;
    for (step_ = 0; step_ < std::ssize(tape_.steps); ++step_) {
      if (is_called(tape_.steps[step_])) {
        call_function(calls_[calls++]);
      } else {
        compute();
      }
    }
    return_whether_finite();
    code_.vzeroupper();
    for (auto x = kept.rbegin(); x != kept.rend(); ++x) code_.pop(*x);
    code_.ret();
    code_.align(kWidth);
    code_.L(pool_);
    for (const double constant : constants_) {
      for (int l = 0; l < kLanes; ++l) code_.dq(std::bit_cast<std::uint64_t>(constant));
    }
    code_.ready(Xbyak::CodeGenerator::PROTECT_RE);
  }

 private:
  using Register = typename Machine<V>::Register;
  static constexpr int kWidth = sizeof(V);
  static constexpr int kLanes = kWidth / sizeof(double);
  static constexpr int kRow = kTapeLanes * sizeof(double);
  static constexpr int kSums = NativeTape::kSums;
  static constexpr int kFree = Machine<V>::kRegisters - kSums - 1;  // for values
  static constexpr int kZero = kFree + kSums;

  // An operand of this step: a register, or a place in memory.
  struct Place {
    int index = kNone;  // of the register
    Xbyak::Address address{0};
    bool ends = false;  // nobody needs what is in the register after this step
    [[nodiscard]] bool is_register() const { return index != kNone; }
  };

  [[nodiscard]] static Register reg(int index) { return Register(index); }
  Xbyak::Address at_slot(std::uint32_t slot) {
    return code_.ptr[code_.rbx + static_cast<int>(slot * kWidth)];
  }
  // Where a value that is in no register is. That of an input takes an instruction, and rax.
  Xbyak::Address home_of(int value) {
    if (value >= std::ssize(values_.inputs())) return at_slot(values_.slot(value));
    const auto [group, row] = values_.inputs()[value];
    code_.mov(code_.rax, code_.ptr[code_.r12 + static_cast<int>(group * sizeof(double*))]);
    return code_.ptr[code_.rax + static_cast<int>(row * kRow)];
  }
  Xbyak::Address constant_at(double x) {
    const auto [place, is_new] =
        places_.try_emplace(std::bit_cast<std::uint64_t>(x), static_cast<int>(constants_.size()));
    if (is_new) constants_.push_back(x);
    return code_.ptr[code_.rip + pool_ + place->second * kWidth];
  }

  // Into its slot. That of an input is only wanted for a call, which takes the zero anyway.
  void store(int value) {
    if (in_slot_[value]) return;
    if (register_of_[value] == kNone) {  // an input
      code_.vmovupd(reg(kZero), home_of(value));
      code_.vmovupd(at_slot(values_.slot(value)), reg(kZero));
    } else {
      code_.vmovupd(at_slot(values_.slot(value)), reg(register_of_[value]));
    }
    in_slot_[value] = true;
  }
  void release(int index) {
    if (value_in_[index] != kNone) register_of_[value_in_[index]] = kNone;
    value_in_[index] = kNone;
  }
  void hold(int index, int value) {
    release(index);
    value_in_[index] = value;
    register_of_[value] = index;
  }

  // ---- results

  void clear_sums() {
    code_.vxorpd(reg(kZero), reg(kZero), reg(kZero));
    for (int i = 0; i < kSums; ++i) code_.vmovapd(reg(kFree + i), reg(kZero));
  }
  // To all rows that it is wanted in, of groups that are wanted.
  void deliver(int value, int index) {
    for (const auto& [group, row] : values_.wanted(value)) {
      Xbyak::Label next;
      code_.mov(code_.rcx, code_.ptr[code_.r13 + static_cast<int>(group * sizeof(double*))]);
      code_.test(code_.rcx, code_.rcx);
      code_.jz(next);
      code_.vmovupd(code_.ptr[code_.rcx + static_cast<int>(row * kRow)], reg(index));
      code_.vfmadd231pd(reg(kFree + delivered_++ % kSums), reg(kZero), reg(index));
      code_.L(next);
    }
  }
  void return_whether_finite() {
    const Register sum = reg(kFree);
    code_.vaddpd(sum, sum, reg(kFree + 1));
    if constexpr (std::is_same_v<Register, Xbyak::Zmm>) {
      code_.vcmpeqpd(code_.k1, sum, reg(kZero));
      code_.kmovw(code_.eax, code_.k1);
    } else {
      code_.vcmpeqpd(sum, sum, reg(kZero));
      code_.vmovmskpd(code_.eax, sum);
    }
    code_.cmp(code_.eax, (1 << kLanes) - 1);
    code_.sete(code_.al);
  }

  // ---- operands

  // A register that no operand of this step is in.
  int take() {
    int best = kNone;
    int latest = -1;
    for (int index = 0; index < kFree; ++index) {
      if (pinned_[index]) continue;
      const int value = value_in_[index];
      if (value == kNone) {
        pinned_[index] = true;
        return index;
      }
      const int next = values_.next_use(value, step_ - 1);
      if (next > latest) {
        latest = next;
        best = index;
      }
    }
    const int left = value_in_[best];
    if (latest != Values::kNever && left >= std::ssize(values_.inputs())) store(left);
    release(best);
    pinned_[best] = true;
    return best;
  }

  Place place_of(const TapeOperand& operand, int value) {
    Place place;
    if (value == kNone) {
      place.address = constant_at(operand.constant);
      place.ends = true;
      return place;
    }
    place.index = register_of_[value];
    place.ends = values_.next_use(value, step_) == Values::kNever;
    if (!place.is_register()) {
      // An address that takes an instruction does not wait for the next one of its kind.
      const bool is_input = value < std::ssize(values_.inputs());
      place.address = home_of(value);
      if (is_input || !place.ends) load(place, is_input && place.ends ? kNone : value);
    }
    return place;
  }
  void load(Place& place, int value) {
    place.index = take();
    code_.vmovupd(reg(place.index), place.address);
    if (value != kNone) hold(place.index, value);
  }

  template <class Instruction>
  void with(const Instruction& instruction, int to, int first, const Place& second) {
    if (second.is_register()) {
      instruction(reg(to), reg(first), reg(second.index));
    } else {
      instruction(reg(to), reg(first), second.address);
    }
  }

  // The register of an operand that ends here; else another one.
  int target(const Place& a, const Place& b) {
    if (a.is_register() && a.ends) return a.index;
    if (b.is_register() && b.ends) return b.index;
    return take();
  }

  int binary(const TapeStep& s, const Values::Step& v) {
    Place a = place_of(s.a, v.operands[0]);
    Place b = place_of(s.b, v.operands[1]);
    const bool commutes =
        s.operation == TapeOperation::kAdd || s.operation == TapeOperation::kMultiply;
    if (commutes && !a.is_register() && b.is_register()) std::swap(a, b);
    if (!a.is_register()) {
      load(a, kNone);
      if (v.operands[0] != kNone && v.operands[0] == v.operands[1]) b = a;
    }
    const int to = target(a, b);
    with(
        [&](const auto& x, const auto& y, const auto& z) {
          switch (s.operation) {
            case TapeOperation::kAdd:
              return code_.vaddpd(x, y, z);
            case TapeOperation::kSubtract:
              return code_.vsubpd(x, y, z);
            case TapeOperation::kMultiply:
              return code_.vmulpd(x, y, z);
            default:
              return code_.vdivpd(x, y, z);
          }
        },
        to,
        a.index,
        b);
    return to;
  }

  // c + a b or c - a b. The instructions are named by the order of their three operands, and leave
  // the result in the first; only the last one may be in memory.
  int fused(const TapeStep& s, const Values::Step& v) {
    Place a = place_of(s.a, v.operands[0]);
    Place b = place_of(s.b, v.operands[1]);
    Place c = place_of(s.c, v.operands[2]);
    const bool minus = s.operation == TapeOperation::kNegated;
    if (!a.is_register()) std::swap(a, b);
    if (!a.is_register()) {
      const bool square = v.operands[0] != kNone && v.operands[0] == v.operands[1];
      load(a, kNone);
      if (square) b = a;
    }
    if (!b.is_register() && !c.is_register()) load(c, kNone);
    if (c.is_register() && !c.ends) {
      const auto f132 = [&](const auto& x, const auto& y, const auto& z) {
        minus ? code_.vfnmadd132pd(x, y, z) : code_.vfmadd132pd(x, y, z);
      };
      if (a.ends) {
        with(f132, a.index, c.index, b);  // a b + c
        return a.index;
      }
      if (b.is_register() && b.ends) {
        with(f132, b.index, c.index, a);
        return b.index;
      }
    }
    if (!c.is_register() && (a.ends || b.ends)) {
      if (!a.ends) std::swap(a, b);
      with(
          [&](const auto& x, const auto& y, const auto& z) {
            minus ? code_.vfnmadd213pd(x, y, z) : code_.vfmadd213pd(x, y, z);
          },
          a.index,
          b.index,
          c);  // b a + c
      return a.index;
    }
    int to = c.index;
    if (!c.is_register()) {
      to = take();
      code_.vmovupd(reg(to), c.address);
    } else if (!c.ends) {
      to = take();
      code_.vmovapd(reg(to), reg(c.index));
    }
    with(
        [&](const auto& x, const auto& y, const auto& z) {
          minus ? code_.vfnmadd231pd(x, y, z) : code_.vfmadd231pd(x, y, z);
        },
        to,
        a.index,
        b);  // a b + c
    return to;
  }

  int unary(const TapeStep& s, const Values::Step& v) {
    const Place a = place_of(s.a, v.operands[0]);
    const int to = a.is_register() && a.ends ? a.index : take();
    const auto emit = [&](const auto& from) {
      s.operation == TapeOperation::kSqrt ? code_.vsqrtpd(reg(to), from)
                                          : code_.vmovupd(reg(to), from);
    };
    a.is_register() ? emit(reg(a.index)) : emit(a.address);
    return to;
  }

  void compute() {
    const TapeStep& s = tape_.steps[step_];
    const Values::Step& v = values_.step(step_);
    pinned_.fill(false);
    for (const int value : v.operands) {
      if (value != kNone && register_of_[value] != kNone) pinned_[register_of_[value]] = true;
    }
    int to = kNone;
    switch (s.operation) {
      case TapeOperation::kFused:
      case TapeOperation::kNegated:
        to = fused(s, v);
        break;
      case TapeOperation::kSqrt:
      case TapeOperation::kCopy:
        to = unary(s, v);
        break;
      default:
        to = binary(s, v);
    }
    for (const int value : v.operands) {
      if (value == kNone || register_of_[value] == kNone) continue;
      if (values_.next_use(value, step_) == Values::kNever) release(register_of_[value]);
    }
    finish(v.result, to);
  }

  void finish(int result, int index) {
    hold(index, result);
    deliver(result, index);
  }

  // The interpreter's function finds its operands where the interpreter would have left them. It
  // keeps no register.
  void call_function(const TapeInstruction& instruction) {
    const TapeStep& s = tape_.steps[step_];
    const Values::Step& v = values_.step(step_);
    const std::array operands{s.a, s.b, s.c};
    int passed = kNone;
    for (std::size_t i = 0; i < operands.size(); ++i) {
      if (operands[i].where == TapeOperand::Where::kSlot) store(v.operands[i]);
      if (operands[i].where == TapeOperand::Where::kResult) passed = v.operands[i];
    }
    for (int index = 0; index < kFree; ++index) {
      const int value = value_in_[index];
      if (value >= std::ssize(values_.inputs()) &&
          values_.next_use(value, step_) != Values::kNever) {
        store(value);
      }
    }
    if (passed != kNone) {
      if (register_of_[passed] == kNone) {
        code_.vmovupd(reg(0), at_slot(values_.slot(passed)));
      } else if (register_of_[passed] != 0) {
        code_.vmovapd(reg(0), reg(register_of_[passed]));
      }
    }
    const bool has_sums = delivered_ > 0;
    for (int i = 0; has_sums && i < kSums; ++i) {
      code_.vmovupd(at_slot(tape_.slots + i), reg(kFree + i));
    }
    code_.mov(code_.rdi, reinterpret_cast<std::uintptr_t>(&instruction));
    code_.mov(code_.rsi, code_.rbx);
    code_.mov(code_.rax, reinterpret_cast<std::uintptr_t>(instruction.handler));
    code_.call(code_.rax);
    for (int index = 0; index < kFree; ++index) release(index);
    clear_sums();
    for (int i = 0; has_sums && i < kSums; ++i) {
      code_.vmovupd(reg(kFree + i), at_slot(tape_.slots + i));
    }
    in_slot_[v.result] = s.stored;
    finish(v.result, 0);
    if (v.second == kNone) return;
    in_slot_[v.second] = true;
    if (values_.wanted(v.second).empty()) return;
    pinned_.fill(false);
    pinned_[0] = true;
    const int index = take();
    code_.vmovupd(reg(index), at_slot(values_.slot(v.second)));
    finish(v.second, index);
  }

  const TapeParts& tape_;
  const std::vector<TapeInstruction>& calls_;
  Xbyak::CodeGenerator& code_;
  const Values values_;
  int step_ = 0;
  std::vector<int> register_of_;
  std::vector<bool> in_slot_;  // whether its slot holds it
  std::array<int, kFree> value_in_{};
  std::array<bool, kFree> pinned_{};  // by an operand of this step
  int delivered_ = 0;                 // results so far
  std::vector<double> constants_;
  std::map<std::uint64_t, int> places_;  // of the constants' bits
  Xbyak::Label pool_;
};

template <class V>
class MemoryOf : public NativeTape::Memory {
 public:
  explicit MemoryOf(const TapeParts& tape)
      : calls_(calls_of(tape.steps)), code_(kPage, Xbyak::AutoGrow) {
    Writer<V>(tape, calls_, code_).write();
  }
  [[nodiscard]] NativeTape::Code code() const override { return code_.getCode<NativeTape::Code>(); }

 private:
  static constexpr std::size_t kPage = 4096;

  static std::vector<TapeInstruction> calls_of(std::span<const TapeStep> steps) {
    std::vector<TapeInstruction> calls;
    for (const TapeStep& s : steps) {
      if (!is_called(s)) continue;
      calls.push_back(TapeMachine<V, false>::instruction(s, TapeMachine<V, false>::function(s)));
    }
    return calls;
  }

  const std::vector<TapeInstruction> calls_;  // whose places are in the code
  Xbyak::CodeGenerator code_;
};

std::unique_ptr<const NativeTape::Memory> memory_of(const TapeParts& tape) {
  if constexpr (Machine<WideNumber>::exists) {
    try {
      return std::make_unique<MemoryOf<WideNumber>>(tape);
    } catch (const std::exception&) {  // of the assembler: the system allows no code
      return nullptr;
    }
  }
  return nullptr;
}

}  // namespace
}  // namespace carnot::language

#else

namespace carnot::language {
namespace {

std::unique_ptr<const NativeTape::Memory> memory_of(const TapeParts& /*tape*/) { return nullptr; }

}  // namespace
}  // namespace carnot::language

#endif

namespace carnot::language {

NativeTape::Code NativeTape::make(const TapeParts& parts) {
  std::call_once(once_, [&] {
    memory_ = memory_of(parts);
    if (memory_) code_.store(memory_->code(), std::memory_order_release);
  });
  return code();
}

}  // namespace carnot::language
