#include "carnot/shooting/shoot/bound_arcs.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "carnot/shooting/linear/dense.h"
#include "carnot/shooting/linear/round_off.h"
#include "carnot/shooting/problem/ends.h"
#include "carnot/shooting/shoot/on_wall.h"

namespace carnot::internal {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

// Unknowns: those of the start, the other segments' starts, the times between pieces, then eta at
// the end of each arc.
class Equations {
 public:
  Equations(const BoundaryValueProblem& problem,
            const Walls& walls,
            const Held& held,
            long steps,
            const BoundExtremal& extremal)
      : problem_(problem),
        walls_(walls),
        held_(held),
        n_(problem.dynamics.dof),
        terms_(problem.dynamics) {
    double start = 0;
    double q_size = distance_between_ends(problem);
    double p_size = 0;
    for (const Piece& piece : extremal.pieces) {
      steps_.push_back(steps_of(problem, piece, start, steps));
      start = piece.end;
      segments_ += piece.segments;
      if (piece.leaves() >= 0) ++arcs_;
      for (std::size_t i = 0; i < piece.z.size(); ++i) {
        const bool momentum = static_cast<int>(i) % (2 * n_) >= n_;
        const double origin = extremal.pieces[0].z[i % (2 * n_)];
        double& size = momentum ? p_size : q_size;
        size = std::max(size, std::abs(piece.z[i] - (momentum ? 0 : origin)));
      }
    }
    pieces_ = static_cast<int>(extremal.pieces.size());
    q_size_ = q_size > 0 ? q_size : 1;
    p_size_ = p_size > 0 ? p_size : 1;
  }

  [[nodiscard]] int size() const { return times_at() + pieces_ - 1 + arcs_; }

  // False when a flow fails.
  bool evaluate(const BoundExtremal& extremal, VectorXd& residual, MatrixXd& jacobian) {
    residual.setZero(size());
    jacobian.setZero(size(), size());
    int row = 0;
    int segment = 0;
    int arc = 0;
    double start = 0;
    for (int k = 0; k < pieces_; ++k) {
      const Piece& piece = extremal.pieces[k];
      if (k > 0 && !add_junction(extremal, k, segment, row, residual, jacobian)) return false;
      for (int i = 0; i < piece.segments; ++i, ++segment) {
        if (!add_segment(extremal, k, i, start, segment, arc, row, residual, jacobian))
          return false;
      }
      if (piece.leaves() >= 0) ++arc;
      start = piece.end;
    }
    return residual.allFinite() && jacobian.allFinite();
  }

  // extremal - share * step.
  void move(const BoundExtremal& from,
            const VectorXd& step,
            double share,
            BoundExtremal& to) const {
    to = from;
    int segment = 0;
    int arc = 0;
    for (int k = 0; k < pieces_; ++k) {
      Piece& piece = to.pieces[k];
      for (int i = 0; i < piece.segments; ++i, ++segment) {
        for (int j = 0; j < 2 * n_; ++j) {
          const int c = column(segment, j);
          if (c >= 0) piece.z[i * 2 * n_ + j] -= share * step[c];
        }
      }
      if (k + 1 < pieces_) piece.end -= share * step[times_at() + k];
      if (piece.leaves() >= 0) piece.release -= share * step[times_at() + pieces_ - 1 + arc++];
    }
  }

 private:
  [[nodiscard]] int times_at() const { return n_ + (segments_ - 1) * 2 * n_; }
  // The unknown that entry j of the start of a segment is; -1: none.
  [[nodiscard]] int column(int segment, int j) const {
    if (segment > 0) return n_ + (segment - 1) * 2 * n_ + j;
    const int coordinate = j % n_;
    return start_index(problem_, coordinate) == j ? coordinate : -1;
  }
  [[nodiscard]] double unit(int j) const { return j % (2 * n_) < n_ ? q_size_ : p_size_; }

  bool add_segment(const BoundExtremal& extremal,
                   int k,
                   int i,
                   double start,
                   int segment,
                   int arc,
                   int& row,
                   VectorXd& residual,
                   MatrixXd& jacobian) {
    const Piece& piece = extremal.pieces[k];
    const Dynamics& dynamics = held_.of(piece);
    const double duration = (piece.end - start) / piece.segments;
    std::vector<double> end(piece.z.begin() + i * 2 * n_, piece.z.begin() + (i + 1) * 2 * n_);
    Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor> m(2 * n_, 2 * n_);
    const StepPlan plan = StepPlan::equal(0, duration, steps_[k]);
    if (!dynamics.tangent_flow(plan, end, span_of(m)).completed()) return false;
    HamiltonianTerms at_end(dynamics);
    at_end.set(0, 0, end.data(), end.data() + n_);
    if (!at_end.evaluate(1, HamiltonianTerms::Order::kFirst)) return false;
    const bool last = segment + 1 == segments_;
    const bool leaves = piece.leaves() >= 0 && i + 1 == piece.segments;
    const double* next = nullptr;
    if (!last) {
      next = i + 1 < piece.segments ? &piece.z[(i + 1) * 2 * n_] : extremal.pieces[k + 1].z.data();
    }
    const WallAt wall =
        leaves ? wall_at(walls_, n_, piece.leaves(), last ? end.data() : next) : WallAt{};
    for (int r = 0; r < (last ? n_ : 2 * n_); ++r, ++row) {
      const int at = last ? target_index(problem_, r) : r;
      const double scale = unit(at);
      residual[row] = (end[at] - (last ? target_value(problem_, r) : next[r])) / scale;
      for (int j = 0; j < 2 * n_; ++j) {
        const int c = column(segment, j);
        if (c >= 0) jacobian(row, c) += m(at, j) / scale;
      }
      if (!last) jacobian(row, column(segment + 1, r)) -= 1 / scale;
      const double rate =
          (at < n_ ? at_end.by_p(0, at) : -at_end.by_q(0, at - n_)) / (scale * piece.segments);
      if (k + 1 < pieces_) jacobian(row, times_at() + k) += rate;
      if (k > 0) jacobian(row, times_at() + k - 1) -= rate;
      if (!leaves || at < n_) continue;
      const int a = at - n_;
      residual[row] -= piece.release * wall.gradient[a] / scale;
      jacobian(row, times_at() + pieces_ - 1 + arc) -= wall.gradient[a] / scale;
      if (!last) {
        for (int j = 0; j < n_; ++j) {
          jacobian(row, column(segment + 1, j)) -= piece.release * wall.hessian(a, j) / scale;
        }
        continue;
      }
      // At the end the gradient moves with the end of the flow.
      for (int b = 0; b < n_; ++b) {
        const double bend = piece.release * wall.hessian(a, b) / scale;
        for (int j = 0; j < 2 * n_; ++j) {
          const int c = column(segment, j);
          if (c >= 0) jacobian(row, c) -= bend * m(b, j);
        }
        if (k > 0) jacobian(row, times_at() + k - 1) += bend * at_end.by_p(0, b) / piece.segments;
      }
    }
    return true;
  }

  // At the start of piece k, which is that of `segment`.
  bool add_junction(const BoundExtremal& extremal,
                    int k,
                    int segment,
                    int& row,
                    VectorXd& residual,
                    MatrixXd& jacobian) {
    const Piece& piece = extremal.pieces[k];
    const Piece& before = extremal.pieces[k - 1];
    const bool meets = piece.wall >= 0 || before.touches >= 0;
    const int number = piece.wall >= 0 ? piece.wall : before.leaves();
    const WallAt wall = wall_at(walls_, n_, number, piece.z.data());
    const Approach to = approach(terms_, wall, piece.z.data());
    const double size = wall.gradient.norm() * q_size_;
    const double speed = size / problem_.time;
    for (int j = 0; j < n_; ++j) {
      jacobian(row, column(segment, j)) = to.by_q[j] / speed;
      jacobian(row, column(segment, n_ + j)) = to.by_p[j] / speed;
    }
    residual[row++] = to.rate / speed;
    if (!meets) return true;
    for (int j = 0; j < n_; ++j) jacobian(row, column(segment, j)) = wall.gradient[j] / size;
    residual[row++] = wall.s / size;
    return true;
  }

  const BoundaryValueProblem& problem_;
  const Walls& walls_;
  const Held& held_;
  int n_;
  HamiltonianTerms terms_;
  std::vector<long> steps_;
  int pieces_ = 0;
  int segments_ = 0;
  int arcs_ = 0;
  double q_size_ = 1;
  double p_size_ = 1;
};

bool in_order(const BoundExtremal& extremal, const BoundExtremal& before) {
  constexpr double kShrink = 0.2;  // a piece may lose so much at once
  double start = 0;
  double start_before = 0;
  for (std::size_t k = 0; k < extremal.pieces.size(); ++k) {
    const double length = before.pieces[k].end - start_before;
    if (!(extremal.pieces[k].end - start > kShrink * length)) return false;
    start = extremal.pieces[k].end;
    start_before = before.pieces[k].end;
  }
  return true;
}

}  // namespace

long steps_of(const BoundaryValueProblem& problem, const Piece& piece, double start, long steps) {
  const double share = (piece.end - start) / problem.time;
  const double each = std::ceil(share * static_cast<double>(steps) / piece.segments);
  return std::max(2L, static_cast<long>(each));
}

bool join_pieces(const BoundaryValueProblem& problem,
                 const Walls& walls,
                 long steps,
                 BoundExtremal& extremal) {
  constexpr int kMostIterations = 20;
  constexpr double kShortest = 1.0 / 32;
  constexpr double kSolved = 1e-12;
  // Pieces begin at times that are not known yet.
  if (!problem.dynamics.autonomous) return false;
  const Held held(problem, walls, extremal);
  if (!held.exists()) return false;
  Equations equations(problem, walls, held, steps, extremal);
  VectorXd residual;
  MatrixXd jacobian;
  if (!equations.evaluate(extremal, residual, jacobian)) return false;
  extremal.residual = residual.norm();
  BoundExtremal trial;
  for (int iteration = 0; iteration < kMostIterations; ++iteration) {
    const VectorXd step = lu_solve(jacobian, residual);
    if (!step.allFinite()) return false;
    bool better = false;
    for (double share = 1; share >= kShortest && !better; share *= 0.5) {
      equations.move(extremal, step, share, trial);
      if (!in_order(trial, extremal) || !equations.evaluate(trial, residual, jacobian)) continue;
      trial.residual = residual.norm();
      better = trial.residual < (1 - 0.1 * share) * extremal.residual;
    }
    if (!better) break;
    extremal = trial;
    if (extremal.residual <= kRestRoundOff) break;
  }
  return extremal.residual <= kSolved;
}

}  // namespace carnot::internal
