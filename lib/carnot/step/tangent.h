// The tangent of one step: exact derivative of the discrete map.
//
// Differentiating the step of runge_kutta.h at its converged stages, with A_i = h omega_i
// df/dz(U_i),
//
//   dL_i = A_i (dz + sum_j mu_ij dL_j),      dz+ = dz + sum_j u_j dL_j,
//
// a linear system. Coupled stages are solved to round-off by the same fixed point, or by one LU
// where that does not contract; the others one after the other. A_i is symmetric after
// multiplication with J, so dz+ is symplectic exactly when mu_ij + mu_p_ji = 1. Cost: s rates on
// Jets with 2n directions and about ten products of 2n x 2n matrices per stage.
//
// Loops over entries: see linear_algebra.h.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

#include "carnot/numerics/balance.h"
#include "carnot/numerics/scalar.h"
#include "carnot/step/runge_kutta.h"

namespace carnot {

template <class Step>
class Tangent {
 public:
  using T = typename Step::Scalar;
  static constexpr int kSize = Step::kSize;
  static constexpr int kDof = Step::kDof;
  using Square = Matrix<T, kSize, kSize>;

  // M <- (dz+/dz) M for the step that `step` has just done. False when the linear system is
  // singular or its solution not finite; M is then unchanged.
  [[nodiscard]] bool advance(const Step& step, Compensated<Square>& m) {
    const T h = step.last_step();
    const T in_packs_before = std::exchange(packed_step_, T(0));
    const T plain_before = std::exchange(plain_step_, T(0));
    count_ = step.tableau().stages();
    failure_ = RateStatus::kNotFinite;
    Square sum;
    if (in_packs(step, h != T(0) && in_packs_before == h, m, sum)) {
      packed_step_ = h;
    } else {
      const bool repeated = h != T(0) && plain_before == h;
      if (!linearize(step)) return false;
      const bool coupled = step.tableau().coupling == Coupling::kFull;
      if (!(coupled ? iterate(step, repeated, m) || solve(step, m) : solve_in_turn(step, m))) {
        return false;
      }
      set_zero(sum);
      for (int i = 0; i < count_; ++i) add(step.tableau().update[i], increment_[i], sum);
    }
    if (!all_finite(sum)) return false;
    if (packed_step_ == T(0)) plain_step_ = h;
    m.add(sum);
    moved_ = sum;
    return true;
  }
  // M <- identity. What the last step added is then taken for what it would have added to that:
  // from there the next one is extrapolated, as where M goes on.
  void restart(Compensated<Square>& m) {
    const Square inverse = symplectic_inverse(m.value);
    if (packed_step_ != T(0)) {
      for (int r = 0; r < kSize; ++r) packed_row_by(inverse, r);
    }
    for (int i = 0; plain_step_ != T(0) && i < count_; ++i) {
      multiply(increment_[i], inverse, last_[i]);
      increment_[i] = last_[i];
    }
    multiply(moved_, inverse, m.compensation);
    moved_ = m.compensation;
    m.value = identity<kSize, T>();
    set_zero(m.compensation);
  }
  // Why the last advance() failed.
  [[nodiscard]] RateStatus failure() const { return failure_; }

 private:
  static constexpr int kMaxIterations = 60;
  static constexpr int kEntries = kSize * kSize;

  static void set_zero(Square& a) { std::fill_n(a.data(), kEntries, T(0)); }
  // b += weight a.
  static void add(const T& weight, const Square& a, Square& b) {
    for (int k = 0; k < kEntries; ++k) b.data()[k] += weight * a.data()[k];
  }
  // c = a b, which is neither of them.
  static void multiply(const Square& a, const Square& b, Square& c) {
    for (int j = 0; j < kSize; ++j) {
      std::array<T, kSize> column;
      column.fill(T(0));
      for (int k = 0; k < kSize; ++k) {
        for (int i = 0; i < kSize; ++i) column[i] += a(i, k) * b(k, j);
      }
      for (int i = 0; i < kSize; ++i) c(i, j) = column[i];
    }
  }

  // -J M'J: the inverse of M where it is symplectic, as that of a step is, but for methods of
  // another kind.
  static Square symplectic_inverse(const Square& m) {
    Square inverse;
    for (int r = 0; r < kDof; ++r) {
      for (int c = 0; c < kDof; ++c) {
        inverse(r, c) = m(kDof + c, kDof + r);
        inverse(r, kDof + c) = -m(c, kDof + r);
        inverse(kDof + r, c) = -m(kDof + c, r);
        inverse(kDof + r, kDof + c) = m(c, r);
      }
    }
    return inverse;
  }
  // Row r of the increments of all stages side by side, times a matrix.
  void packed_row_by(const Square& matrix, int r) {
    if constexpr (Step::kRows) {
      constexpr int s = Step::kLanes;
      std::array<T, kSize * s> row;
      row.fill(T(0));
      const auto entry = [&](int c) { return &tangents_[(c * kSize + r) * s]; };
      for (int c = 0; c < kSize; ++c) {
        for (int j = 0; j < kSize; ++j) {
          for (int l = 0; l < s; ++l) row[c * s + l] += matrix(j, c) * entry(j)[l];
        }
      }
      for (int c = 0; c < kSize; ++c) std::copy_n(&row[c * s], s, entry(c));
    }
  }

  // A_i of all stages.
  bool linearize(const Step& step) {
    for (int i = 0; i < count_; ++i) {
      const RateStatus status = phase_jacobian(
          step.system(), step.stage_time(i), step.stage(i), step.algebraic(i), jacobian_[i]);
      if (status != RateStatus::kOk) {
        failure_ = status;
        return false;
      }
      const T weight = step.last_step() * step.tableau().omega[i];
      for (int k = 0; k < kEntries; ++k) jacobian_[i].data()[k] *= weight;
    }
    return true;
  }

  // All stages side by side. False where that is not possible or does not settle.
  bool in_packs(const Step& step, bool repeated, const Compensated<Square>& m, Square& sum) {
    if constexpr (!Step::kRows) {
      return false;
    } else {
      constexpr int s = Step::kLanes;
      const T h = step.last_step();
      alignas(64) std::array<T, s> time;
      alignas(64) std::array<T, s> weights;
      for (int l = 0; l < s; ++l) {
        time[l] = step.stage_time(l);
        weights[l] = h * step.tableau().omega[l];
      }
      if (!packed_jacobian<s>(
              step.system(), time.data(), step.stages().data(), weights.data(), rows_.data())) {
        return false;
      }
      const auto& tableau = step.tableau();
      if (repeated) {
        packed_extrapolation<kSize * kSize, s>(tableau.extrapolation.data(), tangents_.data());
      } else {
        tangents_.fill(T(0));
      }
      const auto sweep = [&] {
        return packed_tangent_sweep<kSize, s>(tableau.mu.data(),
                                              rows_.data(),
                                              m.value.data(),
                                              m.compensation.data(),
                                              weights_.data(),
                                              tangents_.data());
      };
      const auto add_up = [&](Square& to) {
        packed_sums<kEntries, s>(tangents_.data(), to.data());
      };
      if (!repeated) {
        sweep();
        add_up(moved_);
      }
      weigh(m);
      if (!settles(sweep)) return false;
      add_up(sum);
      return all_finite(sum);
    }
  }

  // Sets the weights of changes: one over the round-off of a column. Columns are derivatives with
  // respect to numbers that may have different units. In a column only those entries tell its size
  // that move: the others are without error, and in other units they may be as large as you like.
  void weigh(const Compensated<Square>& m) {
    constexpr T kResolution = std::numeric_limits<T>::epsilon();
    using std::abs;
    for (int c = 0; c < kSize; ++c) {
      T moving(0);
      T largest(0);
      for (int r = 0; r < kSize; ++r) {
        const T value = abs(m.value(r, c));
        const T moved = abs(moved_(r, c));
        moving = std::max(moving, std::max(std::min(value, moved / kResolution), moved));
        largest = std::max(largest, value);
      }
      const T size = moving > T(0) ? moving : largest;
      weights_[c] = size > T(0) ? T(1) / (kResolution * size) : T(0);
    }
  }

  // Repeats sweep(), which returns the largest weighted change, until that or what the next one
  // would be is round-off. It may fail to fall once, as it does where entries of a column take
  // turns, but not twice in a row.
  template <class Sweep>
  bool settles(const Sweep& sweep) {
    constexpr T kRoundOff = T(0.25);
    constexpr T kStalled = T(8);
    T smallest = std::numeric_limits<T>::max();
    bool grace = true;
    for (int iteration = 0; iteration < kMaxIterations; ++iteration) {
      const T change = sweep();
      if (change <= kRoundOff) return true;
      if (change <= kStalled && change * change <= kRoundOff * smallest) return true;
      const bool falling = change < smallest;
      if (!falling && !grace) break;
      grace = falling;
      if (falling) smallest = change;
    }
    return smallest <= kStalled;
  }

  // sum += mu_ij dL_j.
  static void add_stage(const Step& step, int i, int j, const Square& increment, Square& sum) {
    const T mu = step.tableau().mu(i, j);
    if (!step.tableau().partitioned) return add(mu, increment, sum);
    const T momentum_mu = step.tableau().mu_p(i, j);
    for (int c = 0; c < kSize; ++c) {
      for (int r = 0; r < kDof; ++r) sum(r, c) += mu * increment(r, c);
      for (int r = kDof; r < kSize; ++r) sum(r, c) += momentum_mu * increment(r, c);
    }
  }

  // First guess, as for the stages: extrapolated from the last step, or A_i dz.
  void predict(const Step& step, bool repeated, const Compensated<Square>& m) {
    if (!repeated) {
      set_zero(moved_);
      for (int i = 0; i < count_; ++i) {
        multiply(jacobian_[i], m.value, increment_[i]);
        add(T(1), increment_[i], moved_);
      }
      return;
    }
    std::swap(increment_, last_);
    for (int i = 0; i < count_; ++i) {
      set_zero(increment_[i]);
      for (int j = 0; j < count_; ++j) {
        add(step.tableau().extrapolation(i, j), last_[j], increment_[i]);
      }
    }
  }

  bool iterate(const Step& step, bool repeated, const Compensated<Square>& m) {
    predict(step, repeated, m);
    weigh(m);
    return settles([&] {
      using std::abs;
      T change(0);
      std::swap(increment_, last_);
      for (int i = 0; i < count_; ++i) {
        Square argument = m.compensation;
        for (int j = 0; j < count_; ++j) add_stage(step, i, j, last_[j], argument);
        add(T(1), m.value, argument);
        multiply(jacobian_[i], argument, increment_[i]);
        for (int c = 0; c < kSize; ++c) {
          for (int r = 0; r < kSize; ++r) {
            change = maximum<T>(change, weights_[c] * abs(increment_[i](r, c) - last_[i](r, c)));
          }
        }
      }
      return change;
    });
  }

  // (I - A_i mu_ij) dL = A_i dz, all stages at once.
  bool solve(const Step& step, const Compensated<Square>& m) {
    set_units(0, count_);
    for (int i = 0; i < count_; ++i) {
      multiply(jacobian_[i], m.value, increment_[i]);
      set_rhs(i, increment_[i]);
      for (int j = 0; j < count_; ++j) set_block(step, i, j, i, j, count_);
    }
    return lu(0, count_);
  }

  // The same stage by stage, where a stage depends on those before it alone.
  bool solve_in_turn(const Step& step, const Compensated<Square>& m) {
    for (int i = 0; i < count_; ++i) {
      Square argument = m.compensation;
      for (int j = 0; j < i; ++j) add_stage(step, i, j, increment_[j], argument);
      add(T(1), m.value, argument);
      multiply(jacobian_[i], argument, increment_[i]);
      if (step.tableau().coupling == Coupling::kExplicit) continue;
      set_units(i, i + 1);
      set_rhs(0, increment_[i]);
      set_block(step, i, i, 0, 0, 1);
      if (!lu(i, 1)) return false;
    }
    return true;
  }

  // Those of the matrices of some stages together.
  void set_units(int first, int end) {
    using std::abs;
    Square sizes;
    set_zero(sizes);
    for (int i = first; i < end; ++i) {
      for (int k = 0; k < kEntries; ++k) sizes.data()[k] += abs(jacobian_[i].data()[k]);
    }
    units_ = balanced_units(sizes);
  }

  // Block `block` of the right-hand sides, in units_ as the matrix and the solution: which pivots
  // are taken, and so what is lost by rounding, does not depend on the units of the scene.
  void set_rhs(int block, const Square& value) {
    T* to = rhs_.data() + block * kSize * kSize;
    for (int r = 0; r < kSize; ++r) {
      for (int c = 0; c < kSize; ++c) *to++ = value(r, c) / units_[r];
    }
  }

  // The block of dL_j in the equation of dL_i, put at (row, column) of `blocks` blocks.
  void set_block(const Step& step, int i, int j, int row, int column, int blocks) {
    for (int r = 0; r < kSize; ++r) {
      for (int c = 0; c < kSize; ++c) {
        const T identity(i == j && r == c ? 1 : 0);
        const T mu = c < kDof ? step.tableau().mu(i, j) : step.tableau().momentum_mu(i, j);
        matrix_[(row * kSize + r) * kSize * blocks + column * kSize + c] =
            identity - mu * jacobian_[i](r, c) * units_[c] / units_[r];
      }
    }
  }

  // Solves for the increments first, ..., first + blocks - 1.
  bool lu(int first, int blocks) {
    if (!lu_solve(kSize * blocks, matrix_.data(), kSize, rhs_.data())) return false;
    bool finite = true;
    const T* from = rhs_.data();
    for (int i = first; i < first + blocks; ++i) {
      for (int r = 0; r < kSize; ++r) {
        for (int c = 0; c < kSize; ++c) increment_[i](r, c) = *from++ * units_[r];
      }
      finite = finite && all_finite(increment_[i]);
    }
    return finite;
  }

  int count_ = 0;
  RateStatus failure_ = RateStatus::kNotFinite;
  // Lengths of the step whose increments are there, side by side or one by one; 0: none.
  T packed_step_ = T(0);
  T plain_step_ = T(0);
  Square moved_;                  // what the last step added to M
  std::array<T, kSize> weights_;  // of the changes of columns
  // Scratch of the linear solves.
  Vector<T, kSize> units_;
  std::array<T, kSize * Step::kMaxCoupled * kSize * Step::kMaxCoupled> matrix_;
  std::array<T, kSize * Step::kMaxCoupled * kSize> rhs_;

  // Of the stages side by side: entry k of all in row k.
  static constexpr int kRowSize = Step::kRows ? kSize * kSize * Step::kLanes : 0;
  alignas(64) std::array<T, kRowSize> rows_;
  alignas(64) std::array<T, kRowSize> tangents_;

  std::array<Square, Step::kMaxStages> jacobian_;
  std::array<Square, Step::kMaxStages> increment_;
  std::array<Square, Step::kMaxStages> last_;
};

}  // namespace carnot
