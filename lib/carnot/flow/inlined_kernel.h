// Kernels that know their system: the compiler sees through each call of it.
#pragma once

#include <span>

#include "carnot/flow/kernel.h"
#include "carnot/tableau/tableau.h"

namespace carnot {

// Of any Runge-Kutta method.
template <class System>
Kernel make_inlined_kernel(const Tableau<double>& tableau, std::span<const double> periods) {
  using namespace kernel;
  const auto winding = winding_of<System::kDof>(periods);
  if (fits_in_rows(tableau)) {
    using M = Direct<RungeKutta<System, kRowStages>>;
    Kernel kernel = kernel_of(M{fixed_stages<kRowStages>(tableau), winding});
    add_automatic_flow<M>(tableau, kernel);
    kernel.fills_packs = PacksRates<System> && tableau.stages() == kRowStages;
    return kernel;
  }
  using M = Direct<RungeKutta<System>>;
  Kernel kernel = kernel_of(M{tableau, winding});
  add_automatic_flow<M>(tableau, kernel);
  return kernel;
}

}  // namespace carnot
