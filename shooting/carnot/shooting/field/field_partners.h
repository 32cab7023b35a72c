// The processes that work on one field: this one alone, or a team.
//
// Each of a team knows the whole field and comes to the same decisions from it. Where work is cut
// into parts each does some of them, and then they share what came of it. So the field does not
// depend on how many they are. They stop together, too: whoever wants to says so with what it
// shares.
#pragma once

#include <atomic>
#include <functional>

#include "carnot/shooting/field.h"
#include "carnot/shooting/field/field_bytes.h"

namespace carnot::internal {

class FieldPartners {
 public:
  // Keeps a reference.
  explicit FieldPartners(const FieldTeam& team) : team_(team) {}

  [[nodiscard]] bool alone() const { return team_.size == 1; }
  [[nodiscard]] bool leads() const { return team_.rank == 0; }
  // Whether this part of the work, counted from 0, is one for this process.
  [[nodiscard]] bool has(long part) const { return part % team_.size == team_.rank; }
  // Gives the others what `write` writes, and then has `read` read what each of them has written,
  // in the order of their ranks. All must come here. Alone neither is called. Throws
  // std::runtime_error where one of them is elsewhere.
  void share(const std::function<void(ByteWriter&)>& write,
             const std::function<void(ByteReader&)>& read);
  // From any thread: all are to stop. Until they have agreed on that, work may be left undone.
  void stop() { stops_ = true; }
  [[nodiscard]] bool stops() const { return stops_; }
  // Whether one of them had asked for it when they shared something last.
  [[nodiscard]] bool stopped() const { return stopped_; }

 private:
  const FieldTeam& team_;
  std::uint64_t shared_ = 0;  // times
  std::atomic<bool> stops_{false};
  bool stopped_ = false;
};

}  // namespace carnot::internal
