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

using Outputs = std::span<const std::vector<std::uint32_t>>;
constexpr int kNone = -1;

// The steps with names for values instead of places: a slot holds one value after the other.
class Values {
 public:
  struct Step {
    std::array<int, 3> operands{kNone, kNone, kNone};  // kNone: a constant, or not there
    int result = kNone;
    int second = kNone;
  };

  Values(std::span<const TapeStep> steps, const Outputs& outputs) {
    int last = kNone;
    for (const TapeStep& s : steps) {
      Step step;
      const std::array operands{s.a, s.b, s.c};
      for (std::size_t i = 0; i < operands.size(); ++i) {
        if (operands[i].where == TapeOperand::Where::kResult) step.operands[i] = last;
        if (operands[i].where == TapeOperand::Where::kSlot) step.operands[i] = at(operands[i].slot);
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
    wanted_.assign(uses_.size(), false);
    for (const std::vector<std::uint32_t>& group : outputs) {
      for (const std::uint32_t slot : group) {
        const int value = at(slot);
        wanted_.resize(uses_.size(), false);
        wanted_[value] = true;
      }
    }
  }

  [[nodiscard]] int count() const { return static_cast<int>(uses_.size()); }
  [[nodiscard]] const Step& step(int i) const { return steps_[i]; }
  [[nodiscard]] std::uint32_t slot(int value) const { return slots_[value]; }
  // Whether it is in its slot before the first step.
  [[nodiscard]] bool is_input(int value) const { return inputs_[value]; }
  [[nodiscard]] bool is_wanted(int value) const { return wanted_[value]; }
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
    inputs_.push_back(false);
    return count() - 1;
  }
  int at(std::uint32_t slot) {
    const auto [place, is_new] = here_.try_emplace(slot, 0);
    if (is_new) {
      place->second = add(slot);
      inputs_.back() = true;
    }
    return place->second;
  }

  std::vector<Step> steps_;
  std::vector<std::vector<int>> uses_;  // the steps that need a value, in order
  std::vector<std::uint32_t> slots_;
  std::vector<bool> inputs_;
  std::vector<bool> wanted_;
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

// Writes the code of a tape: void(std::byte* memory).
template <class V>
class Writer {
 public:
  // `calls` are those of the steps that are called, and stay where they are.
  Writer(std::span<const TapeStep> steps,
         const Outputs& outputs,
         const std::vector<TapeInstruction>& calls,
         Xbyak::CodeGenerator& code)
      : steps_(steps),
        calls_(calls),
        code_(code),
        values_(steps, outputs),
        register_of_(values_.count(), kNone),
        in_memory_(values_.count(), false) {
    value_in_.fill(kNone);
    for (int value = 0; value < values_.count(); ++value) {
      in_memory_[value] = values_.is_input(value);
    }
  }

  void write() {
    code_.push(code_.rbx);  // and the stack is aligned for calls
    code_.mov(code_.rbx, code_.rdi);
    std::size_t calls = 0;
    for (step_ = 0; step_ < static_cast<int>(steps_.size()); ++step_) {
      if (is_called(steps_[step_])) {
        call_function(calls_[calls++]);
      } else {
        compute();
      }
    }
    code_.vzeroupper();
    code_.pop(code_.rbx);
    code_.ret();
    code_.align(kWidth);
    code_.L(pool_);
    for (const double constant : constants_) {
      for (std::size_t l = 0; l < kWidth / sizeof(double); ++l) {
        code_.dq(std::bit_cast<std::uint64_t>(constant));
      }
    }
    code_.ready(Xbyak::CodeGenerator::PROTECT_RE);
  }

 private:
  using Register = typename Machine<V>::Register;
  static constexpr int kWidth = sizeof(V);

  // An operand of this step: a register, or a place in memory.
  struct Place {
    int index = kNone;  // of the register
    Xbyak::Address address{0};
    bool ends = false;  // nobody needs what is in the register after this step
    [[nodiscard]] bool is_register() const { return index != kNone; }
  };

  Xbyak::Address slot_of(int value) {
    return code_.ptr[code_.rbx + static_cast<int>(values_.slot(value) * kWidth)];
  }
  Xbyak::Address constant_at(double x) {
    const auto [place, is_new] =
        places_.try_emplace(std::bit_cast<std::uint64_t>(x), static_cast<int>(constants_.size()));
    if (is_new) constants_.push_back(x);
    return code_.ptr[code_.rip + pool_ + place->second * kWidth];
  }
  [[nodiscard]] static Register reg(int index) { return Register(index); }

  void store(int value) {
    if (in_memory_[value]) return;
    code_.vmovupd(slot_of(value), reg(register_of_[value]));
    in_memory_[value] = true;
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

  // A register that no operand of this step is in.
  int take() {
    int best = kNone;
    int latest = -1;
    for (int index = 0; index < Machine<V>::kRegisters; ++index) {
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
    if (latest != Values::kNever) store(value_in_[best]);
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
    place.address = slot_of(value);
    place.ends = values_.next_use(value, step_) == Values::kNever;
    if (!place.is_register() && !place.ends) load(place, value);
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
    const TapeStep& s = steps_[step_];
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
    if (values_.is_wanted(result)) store(result);
  }

  // The interpreter's function finds its operands where the interpreter would have left them. It
  // keeps no register.
  void call_function(const TapeInstruction& instruction) {
    const TapeStep& s = steps_[step_];
    const Values::Step& v = values_.step(step_);
    const std::array operands{s.a, s.b, s.c};
    int passed = kNone;
    for (std::size_t i = 0; i < operands.size(); ++i) {
      if (operands[i].where == TapeOperand::Where::kSlot) store(v.operands[i]);
      if (operands[i].where == TapeOperand::Where::kResult) passed = v.operands[i];
    }
    for (int index = 0; index < Machine<V>::kRegisters; ++index) {
      const int value = value_in_[index];
      if (value != kNone && values_.next_use(value, step_) != Values::kNever) store(value);
    }
    if (passed != kNone) {
      if (register_of_[passed] == kNone) {
        code_.vmovupd(reg(0), slot_of(passed));
      } else if (register_of_[passed] != 0) {
        code_.vmovapd(reg(0), reg(register_of_[passed]));
      }
    }
    code_.mov(code_.rdi, reinterpret_cast<std::uintptr_t>(&instruction));
    code_.mov(code_.rsi, code_.rbx);
    code_.mov(code_.rax, reinterpret_cast<std::uintptr_t>(instruction.handler));
    code_.call(code_.rax);
    for (int index = 0; index < Machine<V>::kRegisters; ++index) release(index);
    if (v.second != kNone) in_memory_[v.second] = true;
    in_memory_[v.result] = s.stored;
    finish(v.result, 0);
  }

  std::span<const TapeStep> steps_;
  const std::vector<TapeInstruction>& calls_;
  Xbyak::CodeGenerator& code_;
  const Values values_;
  int step_ = 0;
  std::vector<int> register_of_;
  std::vector<bool> in_memory_;  // whether its slot holds it
  std::array<int, Machine<V>::kRegisters> value_in_{};
  std::array<bool, Machine<V>::kRegisters> pinned_{};  // by an operand of this step
  std::vector<double> constants_;
  std::map<std::uint64_t, int> places_;  // of the constants' bits
  Xbyak::Label pool_;
};

template <class V>
class MemoryOf : public NativeTape::Memory {
 public:
  MemoryOf(std::span<const TapeStep> steps, const Outputs& outputs)
      : calls_(calls_of(steps)), code_(kPage, Xbyak::AutoGrow) {
    Writer<V>(steps, outputs, calls_, code_).write();
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

std::unique_ptr<const NativeTape::Memory> memory_of(std::span<const TapeStep> steps,
                                                    const Outputs& outputs) {
  if constexpr (Machine<WideNumber>::exists) {
    try {
      return std::make_unique<MemoryOf<WideNumber>>(steps, outputs);
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

using Outputs = std::span<const std::vector<std::uint32_t>>;
std::unique_ptr<const NativeTape::Memory> memory_of(std::span<const TapeStep> /*steps*/,
                                                    const Outputs& /*outputs*/) {
  return nullptr;
}

}  // namespace
}  // namespace carnot::language

#endif

namespace carnot::language {

NativeTape::Code NativeTape::make(std::span<const TapeStep> steps,
                                  std::span<const std::vector<std::uint32_t>> outputs) {
  std::call_once(once_, [&] {
    memory_ = memory_of(steps, outputs);
    if (memory_) code_.store(memory_->code(), std::memory_order_release);
  });
  return code();
}

}  // namespace carnot::language
