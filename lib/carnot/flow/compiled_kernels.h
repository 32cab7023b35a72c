// make_erased_kernel<n>() for each n, compiled in a file of its own (kernel_of_size.cc.in).
#pragma once

#include <span>

#include "carnot/flow/flow_calls.h"
#include "carnot/system/system_functions.h"
#include "carnot/tableau/tableau.h"

namespace carnot {

using KernelMaker = Kernel(const Tableau<double>& tableau,
                           std::span<const double> periods,
                           const SystemFunctions& functions);

KernelMaker make_kernel_1;
KernelMaker make_kernel_2;
KernelMaker make_kernel_3;
KernelMaker make_kernel_4;
KernelMaker make_kernel_5;
KernelMaker make_kernel_6;
KernelMaker make_kernel_7;
KernelMaker make_kernel_8;
KernelMaker make_kernel_9;
KernelMaker make_kernel_10;
KernelMaker make_kernel_11;
KernelMaker make_kernel_12;

}  // namespace carnot
