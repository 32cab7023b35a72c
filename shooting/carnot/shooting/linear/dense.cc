#include "carnot/shooting/linear/dense.h"

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <Eigen/QR>
#include <Eigen/SVD>
#include <cmath>
#include <complex>

namespace carnot::internal {

using Eigen::MatrixXd;
using Eigen::VectorXd;

MatrixXd product(const MatrixXd& a, const MatrixXd& b) { return a * b; }

MatrixXd transposed_product(const MatrixXd& a, const MatrixXd& b) { return a.transpose() * b; }

VectorXd lu_solve(const MatrixXd& a, const VectorXd& b) { return a.partialPivLu().solve(b); }

MatrixXd lu_inverse(const MatrixXd& a) { return a.partialPivLu().inverse(); }

SmallVector small_lu_solve(const SmallMatrix& a, const SmallVector& b) {
  return a.partialPivLu().solve(b);
}

SmallMatrix small_lu_inverse(const SmallMatrix& a) { return a.partialPivLu().inverse(); }

std::optional<SmallMatrix> small_inverse_if_regular(const SmallMatrix& a, double threshold) {
  Eigen::FullPivLU<SmallMatrix> lu(a);
  lu.setThreshold(threshold);
  if (!lu.isInvertible()) return std::nullopt;
  return SmallMatrix(lu.inverse());
}

Determinant determinant_of(const MatrixXd& a) {
  const Eigen::PartialPivLU<MatrixXd> lu(a);
  const VectorXd pivots = lu.matrixLU().diagonal();
  const bool negative =
      ((pivots.array() < 0).count() % 2 == 1) != (lu.permutationP().determinant() < 0);
  return {negative ? -1 : 1, pivots.array().abs().log().sum()};
}

double argument_of_determinant(const MatrixXd& a, const MatrixXd& b) {
  const Eigen::MatrixXcd sum =
      a.cast<std::complex<double>>() + std::complex<double>(0, 1) * b.cast<std::complex<double>>();
  return std::arg(sum.determinant());
}

MatrixXd orthonormal(const MatrixXd& columns) {
  const Eigen::HouseholderQR<MatrixXd> qr(columns);
  return qr.householderQ() * MatrixXd::Identity(columns.rows(), columns.cols());
}

QrFactors qr_factors(const MatrixXd& columns) {
  const Eigen::HouseholderQR<MatrixXd> qr(columns);
  return {qr.householderQ() * MatrixXd::Identity(columns.rows(), columns.cols()),
          qr.matrixQR().topRows(columns.cols()).triangularView<Eigen::Upper>()};
}

MatrixXd solve_upper(const MatrixXd& r, const MatrixXd& b) {
  return r.triangularView<Eigen::Upper>().solve(b);
}

std::optional<VectorXd> kernel_line(const MatrixXd& rows, double full_rank) {
  const Eigen::ColPivHouseholderQR<MatrixXd> qr(rows.transpose());
  const VectorXd pivots = qr.matrixQR().diagonal().cwiseAbs();
  if (!(pivots.minCoeff() > full_rank * pivots.maxCoeff())) return std::nullopt;
  const auto size = rows.cols();
  return VectorXd(qr.householderQ() * VectorXd::Unit(size, size - 1));
}

SymmetricEigen symmetric_eigen(const MatrixXd& a) {
  const Eigen::SelfAdjointEigenSolver<MatrixXd> solver(a);
  return {solver.eigenvalues(), solver.eigenvectors()};
}

VectorXd singular_values(const MatrixXd& a) {
  return Eigen::JacobiSVD<MatrixXd>(a).singularValues();
}

RightSingular right_singular(const MatrixXd& a) {
  const Eigen::JacobiSVD<MatrixXd> svd(a, Eigen::ComputeFullV);
  return {svd.singularValues(), svd.matrixV()};
}

VectorXd least_squares(const MatrixXd& a, const VectorXd& b, double threshold) {
  Eigen::CompleteOrthogonalDecomposition<MatrixXd> decomposition;
  decomposition.setThreshold(threshold);
  decomposition.compute(a);
  // A matrix, since for a vector Eigen adds the terms in another order where A lacks rank.
  const MatrixXd x = decomposition.solve(b);
  return x.col(0);
}

}  // namespace carnot::internal
