// Counts calls of malloc and the like by the calling thread, so that Eigen's own allocations and
// operator new are seen too. Defines them: for one source file of a program.
#pragma once

#if defined(__GLIBC__) && !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
#define CARNOT_TEST_COUNTS_MALLOC 1

#include <cstdlib>

namespace carnot::test {

inline thread_local long allocations = 0;

template <class F>
long allocations_in(const F& f) {
  const long before = allocations;
  f();
  return allocations - before;
}

}  // namespace carnot::test

extern "C" {
// NOLINTBEGIN(bugprone-reserved-identifier, readability-identifier-naming): glibc's own names
void* __libc_malloc(std::size_t size);
void* __libc_calloc(std::size_t count, std::size_t size);
void* __libc_realloc(void* old, std::size_t size);
void* __libc_memalign(std::size_t alignment, std::size_t size);
// NOLINTEND(bugprone-reserved-identifier, readability-identifier-naming)

void* malloc(std::size_t size) noexcept {
  ++carnot::test::allocations;
  return __libc_malloc(size);
}
void* calloc(std::size_t count, std::size_t size) noexcept {
  ++carnot::test::allocations;
  return __libc_calloc(count, size);
}
void* realloc(void* old, std::size_t size) noexcept {
  ++carnot::test::allocations;
  return __libc_realloc(old, size);
}
void* aligned_alloc(std::size_t alignment, std::size_t size) noexcept {
  ++carnot::test::allocations;
  return __libc_memalign(alignment, size);
}
}

#endif
