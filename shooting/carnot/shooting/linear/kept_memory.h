// Memory that its thread keeps for the next vector of the same size.
//
// A search makes the same large matrices in every round. The C library hands the end of the heap
// back to the system when a large piece of it is freed, and takes it again page by page. Without
// that, searches to random targets of vehicle and trailer1 and sideways parking take 0.91 of the
// time on one thread (Zen 5). A helper of parallel_for ends with its round, and keeps nothing.
#pragma once

#include <array>
#include <cstddef>
#include <new>
#include <utility>

namespace carnot::internal {

// A few blocks of a thread, those that it gave back last.
class KeptBlocks {
 public:
  KeptBlocks() = default;
  KeptBlocks(const KeptBlocks&) = delete;
  KeptBlocks& operator=(const KeptBlocks&) = delete;
  ~KeptBlocks() {
    for (Block& block : blocks_) release(block);
  }

  static KeptBlocks& of_thread() {
    thread_local KeptBlocks blocks;
    return blocks;
  }

  void* take(std::size_t size) {
    for (Block& block : blocks_) {
      if (block.size == size) return std::exchange(block, {}).begin;
    }
    return ::operator new(size, kAlignment);
  }
  void give_back(void* begin, std::size_t size) noexcept {
    for (Block& block : blocks_) {
      if (block.begin == nullptr) {
        block = {begin, size};
        return;
      }
    }
    release(blocks_[oldest_]);
    blocks_[oldest_] = {begin, size};
    oldest_ = (oldest_ + 1) % blocks_.size();
  }

 private:
  struct Block {
    void* begin = nullptr;
    std::size_t size = 0;
  };
  static constexpr std::align_val_t kAlignment{64};

  static void release(Block& block) noexcept {
    ::operator delete(std::exchange(block, {}).begin, kAlignment);
  }

  // Three matrices of Newton's method and three of least squares, of two grids that take turns.
  std::array<Block, 12> blocks_;
  std::size_t oldest_ = 0;
};

// An allocator of such memory, for large vectors.
template <class T>
struct KeptMemory {
  static_assert(alignof(T) <= 64);
  using value_type = T;

  KeptMemory() = default;
  template <class Other>
  explicit KeptMemory(const KeptMemory<Other>& /*other*/) {}

  [[nodiscard]] T* allocate(std::size_t count) {
    return static_cast<T*>(KeptBlocks::of_thread().take(count * sizeof(T)));
  }
  void deallocate(T* begin, std::size_t count) noexcept {
    KeptBlocks::of_thread().give_back(begin, count * sizeof(T));
  }
  friend bool operator==(const KeptMemory& /*a*/, const KeptMemory& /*b*/) { return true; }
};

}  // namespace carnot::internal
