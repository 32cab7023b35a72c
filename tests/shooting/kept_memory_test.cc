// Memory that a thread keeps: it comes back for the next vector of the same size, and for no other.
#include "carnot/shooting/linear/kept_memory.h"

#include <gtest/gtest.h>

#include <cstdint>
#include <set>
#include <thread>
#include <vector>

#include "carnot/shooting/linear/lanes.h"

namespace carnot::internal::kept_memory_test {
namespace {

using Vector = std::vector<Lanes, KeptMemory<Lanes>>;

const void* place_of_new(std::size_t size) { return Vector(size).data(); }

TEST(KeptMemory, ComesBackForTheSameSize) {
  const void* const first = place_of_new(101);
  EXPECT_EQ(place_of_new(101), first);
  const Vector other(102);
  EXPECT_NE(other.data(), first);
  EXPECT_EQ(place_of_new(101), first);
}

TEST(KeptMemory, IsOfOneVectorAtATime) {
  std::set<const void*> places;
  std::vector<Vector> vectors;
  for (int i = 0; i < 40; ++i) {
    vectors.emplace_back(103);
    places.insert(vectors.back().data());
    EXPECT_EQ(reinterpret_cast<std::uintptr_t>(vectors.back().data()) % alignof(Lanes), 0u);
  }
  EXPECT_EQ(places.size(), vectors.size());
}

// A vector may end in another thread than it began in.
TEST(KeptMemory, MayGoToAnotherThread) {
  Vector vector(106);
  std::thread([moved = std::move(vector)]() mutable { Vector().swap(moved); }).join();
  EXPECT_EQ(Vector(106).size(), 106u);
}

}  // namespace
}  // namespace carnot::internal::kept_memory_test
