// Limits in C++, differentiated by dual numbers:
//
//   problem.limits.push_back(make_limit<4>(
//       "steering", [](const auto& q) { return q[3] - q[2]; }, -0.6, 0.6));
#pragma once

#include <string>
#include <utility>

#include "carnot/numerics/jet.h"
#include "carnot/numerics/linear_algebra.h"
#include "carnot/scene/limit.h"

namespace carnot {

// A limit lower <= f(q) <= upper on a scene of n coordinates. f takes a vector of any scalar type.
template <int n, class F>
Limit make_limit(std::string name,
                 F f,
                 double lower,
                 double upper = std::numeric_limits<double>::infinity()) {
  Limit limit;
  limit.name = std::move(name);
  limit.lower = lower;
  limit.upper = upper;
  limit.value = [f = std::move(f)](const double* q, double* gradient, double* hessian) {
    using First = Jet<double, n>;
    using Second = Jet<First, n>;
    Vector<Second, n> x;
    for (int i = 0; i < n; ++i) x[i] = Second(First(q[i], i), i);
    const Second y = f(x);
    for (int i = 0; i < n && gradient != nullptr; ++i) gradient[i] = y.a.v[i];
    for (int i = 0; i < n * n && hessian != nullptr; ++i) hessian[i] = y.v[i / n].v[i % n];
    return y.a.a;
  };
  return limit;
}

}  // namespace carnot
