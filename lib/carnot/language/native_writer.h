// The code of a tape, written instruction by instruction.
//
// NativeSteps says what each step does and which values it needs; here each becomes one instruction
// or a few, on registers that are given out as native_tape.h says. Included by native_tape.cc only,
// where there is an assembler.
#pragma once

#include <xbyak/xbyak.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <limits>
#include <map>
#include <type_traits>
#include <utility>
#include <vector>

#include "carnot/language/native_steps.h"
#include "carnot/language/tape_machine.h"

namespace carnot::language {

// The registers of the interpreter, as the assembler calls them. Without fused multiplications
// there is no such code.
template <class V>
struct NativeMachine {
  static constexpr bool kExists = false;
};
#if XSIMD_WITH_AVX512F
template <class V>
requires(sizeof(V) == 64) struct NativeMachine<V> {
  static constexpr bool kExists = true;
  using Register = Xbyak::Zmm;
  static constexpr int kRegisters = 32;
};
#endif
#if XSIMD_WITH_FMA3_AVX2
template <>
struct NativeMachine<xsimd::batch<double, xsimd::fma3<xsimd::avx2>>> {
  static constexpr bool kExists = true;
  using Register = Xbyak::Ymm;
  static constexpr int kRegisters = 16;
};
#endif

// Writes the code of a tape, a NativeTape::Code. rbx is `memory`, r12 `in`, r13 `out`, and r14
// counts the bytes of a row that are done, where it takes more than one register. Two registers add
// up 0 x for the results x that are wanted: zero where all of them are finite.
template <class V>
class NativeWriter {
 public:
  // `calls` are those of the steps that are called, and stay where they are.
  NativeWriter(const TapeParts& tape,
               const std::vector<TapeInstruction>& calls,
               Xbyak::CodeGenerator& code)
      : tape_(tape),
        calls_(calls),
        code_(code),
        values_(tape),
        slots_(tape.slots + kSums),
        register_of_(values_.count(), kNone),
        in_slot_(values_.count(), false) {
    value_in_.fill(kNone);
    for (int value = 0; value < values_.count(); ++value) slot_of_.push_back(values_.slot(value));
  }

  void write() {
    // As many that the stack is aligned for calls.
    const std::array kept{code_.rbx, code_.r12, code_.r13, code_.r14, code_.r15};
    for (const auto& x : kept) code_.push(x);
    code_.mov(code_.r12, code_.rdi);
    code_.mov(code_.r13, code_.rsi);
    code_.mov(code_.rbx, code_.rdx);
    code_.xor_(code_.r14, code_.r14);
    clear_sums();
    Xbyak::Label pass;
    code_.L(pass);
    for (int value = 0; value < std::ssize(values_.inputs()); ++value) {
      if (values_.wanted(value).empty()) continue;
      code_.vmovupd(reg(0), home_of(value));
      deliver(value, 0);
    }
    std::size_t calls = 0;
    for (const NativeStep& s : values_.steps()) {
      if (s.operation == NativeOperation::kCall) {
        call_function(s, calls_[calls++]);
      } else if (!values_.wanted(s.result).empty() || !ends(s.result)) {
        compute(s);
      }
      ++step_;
    }
    if constexpr (kPasses > 1) {
      code_.add(code_.r14, kWidth);
      code_.cmp(code_.r14, kRow);
      code_.jb(pass, Xbyak::CodeGenerator::T_NEAR);
    }
    return_whether_finite();
    code_.vzeroupper();
    std::for_each(kept.rbegin(), kept.rend(), [&](const auto& x) { code_.pop(x); });
    code_.ret();
    code_.align(kWidth);
    code_.L(pool_);
    for (const double constant : constants_) {
      for (int l = 0; l < kLanes; ++l) code_.dq(std::bit_cast<std::uint64_t>(constant));
    }
    code_.ready(Xbyak::CodeGenerator::PROTECT_RE);
  }
  // What the code needs of memory.
  [[nodiscard]] std::size_t bytes() const { return static_cast<std::size_t>(slots_) * kWidth; }

 private:
  static constexpr int kNone = NativeOperand::kNoValue;
  using Register = typename NativeMachine<V>::Register;
  static constexpr bool kIsZmm = std::is_same_v<Register, Xbyak::Zmm>;
  static constexpr int kWidth = sizeof(V);
  static constexpr int kLanes = kWidth / sizeof(double);
  static constexpr int kRow = kTapeLanes * sizeof(double);
  static constexpr int kPasses = kTapeLanes / kLanes;  // registers for a row
  static constexpr int kSums = 2;
  static constexpr int kFree = NativeMachine<V>::kRegisters - kSums - 1;  // for values
  static constexpr int kZero = kFree + kSums;

  // An operand of this step: a register, or a place in memory.
  struct Place {
    int index = kNone;  // of the register
    Xbyak::Address address{0};
    bool ends = false;  // nobody needs what is in the register after this step
    [[nodiscard]] bool is_register() const { return index != kNone; }
  };

  [[nodiscard]] static Register reg(int index) { return Register(index); }
  Xbyak::Address at_slot(int slot) { return code_.ptr[code_.rbx + slot * kWidth]; }
  // Values that the tape has no slot for get one when they need it.
  Xbyak::Address slot_of(int value) {
    if (slot_of_[value] == kNone) slot_of_[value] = slots_++;
    return at_slot(slot_of_[value]);
  }
  [[nodiscard]] bool ends(int value) const {
    return values_.next_use(value, step_) == NativeSteps::kNever;
  }
  Xbyak::Address at_row(const Xbyak::Reg64& group, std::uint32_t row) {
    const auto offset = static_cast<int>(row * kRow);
    return kPasses > 1 ? code_.ptr[group + code_.r14 + offset] : code_.ptr[group + offset];
  }
  // Lets a register point to a group, if it does not yet.
  void point(const Xbyak::Reg64& to, const Xbyak::Reg64& groups, std::uint32_t group, int& now) {
    if (now == static_cast<int>(group)) return;
    now = static_cast<int>(group);
    code_.mov(to, code_.ptr[groups + now * static_cast<int>(sizeof(double*))]);
  }
  // Where a value that is in no register is. That of an input takes an instruction, and rax.
  Xbyak::Address home_of(int value) {
    if (!values_.is_input(value)) return slot_of(value);
    const auto [group, row] = values_.inputs()[value];
    point(code_.rax, code_.r12, group, in_rax_);
    return at_row(code_.rax, row);
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
      code_.vmovupd(slot_of(value), reg(kZero));
    } else {
      code_.vmovupd(slot_of(value), reg(register_of_[value]));
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
      point(code_.rcx, code_.r13, group, in_rcx_);
      code_.test(code_.rcx, code_.rcx);
      code_.jz(next);
      code_.vmovupd(at_row(code_.rcx, row), reg(index));
      code_.vfmadd231pd(reg(kFree + delivered_++ % kSums), reg(kZero), reg(index));
      code_.L(next);
    }
  }
  void return_whether_finite() {
    const Register sum = reg(kFree);
    code_.vaddpd(sum, sum, reg(kFree + 1));
    if constexpr (kIsZmm) {
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
    if (latest != NativeSteps::kNever && !values_.is_input(left)) store(left);
    release(best);
    pinned_[best] = true;
    return best;
  }

  Place place_of(const NativeOperand& operand) {
    Place place;
    const int value = operand.value;
    if (!operand.is_value()) {
      place.address = constant_at(operand.constant);
      place.ends = true;
      return place;
    }
    place.index = register_of_[value];
    place.ends = ends(value);
    if (!place.is_register()) {
      // The address of an input is in a register that the next one takes.
      place.address = home_of(value);
      const bool is_input = values_.is_input(value);
      if (is_input || !place.ends) load(place, is_input && place.ends ? kNone : value);
    }
    return place;
  }
  // The same in a register.
  Place register_with(const NativeOperand& operand) {
    Place place = place_of(operand);
    if (!place.is_register()) load(place, kNone);
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

  static bool are_same(const NativeOperand& a, const NativeOperand& b) {
    return a.is_value() && a.value == b.value;
  }

  int binary(const NativeStep& s) {
    Place a = place_of(s.operands[0]);
    Place b = place_of(s.operands[1]);
    const bool commutes =
        s.operation == NativeOperation::kAdd || s.operation == NativeOperation::kMultiply;
    if (commutes && !a.is_register() && b.is_register()) std::swap(a, b);
    if (!a.is_register()) {
      load(a, kNone);
      if (are_same(s.operands[0], s.operands[1])) b = a;
    }
    const int to = target(a, b);
    with(
        [&](const auto& x, const auto& y, const auto& z) {
          switch (s.operation) {
            case NativeOperation::kAdd:
              return code_.vaddpd(x, y, z);
            case NativeOperation::kSubtract:
              return code_.vsubpd(x, y, z);
            case NativeOperation::kMultiply:
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
  int fused(const NativeStep& s) {
    Place a = place_of(s.operands[0]);
    Place b = place_of(s.operands[1]);
    Place c = place_of(s.operands[2]);
    const bool minus = s.operation == NativeOperation::kNegated;
    if (!a.is_register()) std::swap(a, b);
    if (!a.is_register()) {
      load(a, kNone);
      if (are_same(s.operands[0], s.operands[1])) b = a;
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

  int unary(const NativeStep& s) {
    const Place a = place_of(s.operands[0]);
    const int to = a.is_register() && a.ends ? a.index : take();
    const auto emit = [&](const auto& from) {
      s.operation == NativeOperation::kSqrt ? code_.vsqrtpd(reg(to), from)
                                            : code_.vmovupd(reg(to), from);
    };
    a.is_register() ? emit(reg(a.index)) : emit(a.address);
    return to;
  }

  static double from_bits(std::uint64_t bits) { return std::bit_cast<double>(bits); }
  static constexpr std::uint64_t kSign = std::uint64_t{1} << 63;

  // pack_lane::nan_beyond() and pack_lane::turned().
  int nan_beyond(const NativeStep& s) {
    const int r = register_with(s.operands[0]).index;
    const int x = register_with(s.operands[1]).index;
    const int to = take();
    const int size = take();
    constexpr int kAtMost = 2;  // of comparisons
    code_.vandpd(reg(size), reg(x), constant_at(from_bits(~kSign)));
    if constexpr (kIsZmm) {
      code_.vcmppd(code_.k1, reg(size), constant_at(pack_lane::kLargestAngle), kAtMost);
      code_.vmovupd(reg(to), constant_at(std::numeric_limits<double>::quiet_NaN()));
      code_.vmovapd(reg(to) | code_.k1, reg(r));
    } else {
      code_.vcmppd(reg(size), reg(size), constant_at(pack_lane::kLargestAngle), kAtMost);
      code_.vmovupd(reg(to), constant_at(std::numeric_limits<double>::quiet_NaN()));
      code_.vblendvpd(reg(to), reg(to), reg(r), reg(size));
    }
    return to;
  }
  int turned(const NativeStep& s) {
    const bool sine = s.operation == NativeOperation::kTurnedSin;
    const int even = register_with(s.operands[sine ? 0 : 1]).index;
    const int odd = register_with(s.operands[sine ? 1 : 0]).index;
    const int shifted = register_with(s.operands[2]).index;
    const int to = take();
    const int sign = take();
    if constexpr (kIsZmm) {
      code_.vptestmq(code_.k1, reg(shifted), constant_at(from_bits(1)));
      code_.vmovapd(reg(to), reg(even));
      code_.vmovapd(reg(to) | code_.k1, reg(odd));
    } else {
      code_.vpsllq(reg(sign), reg(shifted), 63);
      code_.vblendvpd(reg(to), reg(even), reg(odd), reg(sign));
    }
    int quadrant = shifted;
    if (!sine) {
      code_.vpaddq(reg(sign), reg(shifted), constant_at(from_bits(1)));
      quadrant = sign;
    }
    code_.vpsllq(reg(sign), reg(quadrant), 62);
    code_.vandpd(reg(sign), reg(sign), constant_at(from_bits(kSign)));
    code_.vxorpd(reg(to), reg(to), reg(sign));
    return to;
  }

  void compute(const NativeStep& s) {
    pinned_.fill(false);
    for (const NativeOperand& x : s.operands) {
      if (x.is_value() && register_of_[x.value] != kNone) pinned_[register_of_[x.value]] = true;
    }
    int to = kNone;
    switch (s.operation) {
      case NativeOperation::kFused:
      case NativeOperation::kNegated:
        to = fused(s);
        break;
      case NativeOperation::kSqrt:
      case NativeOperation::kCopy:
        to = unary(s);
        break;
      case NativeOperation::kNanBeyond:
        to = nan_beyond(s);
        break;
      case NativeOperation::kTurnedSin:
      case NativeOperation::kTurnedCos:
        to = turned(s);
        break;
      default:
        to = binary(s);
    }
    for (const NativeOperand& x : s.operands) {
      if (!x.is_value() || register_of_[x.value] == kNone) continue;
      if (ends(x.value)) release(register_of_[x.value]);
    }
    finish(s.result, to);
  }

  void finish(int result, int index) {
    hold(index, result);
    deliver(result, index);
  }

  // The interpreter's function finds its operands where the interpreter would have left them. It
  // keeps no register.
  void call_function(const NativeStep& s, const TapeInstruction& instruction) {
    const std::array operands{s.called->a, s.called->b, s.called->c};
    int passed = kNone;
    for (std::size_t i = 0; i < operands.size(); ++i) {
      if (operands[i].where == TapeOperand::Where::kSlot) store(s.operands[i].value);
      if (operands[i].where == TapeOperand::Where::kResult) passed = s.operands[i].value;
    }
    for (const int value : value_in_) {
      if (value != kNone && !values_.is_input(value) && !ends(value)) store(value);
    }
    if (passed != kNone) {
      if (register_of_[passed] == kNone) {
        code_.vmovupd(reg(0), slot_of(passed));
      } else if (register_of_[passed] != 0) {
        code_.vmovapd(reg(0), reg(register_of_[passed]));
      }
    }
    const bool has_sums = kPasses > 1 || delivered_ > 0;
    for (int i = 0; has_sums && i < kSums; ++i) {
      code_.vmovupd(at_slot(tape_.slots + i), reg(kFree + i));
    }
    code_.mov(code_.rdi, reinterpret_cast<std::uintptr_t>(&instruction));
    code_.mov(code_.rsi, code_.rbx);
    code_.mov(code_.rax, reinterpret_cast<std::uintptr_t>(instruction.handler));
    code_.call(code_.rax);
    in_rax_ = in_rcx_ = kNone;
    for (int index = 0; index < kFree; ++index) release(index);
    clear_sums();
    for (int i = 0; has_sums && i < kSums; ++i) {
      code_.vmovupd(reg(kFree + i), at_slot(tape_.slots + i));
    }
    in_slot_[s.result] = s.called->stored;
    finish(s.result, 0);
  }

  const TapeParts& tape_;
  const std::vector<TapeInstruction>& calls_;
  Xbyak::CodeGenerator& code_;
  const NativeSteps values_;
  int step_ = 0;
  int slots_;
  std::vector<int> slot_of_;
  std::vector<int> register_of_;
  std::vector<bool> in_slot_;  // whether its slot holds it
  std::array<int, kFree> value_in_{};
  std::array<bool, kFree> pinned_{};  // by an operand of this step
  int in_rax_ = kNone;                // the group that rax points to, and rcx
  int in_rcx_ = kNone;
  int delivered_ = 0;  // results so far
  std::vector<double> constants_;
  std::map<std::uint64_t, int> places_;  // of the constants' bits
  Xbyak::Label pool_;
};

}  // namespace carnot::language
