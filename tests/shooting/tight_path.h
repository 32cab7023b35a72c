// A start that is pulled tight: a discrete extremal for tests to begin with.
#pragma once

#include <gtest/gtest.h>

#include "carnot/shooting/path/discrete_newton.h"
#include "carnot/shooting/path/relaxation.h"
#include "carnot/shooting/search/starts.h"

namespace carnot::test {

inline internal::Path tight_path(const BoundaryValueProblem& problem,
                                 int number = 2,
                                 int intervals = 32) {
  internal::Start start = internal::make_start(problem, 0, number, intervals);
  (void)internal::relax(problem, start.relaxation, start.path);
  EXPECT_TRUE(internal::tighten(problem, {}, start.path).converged);
  return start.path;
}

}  // namespace carnot::test
