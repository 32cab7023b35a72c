// What SUNDIALS allocates, freed in the right order.
#pragma once

#include <nvector/nvector_serial.h>
#include <sundials/sundials_context.h>
#include <sundials/sundials_linearsolver.h>
#include <sundials/sundials_matrix.h>
#include <sundials/sundials_nonlinearsolver.h>

namespace carnot::apps {

// Members that were not needed stay null.
struct SundialsMemory {
  SUNContext context = nullptr;
  void* solver = nullptr;
  void (*free_solver)(void**) = nullptr;  // CVodeFree or IDAFree
  N_Vector state = nullptr;
  N_Vector rate = nullptr;
  SUNMatrix matrix = nullptr;
  SUNLinearSolver linear = nullptr;
  SUNNonlinearSolver nonlinear = nullptr;

  SundialsMemory() { SUNContext_Create(nullptr, &context); }
  SundialsMemory(const SundialsMemory&) = delete;
  SundialsMemory& operator=(const SundialsMemory&) = delete;
  ~SundialsMemory() {
    if (solver != nullptr) free_solver(&solver);
    if (nonlinear != nullptr) SUNNonlinSolFree(nonlinear);
    if (linear != nullptr) SUNLinSolFree(linear);
    if (matrix != nullptr) SUNMatDestroy(matrix);
    if (rate != nullptr) N_VDestroy(rate);
    if (state != nullptr) N_VDestroy(state);
    SUNContext_Free(&context);
  }
};

}  // namespace carnot::apps
