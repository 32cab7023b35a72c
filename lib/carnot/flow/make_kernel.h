// The compiled kernels: one for each number of coordinates up to kMostCompiled.
#pragma once

#include <span>

#include "carnot/flow/flow_calls.h"
#include "carnot/system/system_functions.h"
#include "carnot/tableau/methods.h"
#include "carnot/tableau/tableau.h"

namespace carnot {

// A scene with more coordinates compiles a kernel of its own.
inline constexpr int kMostCompiled = 12;

// The kernel of a Runge-Kutta method for systems reached through `functions`, which must outlive
// it. `periods` of the n <= kMostCompiled coordinates, 0 where there is none.
Kernel make_kernel(const Tableau<double>& tableau,
                   std::span<const double> periods,
                   const SystemFunctions& functions);

// The same for a method of methods(). Costs its tableau, some microseconds.
Kernel make_kernel(const Method& method,
                   std::span<const double> periods,
                   const SystemFunctions& functions);

}  // namespace carnot
