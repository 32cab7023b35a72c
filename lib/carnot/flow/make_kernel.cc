#include "carnot/flow/make_kernel.h"

#include <array>
#include <cassert>

#include "carnot/flow/compiled_kernels.h"
#include "carnot/tableau/make_tableau.h"

namespace carnot {

Kernel make_kernel(const Tableau<double>& tableau,
                   std::span<const double> periods,
                   const SystemFunctions& functions) {
  constexpr std::array kKernels{make_kernel_1,
                                make_kernel_2,
                                make_kernel_3,
                                make_kernel_4,
                                make_kernel_5,
                                make_kernel_6,
                                make_kernel_7,
                                make_kernel_8,
                                make_kernel_9,
                                make_kernel_10,
                                make_kernel_11,
                                make_kernel_12};
  static_assert(kKernels.size() == kMostCompiled);
  assert(1 <= functions.dof && functions.dof <= kMostCompiled);
  return kKernels[functions.dof - 1](tableau, periods, functions);
}

Kernel make_kernel(const Method& method,
                   std::span<const double> periods,
                   const SystemFunctions& functions) {
  return make_kernel(make_tableau(method), periods, functions);
}

}  // namespace carnot
