// A start that is pulled tight: a discrete extremal for tests to begin with.
#pragma once

#include <gtest/gtest.h>

#include <vector>

#include "carnot/shooting/search/relaxed_start.h"
#include "carnot/shooting/search/starts.h"

namespace carnot::test {

inline internal::Path tight_path(const BoundaryValueProblem& problem,
                                 int number = 2,
                                 int intervals = 32) {
  const internal::MassLadder ladder(problem);
  internal::Start start = internal::make_start(problem, 0, number, intervals);
  std::vector<internal::RelaxedStart> tight = internal::relaxed(ladder, {}, {&start, 1});
  EXPECT_TRUE(tight[0].found);
  return tight[0].path;
}

}  // namespace carnot::test
