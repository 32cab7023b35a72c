#include "carnot/language/native_tape.h"

#ifdef CARNOT_NATIVE_TAPES

#include <exception>
#include <span>
#include <vector>

#include "carnot/language/native_writer.h"

namespace carnot::language {
namespace {

template <class V>
class MemoryOf : public NativeTape::Memory {
 public:
  explicit MemoryOf(const TapeParts& tape)
      : calls_(calls_of(tape.steps)), code_(kPage, Xbyak::AutoGrow) {
    NativeWriter<V> writer(tape, calls_, code_);
    writer.write();
    bytes_ = writer.bytes();
  }
  [[nodiscard]] NativeTape::Code code() const override { return code_.getCode<NativeTape::Code>(); }
  [[nodiscard]] std::size_t bytes() const override { return bytes_; }

 private:
  static constexpr std::size_t kPage = 4096;

  static std::vector<TapeInstruction> calls_of(std::span<const TapeStep> steps) {
    using Interpreter = TapeMachine<V, false>;
    std::vector<TapeInstruction> calls;
    for (const TapeStep& s : steps) {
      if (s.operation != TapeOperation::kFunction && s.operation != TapeOperation::kAtan2) continue;
      calls.push_back(Interpreter::instruction(s, Interpreter::function(s)));
    }
    return calls;
  }

  const std::vector<TapeInstruction> calls_;  // whose places are in the code
  Xbyak::CodeGenerator code_;
  std::size_t bytes_ = 0;
};

std::unique_ptr<const NativeTape::Memory> memory_of(const TapeParts& tape) {
  if constexpr (NativeMachine<WideNumber>::kExists) {
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
    if (!memory_) return;
    bytes_ = memory_->bytes();
    code_.store(memory_->code(), std::memory_order_release);
  });
  return code();
}

}  // namespace carnot::language
