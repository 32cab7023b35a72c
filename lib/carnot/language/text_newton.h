// Newton's method for systems from text: stationary_newton.h on tapes.
#pragma once

#include <array>
#include <cmath>
#include <limits>

#include "carnot/language/tape.h"
#include "carnot/numerics/scaled_lu.h"
#include "carnot/system/stationary_newton.h"

namespace carnot::language {

// Of one phase point: the most that is solved for, (p, y) of a generalized Hamiltonian system.
inline constexpr int kMostUnknowns = kMostCoordinates;

using TextUnknowns = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, kMostUnknowns, 1>;
using TextSquare =
    Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, kMostUnknowns, kMostUnknowns>;

// F_x = 0 for the first `count` of the `stride` unknowns that the tapes differentiate by: one gives
// F_x alone, the other F_x and F_xx row by row, from the six groups of a TextSystem.
class TextEquations {
 public:
  using Number = double;
  using Unknowns = TextUnknowns;
  using Square = TextSquare;
  using Factor = ScaledLu<double, Eigen::Dynamic, kMostUnknowns>;
  using Groups = std::array<const double*, 6>;

  // y: x are the algebraic variables, `count` of `stride`, and group 2 is p. Else x = (p, y).
  TextEquations(const Tape& first,
                const Tape& second,
                const Groups& groups,
                int dof,
                int stride,
                int count,
                bool y)
      : first_(&first),
        second_(&second),
        groups_(groups),
        dof_(dof),
        stride_(stride),
        count_(count),
        only_y_(y) {}

  [[nodiscard]] int size() const { return count_; }

  // What a tape makes of the groups, or zero.
  void begin_at(const Tape& guess) { guess_ = &guess; }
  [[nodiscard]] Unknowns cold_start() const {
    Unknowns x = Unknowns::Zero(count_);
    if (guess_ == nullptr) return x;
    std::array<double, 2 * kMostUnknowns> all;
    guess_->run(groups_, std::array<double*, 1>{all.data()});
    for (int i = 0; i < count_; ++i) x[i] = all[i];
    return x;
  }

  [[nodiscard]] Unknowns residual(const Unknowns& x) const {
    std::array<double, kMostUnknowns> slopes;
    run(*first_, x, slopes.data(), nullptr);
    return Eigen::Map<const Eigen::VectorXd>(slopes.data(), count_);
  }

  void linearize(const Unknowns& x, Unknowns& residual, Square& hessian) const {
    std::array<double, kMostUnknowns> slopes;
    std::array<double, kMostUnknowns * kMostUnknowns> second;
    run(*second_, x, slopes.data(), second.data());
    for (int i = 0; i < count_; ++i) {
      residual[i] = slopes[i];
      for (int j = 0; j < count_; ++j) hessian(i, j) = second[i * stride_ + j];
    }
  }

  // As StationaryEquations::noise().
  [[nodiscard]] Unknowns noise(const Unknowns& x) const {
    const Unknowns here = residual(x);
    Unknowns sum = Unknowns::Zero(count_);
    for (const int few : {-7, -3, 4, 9}) {
      const double bits = 1 + few * std::numeric_limits<double>::epsilon();
      TextEquations near = *this;
      for (int group = 1; group < (only_y_ ? 3 : 2); ++group) {
        std::array<double, kMostCoordinates> moved;
        for (int i = 0; i < dof_; ++i) moved[i] = groups_[group][i];
        near.groups_[group] = moved.data();
        for (int i = 0; i < dof_; ++i) {
          moved[i] *= bits;
          sum += (near.residual(x) - here).cwiseAbs();
          moved[i] = groups_[group][i];
        }
        near.groups_[group] = groups_[group];
      }
      Unknowns moved = x;
      for (int i = 0; i < count_; ++i) {
        moved[i] = bits * x[i];
        sum += (residual(moved) - here).cwiseAbs();
        moved[i] = x[i];
      }
    }
    return sum;
  }

 private:
  // `second` is null for a tape without it.
  void run(const Tape& tape, const Unknowns& x, double* slopes, double* second) const {
    // Unknowns that are held are those of the group.
    std::array<double, 2 * kMostUnknowns> all;
    for (int i = count_; i < stride_ && only_y_; ++i) all[i] = groups_[3][i];
    for (int i = 0; i < count_; ++i) all[i] = x[i];
    Groups in = groups_;
    if (only_y_) {
      in[3] = all.data();
    } else {
      in[2] = all.data();
      in[3] = all.data() + dof_;
    }
    const std::array<double*, 2> out{slopes, second};
    tape.run(in, out);
  }

  const Tape* first_;
  const Tape* second_;
  Groups groups_;
  int dof_;
  int stride_;
  int count_;
  bool only_y_;
  const Tape* guess_ = nullptr;
};

}  // namespace carnot::language
