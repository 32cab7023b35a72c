// The interpreter of tapes on registers of one type: the functions that do the steps.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>
#include <type_traits>
#include <utility>
#include <vector>

#include "carnot/language/tape.h"
#include "carnot/numerics/pack.h"
#include "carnot/numerics/stumpff.h"

namespace carnot::language {

// The widest register for numbers side by side.
using WideNumber = pack_lane::Widest<kTapeLanes>::type;

// The memory of slots of this thread, at least `bytes` long and aligned for any register.
std::byte* tape_memory(std::size_t bytes);

// Whether the functions of this file jump to each other.
#ifdef CARNOT_TAIL_CALLS
constexpr bool kTailCalls = true;
#else
constexpr bool kTailCalls = false;
#endif

// V is a register of numbers side by side as xsimd has it, or double.
template <class V, bool tail_calls = kTailCalls>
struct TapeMachine {
  using Ops = pack_lane::Ops<V>;
  using Register = typename Ops::Register;
  using Instruction = TapeInstruction;
  using Where = TapeOperand::Where;
  // Nothing is returned from a jump. (As a template argument a register loses its attributes.)
  static void result_of(std::true_type);
  static Register result_of(std::false_type);
  using Result = decltype(result_of(std::bool_constant<tail_calls>{}));
  using Handler = Result (*)(const Instruction*, std::byte*, Register);
  using AnyHandler = void (*)();

  template <Where where>
  [[gnu::always_inline]] static V load(const TapeInstruction::Operand& operand,
                                       const std::byte* memory,
                                       const V& last) {
    if constexpr (where == Where::kResult) {
      return last;
    } else if constexpr (where == Where::kSlot) {
      return Ops::of(*reinterpret_cast<const Register*>(memory + operand.slot));
    } else {
      return V(operand.constant);
    }
  }
  [[gnu::always_inline]] static void store(const V& x, std::byte* to) {
    *reinterpret_cast<Register*>(to) = Ops::register_of(x);
  }

  // a b + c, rounded once where the registers can.
  [[gnu::always_inline]] static V fused(const V& a, const V& b, const V& c) {
#if XSIMD_WITH_AVX512F
    // xsimd has a product and a sum here, which only an optimising compiler makes one.
    if constexpr (sizeof(V) == 64) return V(_mm512_fmadd_pd(a, b, c));
#endif
    if constexpr (std::is_same_v<V, double>) {
      return a * b + c;
    } else {
      return xsimd::fma(a, b, c);
    }
  }
  template <class F>
  static V each_number(const V& x, const F& f) {
    alignas(64) std::array<double, Ops::kSize> numbers;
    Ops::store(x, numbers.data());
    for (double& number : numbers) number = f(number);
    return Ops::load(numbers.data());
  }

  // What steps do: compute(...) is the result.
  template <TapeOperation operation>
  struct Arithmetic {
    [[gnu::always_inline]] static V compute(
        const Instruction&, std::byte*, const V& a, const V& b, const V& c) {
      if constexpr (operation == TapeOperation::kAdd) {
        return a + b;
      } else if constexpr (operation == TapeOperation::kSubtract) {
        return a - b;
      } else if constexpr (operation == TapeOperation::kMultiply) {
        return a * b;
      } else if constexpr (operation == TapeOperation::kDivide) {
        return a / b;
      } else if constexpr (operation == TapeOperation::kCopy) {
        return a;
      } else if constexpr (operation == TapeOperation::kSqrt) {
        return Ops::sqrt(a);
      } else {
        return fused(operation == TapeOperation::kFused ? a : -a, b, c);
      }
    }
  };
  template <TapeOperation operation>
  struct Circular {
    [[gnu::always_inline]] static V compute(
        const Instruction& at, std::byte* memory, const V& a, const V&, const V&) {
      const auto both = pack_lane::sin_cos(a);
      if constexpr (operation == TapeOperation::kSinCos) store(both.cos, memory + at.second);
      return operation == TapeOperation::kCos ? both.cos : both.sin;
    }
  };
  template <Operation function>
  struct Function {
    static V compute(const Instruction&, std::byte*, const V& a, const V&, const V&) {
      return each_number(a, [](double x) { return apply(function, x); });
    }
  };
  template <int k>
  struct Stumpff {
    static V compute(const Instruction&, std::byte*, const V& a, const V&, const V&) {
      if constexpr (std::is_same_v<V, double>) {
        return stumpff<k>(a);
      } else {
        return stumpff<k>(Pack<Ops::kSize, V>::of_part(a)).part(0);
      }
    }
  };
  struct Atan2 {
    static V compute(const Instruction&, std::byte*, const V& a, const V& b, const V&) {
      alignas(64) std::array<double, Ops::kSize> y;
      alignas(64) std::array<double, Ops::kSize> x;
      Ops::store(a, y.data());
      Ops::store(b, x.data());
      for (int l = 0; l < Ops::kSize; ++l) y[l] = std::atan2(y[l], x[l]);
      return Ops::load(y.data());
    }
  };

  template <class F, Where a, Where b, Where c, bool stored>
  static Result step(const Instruction* at, std::byte* memory, Register last) {
    const V before = Ops::of(last);
    const V result = F::compute(*at,
                                memory,
                                load<a>(at->operands[0], memory, before),
                                load<b>(at->operands[1], memory, before),
                                load<c>(at->operands[2], memory, before));
    if constexpr (stored) store(result, memory + at->to);
    if constexpr (tail_calls) {
      return reinterpret_cast<Handler>(at[1].handler)(at + 1, memory, Ops::register_of(result));
    } else {
      return Ops::register_of(result);
    }
  }

  // The handlers of an operation, by where its operands are: those that it does not have are
  // constants.
  template <class F, int operands>
  static AnyHandler handler_of(const TapeStep& s) {
    const auto pick = [&]<int i>(std::integral_constant<int, i>) {
      constexpr auto a = static_cast<Where>(i % 3);
      constexpr Where b = operands > 1 ? static_cast<Where>(i / 3 % 3) : Where::kConstant;
      constexpr Where c = operands > 2 ? static_cast<Where>(i / 9 % 3) : Where::kConstant;
      return s.stored ? &step<F, a, b, c, true> : &step<F, a, b, c, false>;
    };
    constexpr int kCases = operands == 1 ? 3 : operands == 2 ? 9 : 27;
    const auto index = static_cast<int>(s.a.where) +
                       (operands > 1 ? 3 * static_cast<int>(s.b.where) : 0) +
                       (operands > 2 ? 9 * static_cast<int>(s.c.where) : 0);
    Handler found = nullptr;
    [&]<int... i>(std::integer_sequence<int, i...>) {
      ((i == index ? void(found = pick(std::integral_constant<int, i>{})) : void()), ...);
    }
    (std::make_integer_sequence<int, kCases>{});
    return reinterpret_cast<AnyHandler>(found);
  }

  static AnyHandler stumpff_handler(const TapeStep& s) {
    AnyHandler found = nullptr;
    [&]<int... k>(std::integer_sequence<int, k...>) {
      ((k == s.index ? void(found = handler_of<Stumpff<k>, 1>(s)) : void()), ...);
    }
    (std::make_integer_sequence<int, kMostStumpff + 1>{});
    return found;
  }

  // Of the steps that are more than one instruction of a processor.
  static AnyHandler function(const TapeStep& s) {
    switch (s.operation) {
      case TapeOperation::kSin:
        return handler_of<Circular<TapeOperation::kSin>, 1>(s);
      case TapeOperation::kCos:
        return handler_of<Circular<TapeOperation::kCos>, 1>(s);
      case TapeOperation::kSinCos:
        return handler_of<Circular<TapeOperation::kSinCos>, 1>(s);
      case TapeOperation::kAtan2:
        return handler_of<Atan2, 2>(s);
      default:
        break;
    }
    switch (s.function) {
      case Operation::kStumpff:
        return stumpff_handler(s);
      case Operation::kExp:
        return handler_of<Function<Operation::kExp>, 1>(s);
      case Operation::kLog:
        return handler_of<Function<Operation::kLog>, 1>(s);
      case Operation::kSinh:
        return handler_of<Function<Operation::kSinh>, 1>(s);
      case Operation::kCosh:
        return handler_of<Function<Operation::kCosh>, 1>(s);
      case Operation::kTanh:
        return handler_of<Function<Operation::kTanh>, 1>(s);
      case Operation::kAsin:
        return handler_of<Function<Operation::kAsin>, 1>(s);
      case Operation::kAcos:
        return handler_of<Function<Operation::kAcos>, 1>(s);
      default:
        return handler_of<Function<Operation::kAtan>, 1>(s);
    }
  }

  static AnyHandler handler(const TapeStep& s) {
    using O = TapeOperation;
    switch (s.operation) {
      case O::kAdd:
        return handler_of<Arithmetic<O::kAdd>, 2>(s);
      case O::kSubtract:
        return handler_of<Arithmetic<O::kSubtract>, 2>(s);
      case O::kMultiply:
        return handler_of<Arithmetic<O::kMultiply>, 2>(s);
      case O::kDivide:
        return handler_of<Arithmetic<O::kDivide>, 2>(s);
      case O::kFused:
        return handler_of<Arithmetic<O::kFused>, 3>(s);
      case O::kNegated:
        return handler_of<Arithmetic<O::kNegated>, 3>(s);
      case O::kCopy:
        return handler_of<Arithmetic<O::kCopy>, 1>(s);
      case O::kSqrt:
        return handler_of<Arithmetic<O::kSqrt>, 1>(s);
      default:
        return function(s);
    }
  }

  static Instruction instruction(const TapeStep& s, AnyHandler handler) {
    Instruction instruction;
    instruction.handler = handler;
    const std::array operands{s.a, s.b, s.c};
    for (std::size_t i = 0; i < operands.size(); ++i) {
      if (operands[i].where == Where::kSlot) {
        instruction.operands[i].slot = operands[i].slot * sizeof(Register);
      } else {
        instruction.operands[i].constant = operands[i].constant;
      }
    }
    instruction.to = s.to * sizeof(Register);
    instruction.second = s.second * sizeof(Register);
    return instruction;
  }

  static Result stop(const Instruction*, std::byte*, Register last) {
    if constexpr (!tail_calls) return last;
  }

  static std::vector<Instruction> bind(const Tape& tape) {
    std::vector<Instruction> code;
    code.reserve(tape.steps_.size() + 1);
    for (const TapeStep& s : tape.steps_) code.push_back(instruction(s, handler(s)));
    code.emplace_back();
    if constexpr (tail_calls) code.back().handler = reinterpret_cast<AnyHandler>(&stop);
    return code;
  }

  // At `lanes` points side by side, in rows of as many numbers, with all steps done by `execute` on
  // the memory that it gets. Whether all results are finite.
  template <int lanes, class Execute>
  static bool run(const Tape& tape,
                  const Execute& execute,
                  std::span<const double* const> in,
                  std::span<double* const> out) {
    alignas(64) std::array<std::byte, Tape::kRoom> small;
    const std::size_t bytes = tape.slots_ * sizeof(Register);
    std::byte* const memory = bytes <= Tape::kRoom ? small.data() : tape_memory(bytes);
    // Two sums, so that the additions need not wait for each other.
    V even(0.0);
    V odd(0.0);
    for (int first = 0; first < lanes; first += Ops::kSize) {
      for (const TapeRows& rows : tape.in_) {
        const double* from = in[rows.group] + rows.row * lanes + first;
        std::byte* to = memory + rows.slot * sizeof(Register);
        for (std::uint32_t i = 0; i < rows.count; ++i, from += lanes, to += sizeof(Register)) {
          store(Ops::load(from), to);
        }
      }
      execute(memory);
      for (std::size_t group = 0; group < tape.out_.size(); ++group) {
        if (out[group] == nullptr || tape.out_[group].empty()) continue;
        double* to = out[group] + first;
        const std::uint32_t* slot = tape.out_[group].data();
        const std::uint32_t* const end = slot + tape.out_[group].size();
        const auto copy = [&](V& finite) {
          const V x =
              Ops::of(*reinterpret_cast<const Register*>(memory + *slot * sizeof(Register)));
          Ops::store(x, to);
          finite += V(0.0) * x;
          to += lanes;
          ++slot;
        };
        while (slot + 1 < end) {
          copy(even);
          copy(odd);
        }
        if (slot < end) copy(even);
      }
    }
    return Ops::all(even + odd == V(0.0));
  }

  static void execute(const Instruction* at, std::byte* memory) {
    Register last{};
    if constexpr (tail_calls) {
      reinterpret_cast<Handler>(at->handler)(at, memory, last);
    } else {
      for (; at->handler != nullptr; ++at) {
        last = reinterpret_cast<Handler>(at->handler)(at, memory, last);
      }
    }
  }
};  // namespace carnot::language

}  // namespace carnot::language
