#include "carnot/shooting/linear/lagrangian_plane.h"

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <Eigen/QR>
#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <limits>

namespace carnot {

using Eigen::MatrixXd;
using Eigen::VectorXd;

Phases phases_of(const MatrixXd& plane) {
  // Angles of combinations; one of them separates the eigenvalues.
  constexpr std::array kCombinations{0.7, 1.9, 2.6};
  constexpr double kCommon = 1e-9;
  const auto n = plane.cols();
  const auto x = plane.topRows(n);
  const auto p = plane.bottomRows(n);
  const MatrixXd real = p * p.transpose() - x * x.transpose();
  const MatrixXd cross = p * x.transpose();
  const MatrixXd imaginary = cross + cross.transpose();
  Phases phases;
  double best = std::numeric_limits<double>::infinity();
  for (const double angle : kCombinations) {
    const Eigen::SelfAdjointEigenSolver<MatrixXd> solver(std::cos(angle) * real +
                                                         std::sin(angle) * imaginary);
    const MatrixXd& v = solver.eigenvectors();
    const MatrixXd a = v.transpose() * real * v;
    const MatrixXd b = v.transpose() * imaginary * v;
    const double mixed = (a - MatrixXd(a.diagonal().asDiagonal())).cwiseAbs().maxCoeff() +
                         (b - MatrixXd(b.diagonal().asDiagonal())).cwiseAbs().maxCoeff();
    if (!(mixed < best)) continue;
    best = mixed;
    phases.angles.resize(n);
    for (Eigen::Index j = 0; j < n; ++j) phases.angles[j] = std::atan2(b(j, j), a(j, j));
    if (mixed < kCommon) break;
  }
  std::sort(phases.angles.data(), phases.angles.data() + n, [](double a, double b) {
    return std::abs(a) < std::abs(b);
  });
  const Eigen::MatrixXcd unitary =
      p.cast<std::complex<double>>() + std::complex<double>(0, 1) * x.cast<std::complex<double>>();
  phases.turn = std::arg(unitary.determinant());
  return phases;
}

MatrixXd orthonormal(const MatrixXd& columns) {
  const Eigen::HouseholderQR<MatrixXd> qr(columns);
  return qr.householderQ() * MatrixXd::Identity(columns.rows(), columns.cols());
}

Graph graph_of(const MatrixXd& plane) {
  constexpr double kZero = 1e-13;  // relative; smaller ones are round-off
  const auto n = plane.cols();
  const MatrixXd ratio = plane.topRows(n) * plane.bottomRows(n).partialPivLu().inverse();
  const Eigen::SelfAdjointEigenSolver<MatrixXd> solver(0.5 * (ratio + ratio.transpose()));
  VectorXd root = solver.eigenvalues().cwiseAbs();
  const double largest = root.maxCoeff();
  Graph graph;
  for (double& value : root) {
    if (value <= kZero * largest) {
      ++graph.kernel;
      value = largest;
    }
  }
  graph.regularity = root.minCoeff() / largest;
  root = root.cwiseSqrt();
  graph.balance = solver.eigenvectors() * root.asDiagonal() * solver.eigenvectors().transpose();
  return graph;
}

}  // namespace carnot
