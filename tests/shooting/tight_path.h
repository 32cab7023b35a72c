// A start that is pulled tight: a discrete extremal for tests to begin with.
#pragma once

#include <gtest/gtest.h>

#include "carnot/shooting/search/relaxed_start.h"
#include "carnot/shooting/search/starts.h"

namespace carnot::test {

inline internal::Path tight_path(const BoundaryValueProblem& problem,
                                 int number = 2,
                                 int intervals = 32) {
  const internal::Start start = internal::make_start(problem, 0, number, intervals);
  internal::RelaxedStart tight = internal::relaxed(problem, start, 0);
  EXPECT_TRUE(tight.found);
  return tight.path;
}

}  // namespace carnot::test
