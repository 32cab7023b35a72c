#include "carnot/shooting/field/field_store.h"

#include <gtest/gtest.h>

#include <sstream>

namespace carnot::internal::field_store_test {
namespace {

FieldPoint some_point(double seed) {
  FieldPoint point;
  point.sign = -1;
  point.origin = 7;
  point.action = seed;
  point.p0 = Eigen::Vector3d(seed, 2, 3);
  point.p1 = Eigen::Vector3d(4, seed, 6);
  point.inverse = (Eigen::Matrix3d() << 1, 2, 3, 4, 5, 6, 7, 8, seed).finished();
  point.slope = (Eigen::Matrix3d() << 1, 2, 3, 2, 5, 6, 3, 6, seed).finished();
  point.windings = {-1, 300};
  return point;
}

TEST(FieldStore, KeepsWhatIsPut) {
  FieldStore store(5, 3, 2, 1);
  EXPECT_EQ(store.size(), 5);
  EXPECT_FALSE(store.known(3));
  store.put(3, some_point(0.5));
  store.put(4, some_point(0.25));
  EXPECT_TRUE(store.known(3));
  EXPECT_FALSE(store.known(2));
  const FieldPoint point = store.point(store.best(3));
  const FieldPoint expected = some_point(0.5);
  EXPECT_EQ(point.sign, expected.sign);
  EXPECT_EQ(point.origin, expected.origin);
  EXPECT_EQ(point.action, expected.action);
  EXPECT_EQ(point.p0, expected.p0);
  EXPECT_EQ(point.p1, expected.p1);
  EXPECT_EQ(point.inverse, expected.inverse);
  EXPECT_EQ(point.slope, expected.slope);
  EXPECT_EQ(point.windings, expected.windings);
  EXPECT_EQ(store.p0(store.best(3)), expected.p0);
  EXPECT_EQ(store.windings(store.best(3)), expected.windings);
}

TEST(FieldStore, TellsNewsOnceToEach) {
  constexpr auto kSlab = FieldStore::kSlab;
  FieldStore store(1, 3, 2, 1);
  const FieldSlot slot = store.slot(0, 0);
  EXPECT_FALSE(store.has_news(slot, kSlab));
  store.put(0, some_point(3));
  EXPECT_TRUE(store.has_news(slot, kSlab));
  store.told(slot, kSlab);
  EXPECT_FALSE(store.has_news(slot, kSlab));
  EXPECT_TRUE(store.has_news(slot, FieldStore::kUp));
  EXPECT_TRUE(store.has_news(slot, FieldStore::kDown));
  store.replace(slot, some_point(2));
  EXPECT_EQ(store.action(0), 2);
  EXPECT_FALSE(store.has_news(slot, kSlab));
  store.put(0, some_point(1));
  EXPECT_TRUE(store.has_news(slot, kSlab));
}

TEST(FieldStore, WithOneBranchKeepsTheLeast) {
  FieldStore store(1, 3, 2, 1);
  EXPECT_TRUE(store.wants(0, 3));
  EXPECT_TRUE(store.put(0, some_point(2)));
  EXPECT_FALSE(store.wants(0, 3));
  EXPECT_FALSE(store.put(0, some_point(3)));
  EXPECT_EQ(store.action(0), 2);
  EXPECT_TRUE(store.put(0, some_point(1)));
  EXPECT_EQ(store.action(0), 1);
}

// Three extremals for two slots: the one of the most action gives way, whichever slot it has.
TEST(FieldStore, KeepsTheBranchesOfLeastAction) {
  FieldStore store(2, 3, 2, 2);
  EXPECT_EQ(store.put(1, some_point(2)), store.slot(1, 0));
  EXPECT_EQ(store.put(1, some_point(1)), store.slot(1, 1));
  EXPECT_EQ(store.best(1), store.slot(1, 1));
  EXPECT_EQ(store.point_of(store.best(1)), 1);
  EXPECT_FALSE(store.known(0));
  EXPECT_FALSE(store.put(1, some_point(3)));
  EXPECT_TRUE(store.wants(1, 1.5));
  EXPECT_EQ(store.put(1, some_point(1.5)), store.slot(1, 0));
  EXPECT_EQ(store.action(1), 1);
  EXPECT_EQ(store.put(1, some_point(0.5)), store.slot(1, 0));
  EXPECT_EQ(store.best(1), store.slot(1, 0));
}

TEST(FieldStore, KeepsAnExtremalOnce) {
  constexpr double kRounded = 1e-12;
  FieldStore store(1, 3, 2, 2);
  store.put(0, some_point(1));
  EXPECT_FALSE(store.put(0, some_point(1 + kRounded)));
  FieldPoint finer = some_point(1);
  finer.action = 0.9;
  EXPECT_EQ(store.put(0, finer), store.slot(0, 0));
  FieldPoint around = some_point(1);  // by another number of turns
  around.windings = {0, 300};
  EXPECT_EQ(store.put(0, around), store.slot(0, 1));
  EXPECT_EQ(store.action(0), 0.9);
}

TEST(FieldStore, IsDoubtedUntilItsLeastActionIsLess) {
  FieldStore store(1, 3, 2, 2);
  store.put(0, some_point(2));
  store.doubt(0);
  EXPECT_TRUE(store.doubted(0));
  store.put(0, some_point(3));
  EXPECT_TRUE(store.doubted(0));
  store.put(0, some_point(1));
  EXPECT_FALSE(store.doubted(0));
}

// A state is what a store keeps in memory, and two numbers of each list besides.
TEST(FieldStore, TakesFewerThan300BytesForAPointOfFourCoordinates) {
  constexpr long kPoints = 1000;
  constexpr std::size_t kMost = 300;
  std::ostringstream state;
  ByteWriter bytes(state);
  FieldStore(kPoints, 4, 4, 1).write(bytes);
  EXPECT_LE(state.str().size(), kMost * kPoints);
  EXPECT_GE(state.str().size(), 8 * (8 + 16 + 10) * kPoints);
}

}  // namespace
}  // namespace carnot::internal::field_store_test
