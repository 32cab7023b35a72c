// The tangent of one Gauss step: exact derivative of the discrete map.
//
// Differentiating the step of gauss.h at its converged stages, with A_i = df/dz(U_i),
//
//   dL_i = h b_i A_i (dz + sum_j mu_ij dL_j),      dz+ = dz + sum_j dL_j,
//
// a linear system. It is solved to round-off by the same fixed point, or by one LU where that does
// not contract. A_i is symmetric after multiplication with J, so dz+ is symplectic exactly when
// mu_ij + mu_ji = 1. Cost: s rates on Jets with 2n directions and about ten products of 2n x 2n
// matrices per stage.
#pragma once

#include <array>

#include "carnot/gauss.h"

namespace carnot {

template <class Step>
class Tangent {
 public:
  using T = typename Step::Scalar;
  static constexpr int kSize = Step::kSize;
  static constexpr int kStages = Step::kStages;
  using Square = Matrix<T, kSize, kSize>;

  // M <- (dz+/dz) M for the step that `step` has just done. False when the linear system is
  // singular; M is then unchanged.
  [[nodiscard]] bool advance(const Step& step, Compensated<Square>& m) {
    const T h = step.last_step();
    for (int i = 0; i < kStages; ++i) {
      const RateStatus status = phase_jacobian(step.system(),
                                               step.stage_time(i),
                                               Vector<T, kSize>(step.stages().col(i)),
                                               step.algebraic(i),
                                               jacobian_[i]);
      if (status != RateStatus::kOk) return false;
      jacobian_[i] *= h * step.tableau().b[i];
    }
    if (!iterate(step, m) && !solve(step, m)) {
      last_step_ = T(0);
      return false;
    }
    last_step_ = h;
    Square sum = increment_[0];
    for (int i = 1; i < kStages; ++i) sum += increment_[i];
    m.add(sum);
    return true;
  }

 private:
  static constexpr int kMaxIterations = 60;

  // First guess, as for the stages: extrapolated from the last step, or A_i dz.
  void predict(const Step& step, const Compensated<Square>& m) {
    if (last_step_ != step.last_step()) {
      for (int i = 0; i < kStages; ++i) increment_[i] = jacobian_[i].lazyProduct(m.value);
      return;
    }
    const std::array<Square, kStages> last = increment_;
    for (int i = 0; i < kStages; ++i) {
      increment_[i] = step.tableau().extrapolation(i, 0) * last[0];
      for (int j = 1; j < kStages; ++j) {
        increment_[i] += step.tableau().extrapolation(i, j) * last[j];
      }
    }
  }

  bool iterate(const Step& step, const Compensated<Square>& m) {
    const T scale = m.value.cwiseAbs().maxCoeff();
    const T resolution = std::numeric_limits<T>::epsilon() * scale;
    predict(step, m);
    T smallest = std::numeric_limits<T>::max();
    for (int iteration = 0; iteration < kMaxIterations; ++iteration) {
      T change(0);
      const std::array<Square, kStages> last = increment_;
      for (int i = 0; i < kStages; ++i) {
        Square argument = m.compensation;
        for (int j = 0; j < kStages; ++j) argument += step.tableau().mu(i, j) * last[j];
        argument += m.value;
        increment_[i] = jacobian_[i].lazyProduct(argument);
        change = std::max(change, (increment_[i] - last[i]).cwiseAbs().maxCoeff());
      }
      if (change <= T(0.25) * resolution) return true;
      if (!(change < smallest)) return smallest <= T(8) * resolution;
      smallest = change;
    }
    return smallest <= T(8) * resolution;
  }

  // (I - h b_i A_i mu_ij) dL = h b_i A_i dz, all stages at once.
  bool solve(const Step& step, const Compensated<Square>& m) {
    constexpr int kTotal = kSize * kStages;
    using RowMajor = Eigen::Matrix<T, kSize, kSize, Eigen::RowMajor>;
    bool finite = true;
    for (int i = 0; i < kStages; ++i) {
      Eigen::Map<RowMajor> rhs(rhs_.data() + i * kSize * kSize);
      rhs = jacobian_[i].lazyProduct(m.value);
      for (int j = 0; j < kStages; ++j) {
        for (int r = 0; r < kSize; ++r) {
          for (int c = 0; c < kSize; ++c) {
            const T identity(i == j && r == c ? 1 : 0);
            matrix_[(i * kSize + r) * kTotal + j * kSize + c] =
                identity - step.tableau().mu(i, j) * jacobian_[i](r, c);
          }
        }
      }
    }
    if (!lu_solve(kTotal, matrix_.data(), kSize, rhs_.data())) return false;
    for (int i = 0; i < kStages; ++i) {
      increment_[i] = Eigen::Map<const RowMajor>(rhs_.data() + i * kSize * kSize);
      finite = finite && increment_[i].allFinite();
    }
    return finite;
  }

  T last_step_ = T(0);
  // Scratch of the fallback.
  std::array<T, kSize * kStages * kSize * kStages> matrix_;
  std::array<T, kSize * kStages * kSize> rhs_;

  std::array<Square, kStages> jacobian_;
  std::array<Square, kStages> increment_;
};

}  // namespace carnot
