// Whether two fronts are the same, number by number.
#pragma once

#include <gtest/gtest.h>

#include "carnot/shooting/wavefront.h"

namespace carnot::test {

inline void expect_the_same(const FrontMesh& one, const FrontMesh& other) {
  EXPECT_EQ(one.triangles, other.triangles);
  ASSERT_EQ(one.vertices.size(), other.vertices.size());
  for (std::size_t i = 0; i < one.vertices.size(); ++i) {
    EXPECT_EQ(one.vertices[i].q, other.vertices[i].q);
    EXPECT_EQ(one.vertices[i].p0, other.vertices[i].p0);
  }
}

}  // namespace carnot::test
