// The discrete Lagrangian of a path in the midpoint transcription, for scenes of every kind.
//
// With velocity constraints and a transcription of their own, it is that of
// midpoint_transcription.h, and its multipliers are those of the constraints. For every other kind
//
//   F_d(q0, q1, lambda) = h [lambda.v - H(t, qm, lambda)],   qm = (q0 + q1)/2,   v = (q1 - q0)/h,
//
// at the middle t of the interval. Its n multipliers are the momenta there: D3 F_d = 0 is v = H_p.
// Stationary sums of F_d with momenta p0 = -D1 F_d, p1 = D2 F_d at the nodes are again the midpoint
// rule of the index-1 system (McLachlan et al. 2013, Prop. 4, with one stage).
#pragma once

#include <functional>
#include <optional>
#include <vector>

#include "carnot/dynamics.h"
#include "carnot/shooting/path/path.h"
#include "carnot/shooting/problem/hamiltonian_terms.h"

namespace carnot::internal {

// Evaluates `terms` at the middles of the next intervals of length h from `first` on, as many as it
// takes, with the momenta path.lambda. False where H cannot be evaluated at one of them.
bool evaluate_middles(
    const Path& path, double h, int first, HamiltonianTerms::Order order, HamiltonianTerms& terms);

class PathLagrangian {
 public:
  // Numbers of one interval. Those of others may stand between them.
  class Numbers {
   public:
    Numbers(const double* first, int stride, int size)
        : first_(first), stride_(stride), size_(size) {}
    double operator[](int i) const { return first_[i * stride_]; }
    [[nodiscard]] int size() const { return size_; }
    // `size` of them from number i on.
    [[nodiscard]] Numbers part(int i, int size) const {
      return {first_ + i * stride_, stride_, size};
    }

   private:
    const double* first_;
    int stride_;
    int size_;
  };
  // The terms of one interval: F_d by x = (q0, q1, lambda).
  struct Terms {
    Numbers x;
    Numbers gradient;
    Numbers hessian;  // row-major; of no size where it is not wanted
  };

  // For intervals of length h. `drift` as in hamiltonian_terms.h, 1 where there is a transcription.
  // Keeps a reference to the dynamics.
  PathLagrangian(const Dynamics& dynamics, double h, double drift = 1);

  // Number of multipliers of an interval.
  [[nodiscard]] static int multipliers(const Dynamics& dynamics) {
    return dynamics.has_transcription() ? dynamics.transcribed : dynamics.dof;
  }

  // Calls visit(i, terms) for each interval in order. Terms that cannot be evaluated are NaN.
  void visit(const Path& path, bool second, const std::function<void(int, const Terms&)>& visit);
  // sum h L at the middles, without those where it cannot be evaluated.
  double action(const Path& path);

 private:
  static constexpr int kLanes = Dynamics::kMidpointLanes;

  // Sets middle_ and velocity_.
  void set_middle(const Path& path, int i);
  // How many intervals are evaluated at once from `first` on.
  [[nodiscard]] int together(const Path& path, int first) const;
  // Evaluates the transcription on intervals side by side.
  void transcribe(const Path& path, int first, int count, bool second);
  void set_gradient(int point, const double* p);
  void set_hessian(int point);

  const Dynamics& dynamics_;
  double h_;
  int n_;
  int k_;
  std::optional<HamiltonianTerms> terms_;  // where there is no transcription
  int lanes_;  // intervals whose terms stand side by side: kLanes of the transcription, or one
  std::vector<double> x_;
  std::vector<double> gradient_;
  std::vector<double> hessian_;
  std::vector<double> own_x_;  // of one interval
  std::vector<double> middle_;
  std::vector<double> velocity_;
  std::vector<double> values_;  // of the transcription at a middle
};

}  // namespace carnot::internal
