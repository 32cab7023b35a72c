// The curve of solutions of F(u, s) = 0 by pseudo-arclength: F has one equation less than unknowns.
//
// Where F' has full rank its kernel is the tangent, and F'(x) with any row that is not orthogonal
// to the tangent below it is nonsingular: Newton's method works at folds, where F_u is singular. At
// a simple branch point the rank drops by one and det (F'; tangent') changes sign; where it drops
// by two, as symmetries make it, the determinant touches zero. Sources: H. B. Keller, Lectures on
// Numerical Methods in Bifurcation Problems (1987), 4-5; Allgower & Georg, Introduction to
// Numerical Continuation Methods (SIAM 2003), 2, 6 and 8.
#pragma once

#include <Eigen/Core>
#include <functional>
#include <optional>

#include "carnot/shooting/continue/line_equations.h"

namespace carnot::internal {

struct CurvePoint {
  Eigen::VectorXd x;
  Eigen::VectorXd tangent;     // of length 1
  int orientation = 0;         // sign of det (F'; tangent'),
  double log_determinant = 0;  // and the logarithm of its size
  double distance = 0;         // of the first Newton step that led here
  double contraction = 0;      // of the second one over the first
  [[nodiscard]] double s() const { return x[x.size() - 1]; }
  [[nodiscard]] double slope() const { return tangent[tangent.size() - 1]; }  // ds/d(arclength)
};

class SolutionCurve {
 public:
  // Keeps a reference to `equations`.
  explicit SolutionCurve(LineEquations& equations) : equations_(equations) {}

  // The point nearest to x on the plane through x normal to `row`, with the tangent that has a
  // positive product with `along`. Nothing where Newton's method does not converge to one.
  [[nodiscard]] std::optional<CurvePoint> correct(Eigen::VectorXd x,
                                                  const Eigen::VectorXd& row,
                                                  const Eigen::VectorXd& along);

  // A point on the curve, its tangent from a factorisation that needs no guess. Nothing where F'
  // lacks rank.
  [[nodiscard]] std::optional<CurvePoint> start(const Eigen::VectorXd& x,
                                                const Eigen::VectorXd& along);

  // Between a and b, where `test` has opposite signs: the point where it vanishes, by regula falsi
  // (Illinois) as far as Newton's method goes, then by interpolation.
  using Test = std::function<double(const CurvePoint&)>;
  [[nodiscard]] Eigen::VectorXd locate(const CurvePoint& a, const CurvePoint& b, const Test& test);

  // a and b have one orientation, and the determinant is smaller in between. Returns the point
  // where it touches zero, as it does where F' lacks two in rank, or nothing where it does not
  // touch zero. The least size is found by golden section; its square root falls and rises linearly
  // there.
  [[nodiscard]] std::optional<Eigen::VectorXd> locate_touch(const CurvePoint& a,
                                                            const CurvePoint& b);

  // At a point where F' lacks one in rank: the direction of its kernel that is normal to `tangent`.
  [[nodiscard]] std::optional<Eigen::VectorXd> other_direction(const Eigen::VectorXd& x,
                                                               const Eigen::VectorXd& tangent);

 private:
  // Tangent and determinant from the Jacobian at point.x.
  [[nodiscard]] static bool finish(const Eigen::MatrixXd& jacobian,
                                   const Eigen::VectorXd& along,
                                   CurvePoint& point);

  LineEquations& equations_;
};

}  // namespace carnot::internal
