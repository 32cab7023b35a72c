// Answers by question, the oldest dropped where there are too many. Safe to use from many threads.
#pragma once

#include <cstddef>
#include <deque>
#include <functional>
#include <memory>
#include <mutex>
#include <string_view>
#include <unordered_map>
#include <vector>

namespace carnot::internal {

struct SteeringAnswer;

class SteeringMemory {
 public:
  using Key = std::vector<double>;  // without -0 and NaN: equal keys have equal bits
  using Value = std::shared_ptr<const SteeringAnswer>;

  explicit SteeringMemory(std::size_t capacity) : capacity_(capacity) {}

  // Null where there is none. No allocation.
  [[nodiscard]] Value find(const Key& key) const {
    const std::lock_guard lock(mutex_);
    const auto found = answers_.find(key);
    return found == answers_.end() ? nullptr : found->second;
  }

  // Keeps the first of equal questions.
  void insert(const Key& key, const Value& value) {
    if (capacity_ == 0) return;
    const std::lock_guard lock(mutex_);
    const auto [place, fresh] = answers_.try_emplace(key, value);
    if (!fresh) return;
    order_.push_back(&place->first);
    if (order_.size() <= capacity_) return;
    answers_.erase(answers_.find(*order_.front()));
    order_.pop_front();
  }

 private:
  struct Hash {
    std::size_t operator()(const Key& key) const {
      const auto* bytes = reinterpret_cast<const char*>(key.data());
      return std::hash<std::string_view>{}({bytes, key.size() * sizeof(double)});
    }
  };

  std::size_t capacity_;
  mutable std::mutex mutex_;
  std::unordered_map<Key, Value, Hash> answers_;
  std::deque<const Key*> order_;  // of the map, whose nodes stay where they are
};

}  // namespace carnot::internal
