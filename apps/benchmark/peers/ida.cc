// IDA of SUNDIALS: BDF on the differential-algebraic equations, with the multipliers as unknowns.
#include <ida/ida.h>
#include <sunlinsol/sunlinsol_dense.h>
#include <sunmatrix/sunmatrix_dense.h>

#include <algorithm>
#include <memory>

#include "benchmark/peers/dae_residuals.h"
#include "benchmark/peers/peer.h"
#include "benchmark/peers/sundials_memory.h"

namespace carnot::apps {
namespace {

template <class Dae>
int ida_residual(double /*t*/, N_Vector u, N_Vector u_dot, N_Vector r, void* /*data*/) {
  Dae{}(NV_DATA_S(u), NV_DATA_S(u_dot), NV_DATA_S(r));
  return 0;
}

// Consistent values of all unknowns at z, and the derivatives of those that have some.
template <class Dae>
void set_start(const double* z, double* u, double* u_dot) {
  constexpr int n = Dae::kDof;
  std::fill_n(u_dot, Dae::kSize, 0.0);
  std::copy_n(z, 2 * n, u);
  typename Dae::Rate{}(z, u_dot);
  std::copy_n(u_dot, n, u + 2 * n);
  std::copy(Dae::kStartMultipliers.begin(), Dae::kStartMultipliers.end(), u + 3 * n);
}

template <class Dae>
std::vector<Peer> make_peer(double duration, double tolerance) {
  const auto own = std::make_shared<SundialsMemory>();
  own->state = N_VNew_Serial(Dae::kSize, own->context);
  own->rate = N_VNew_Serial(Dae::kSize, own->context);
  N_VConst(0, own->state);
  N_VConst(0, own->rate);
  own->solver = IDACreate(own->context);
  own->free_solver = IDAFree;
  IDASetErrFile(own->solver, nullptr);
  IDAInit(own->solver, ida_residual<Dae>, 0, own->state, own->rate);
  IDASStolerances(own->solver, tolerance, tolerance);
  own->matrix = SUNDenseMatrix(Dae::kSize, Dae::kSize, own->context);
  own->linear = SUNLinSol_Dense(own->state, own->matrix, own->context);
  IDASetLinearSolver(own->solver, own->linear, own->matrix);
  const auto solve = [own, duration](double* z, const PeerObserver& observe) -> PeerEnd {
    double* const state = NV_DATA_S(own->state);
    set_start<Dae>(z, state, NV_DATA_S(own->rate));
    IDAReInit(own->solver, 0, own->state, own->rate);
    IDASetStopTime(own->solver, duration);
    int status = IDA_SUCCESS;
    double t = 0;
    for (long step = 0; status == IDA_SUCCESS && step < kMostPeerSteps; ++step) {
      status = IDASolve(own->solver, duration, &t, own->state, own->rate, IDA_ONE_STEP);
      if (observe && status >= 0) observe(state);
    }
    std::copy_n(state, 2 * Dae::kDof, z);
    long evaluations = 0;
    long for_matrix = 0;
    IDAGetNumResEvals(own->solver, &evaluations);
    IDAGetNumLinResEvals(own->solver, &for_matrix);
    return {status == IDA_TSTOP_RETURN, evaluations + for_matrix};
  };
  return {{"ida", solve}};
}

}  // namespace

std::vector<Peer> ida_peers(const BenchmarkTrajectory& trajectory, double tolerance) {
  if (trajectory.scene == "vehicle") return make_peer<VehicleDae>(trajectory.duration, tolerance);
  if (trajectory.scene == "heisenberg") {
    return make_peer<HeisenbergDae>(trajectory.duration, tolerance);
  }
  return make_peer<VehicleCosineDae>(trajectory.duration, tolerance);
}

}  // namespace carnot::apps
