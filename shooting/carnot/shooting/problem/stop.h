// When work has to end: its time is up, or its caller says so.
#pragma once

#include <atomic>
#include <chrono>
#include <cmath>
#include <exception>
#include <functional>
#include <memory>
#include <optional>
#include <thread>
#include <utility>

namespace carnot::internal {

// Copies are one: what has to end for one of them has to end for all, and stays so.
//
// Work asks from all of its threads, between any two parts that may take a tenth of a second. The
// caller is asked by the thread that made the first copy only, for it need not be ready for others.
class Stop {
 public:
  // Never.
  Stop() = default;
  // In so many seconds, never where they are infinite; or when `goes_on` returns false or throws.
  explicit Stop(double seconds, std::function<bool()> goes_on = {})
      : state_(std::make_shared<State>()) {
    state_->goes_on = std::move(goes_on);
    constexpr double kMost = 1e9;  // a lifetime, and no overflow
    if (!(seconds < kMost)) return;
    const std::chrono::duration<double> left(seconds);
    state_->end = Clock::now() + std::chrono::duration_cast<Clock::duration>(left);
  }

  [[nodiscard]] bool reached() const {
    if (!state_) return false;
    if (state_->why != Why::kNot) return true;
    Why not_yet = Why::kNot;
    if (state_->end && Clock::now() >= *state_->end) {
      state_->why.compare_exchange_strong(not_yet, Why::kLate);
    }
    const bool may_ask = state_->goes_on && std::this_thread::get_id() == state_->owner;
    if (may_ask && !caller_goes_on()) state_->why = Why::kAsked;  // also where it is late
    return state_->why != Why::kNot;
  }
  // Throws what the caller threw when it was asked. Work calls this when its threads have ended.
  void rethrow() const {
    if (state_ && state_->thrown) std::rethrow_exception(state_->thrown);
  }
  // Whether work was told to end since its time was up; since the caller said so.
  [[nodiscard]] bool late() const { return state_ && state_->why == Why::kLate; }
  [[nodiscard]] bool asked() const { return state_ && state_->why == Why::kAsked; }
  // Seconds that are left, at least zero.
  [[nodiscard]] double left() const {
    if (!state_ || !state_->end) return HUGE_VAL;
    const std::chrono::duration<double> left = *state_->end - Clock::now();
    return left.count() > 0 ? left.count() : 0;
  }

 private:
  using Clock = std::chrono::steady_clock;
  enum class Why { kNot, kLate, kAsked };
  struct State {
    std::function<bool()> goes_on;
    std::optional<Clock::time_point> end;
    std::thread::id owner = std::this_thread::get_id();
    std::atomic<Why> why{Why::kNot};
    std::exception_ptr thrown;  // is of the owner
  };
  [[nodiscard]] bool caller_goes_on() const {
    try {
      return state_->goes_on();
    } catch (...) {
      state_->thrown = std::current_exception();
      return false;
    }
  }

  std::shared_ptr<State> state_;
};

}  // namespace carnot::internal
