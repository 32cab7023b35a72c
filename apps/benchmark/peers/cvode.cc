// CVODE of SUNDIALS: multistep methods of variable order.
#include <cvode/cvode.h>
#include <sunlinsol/sunlinsol_dense.h>
#include <sunmatrix/sunmatrix_dense.h>
#include <sunnonlinsol/sunnonlinsol_fixedpoint.h>

#include <algorithm>
#include <memory>

#include "benchmark/benchmark_rates.h"
#include "benchmark/peers/peer.h"
#include "benchmark/peers/sundials_memory.h"

namespace carnot::apps {
namespace {

template <class Rate>
int cvode_rate(double /*t*/, N_Vector z, N_Vector f, void* /*data*/) {
  Rate{}(NV_DATA_S(z), NV_DATA_S(f));
  return 0;
}

// Adams' methods with fixed-point iteration, or BDF with Newton's and a dense matrix of
// differences.
template <class Rate>
Peer make_peer(int family, double duration, double tolerance) {
  const auto own = std::make_shared<SundialsMemory>();
  own->state = N_VNew_Serial(Rate::kSize, own->context);
  N_VConst(0, own->state);
  own->solver = CVodeCreate(family, own->context);
  own->free_solver = CVodeFree;
  CVodeSetErrFile(own->solver, nullptr);
  CVodeInit(own->solver, cvode_rate<Rate>, 0, own->state);
  CVodeSStolerances(own->solver, tolerance, tolerance);
  if (family == CV_ADAMS) {
    own->nonlinear = SUNNonlinSol_FixedPoint(own->state, 0, own->context);
    CVodeSetNonlinearSolver(own->solver, own->nonlinear);
  } else {
    own->matrix = SUNDenseMatrix(Rate::kSize, Rate::kSize, own->context);
    own->linear = SUNLinSol_Dense(own->state, own->matrix, own->context);
    CVodeSetLinearSolver(own->solver, own->linear, own->matrix);
  }
  const auto solve = [own, family, duration](double* z, const PeerObserver& observe) -> PeerEnd {
    double* const state = NV_DATA_S(own->state);
    std::copy_n(z, Rate::kSize, state);
    CVodeReInit(own->solver, 0, own->state);
    CVodeSetStopTime(own->solver, duration);
    int status = CV_SUCCESS;
    double t = 0;
    for (long step = 0; status == CV_SUCCESS && step < kMostPeerSteps; ++step) {
      status = CVode(own->solver, duration, own->state, &t, CV_ONE_STEP);
      if (observe && status >= 0) observe(state);
    }
    std::copy_n(state, Rate::kSize, z);
    long evaluations = 0;
    long for_matrix = 0;
    CVodeGetNumRhsEvals(own->solver, &evaluations);
    if (family == CV_BDF) CVodeGetNumLinRhsEvals(own->solver, &for_matrix);
    return {status == CV_TSTOP_RETURN, evaluations + for_matrix};
  };
  return {family == CV_ADAMS ? "cvode-adams" : "cvode-bdf", solve};
}

}  // namespace

std::vector<Peer> cvode_peers(const BenchmarkTrajectory& trajectory, double tolerance) {
  return with_rate(trajectory.scene, [&](auto rate) -> std::vector<Peer> {
    using Rate = decltype(rate);
    return {make_peer<Rate>(CV_ADAMS, trajectory.duration, tolerance),
            make_peer<Rate>(CV_BDF, trajectory.duration, tolerance)};
  });
}

}  // namespace carnot::apps
