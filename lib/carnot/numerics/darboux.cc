#include "carnot/numerics/darboux.h"

#include <Eigen/Core>
#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>
#include <sstream>
#include <stdexcept>
#include <string>

#include "carnot/numerics/canonical_structure.h"
#include "carnot/numerics/jacobi_rotations.h"
#include "carnot/numerics/lu.h"

namespace carnot {
namespace {

using SquareMatrix = Eigen::MatrixXd;

// Orthonormal columns with q'J p = -sigma < 0.
struct Pair {
  Eigen::VectorXd q;
  Eigen::VectorXd p;
  double sigma = 0;
};

SquareMatrix square(std::span<const double> numbers, int size) {
  assert(static_cast<int>(numbers.size()) == size * size);
  return Eigen::Map<const SquareMatrix>(numbers.data(), size, size);
}

std::vector<double> numbers(const SquareMatrix& a) { return {a.data(), a.data() + a.size()}; }

double round_off(const SquareMatrix& a) {
  return kRankTolerance * static_cast<double>(a.rows()) * std::numeric_limits<double>::epsilon();
}

std::string text(double x) {
  std::ostringstream out;
  out << x;
  return out.str();
}

// (J - J')/2. Throws unless J is finite, antisymmetric to round-off, and not zero.
SquareMatrix checked(const SquareMatrix& j) {
  if (!j.allFinite()) {
    throw std::invalid_argument("the structure matrix J has entries that are not finite");
  }
  const double size = j.cwiseAbs().maxCoeff();
  const double defect = (j + j.transpose()).cwiseAbs().maxCoeff();
  if (defect > round_off(j) * size) {
    throw std::invalid_argument("the structure matrix J is not antisymmetric: |J + J'| = " +
                                text(defect));
  }
  SquareMatrix antisymmetric = 0.5 * (j - j.transpose());
  if (antisymmetric.cwiseAbs().maxCoeff() == 0) {
    throw std::invalid_argument("the structure matrix J is zero: purely algebraic, nothing moves");
  }
  return antisymmetric;
}

// True where no row of J has two entries.
bool pairs_the_coordinates(const SquareMatrix& j) {
  for (int r = 0; r < j.rows(); ++r) {
    if ((j.row(r).array() != 0).count() > 1) return false;
  }
  return true;
}

std::vector<Pair> own_pairs(const SquareMatrix& j) {
  const SquareMatrix unit = SquareMatrix::Identity(j.rows(), j.cols());
  std::vector<Pair> pairs;
  for (int q = 0; q < j.rows(); ++q) {
    for (int p = 0; p < j.cols(); ++p) {
      if (j(q, p) < 0) pairs.push_back({unit.col(q), unit.col(p), -j(q, p)});
    }
  }
  return pairs;
}

// J <- Q'J Q, tridiagonal; returns Q. With H = I - 2 v v' and w = J v, HJH = J + 2 (v w' - w v').
SquareMatrix tridiagonalise(SquareMatrix& j) {
  const auto size = static_cast<int>(j.rows());
  SquareMatrix q = SquareMatrix::Identity(size, size);
  for (int k = 0; k + 2 < size; ++k) {
    Eigen::VectorXd v = Eigen::VectorXd::Zero(size);
    for (int i = k + 1; i < size; ++i) v[i] = j(i, k);
    if (v.tail(size - k - 2).cwiseAbs().maxCoeff() == 0) continue;
    v[k + 1] += std::copysign(v.norm(), v[k + 1]);
    v /= v.norm();
    const Eigen::VectorXd w = j.lazyProduct(v);
    const Eigen::VectorXd qv = q.lazyProduct(v);
    for (int c = 0; c < size; ++c) {
      for (int r = 0; r < size; ++r) {
        j(r, c) += 2 * (v[r] * w[c] - w[r] * v[c]);
        q(r, c) -= 2 * qv[r] * v[c];
      }
    }
    for (int i = k + 2; i < size; ++i) j(i, k) = j(k, i) = 0;
  }
  return q;
}

std::vector<Pair> schur_pairs(const SquareMatrix& matrix) {
  const double scale = matrix.cwiseAbs().maxCoeff();
  SquareMatrix j = matrix / scale;
  const auto size = static_cast<int>(j.rows());
  const SquareMatrix q = tridiagonalise(j);
  const int odd = size / 2;
  SquareMatrix b = SquareMatrix::Zero(size - odd, odd);  // rows: even coordinates
  SquareMatrix y = SquareMatrix::Identity(odd, odd);
  for (int c = 0; c < odd; ++c) {
    for (int r = 0; r < size - odd; ++r) b(r, c) = j(2 * r, 2 * c + 1);
  }
  // B Y = X Sigma.
  if (!orthogonalise_columns(size - odd, odd, b.data(), y.data())) {
    throw std::invalid_argument("the Schur form of the structure matrix J was not found");
  }
  std::vector<Pair> pairs;
  for (int c = 0; c < odd; ++c) {
    const double sigma = b.col(c).norm();
    if (sigma == 0) continue;
    Pair pair{Eigen::VectorXd::Zero(size), Eigen::VectorXd::Zero(size), scale * sigma};
    for (int r = 0; r < odd; ++r) pair.q += y(r, c) * q.col(2 * r + 1);
    for (int r = 0; r < size - odd; ++r) pair.p += (b(r, c) / sigma) * q.col(2 * r);
    pairs.push_back(pair);
  }
  std::stable_sort(pairs.begin(), pairs.end(), [](const Pair& a, const Pair& other) {
    return a.sigma > other.sigma;
  });
  return pairs;
}

// Fills u from column `from` on with an orthonormal basis of the complement of those before: the
// unit vector that the columns span least of all, orthogonalised twice.
void complete(SquareMatrix& u, int from) {
  for (int c = from; c < u.cols(); ++c) {
    const auto before = u.leftCols(c);
    int least = 0;
    before.rowwise().squaredNorm().minCoeff(&least);
    Eigen::VectorXd v = Eigen::VectorXd::Unit(u.rows(), least);
    for (int pass = 0; pass < 2; ++pass) {
      for (int i = 0; i < c; ++i) v -= u.col(i).dot(v) * u.col(i);
    }
    u.col(c) = v / v.norm();
  }
}

}  // namespace

DarbouxForm darboux_form(std::span<const double> structure_matrix, int size) {
  const SquareMatrix j = checked(square(structure_matrix, size));
  std::vector<Pair> pairs = pairs_the_coordinates(j) ? own_pairs(j) : schur_pairs(j);
  double largest = 0;
  for (const Pair& pair : pairs) largest = std::max(largest, pair.sigma);
  const double zero = round_off(j) * largest;
  pairs.erase(
      std::remove_if(
          pairs.begin(), pairs.end(), [zero](const Pair& pair) { return pair.sigma <= zero; }),
      pairs.end());

  DarbouxForm form;
  form.dof = static_cast<int>(pairs.size());
  SquareMatrix basis = SquareMatrix::Zero(size, size);
  for (int i = 0; i < form.dof; ++i) {
    const Pair& pair = pairs[static_cast<std::size_t>(i)];
    basis.col(i) = pair.q;
    basis.col(form.dof + i) = pair.p;
    form.sigma.push_back(pair.sigma);
  }
  complete(basis, 2 * form.dof);
  SquareMatrix inverse = basis.transpose();  // so far orthogonal
  for (int i = 0; i < 2 * form.dof; ++i) {
    const double scale = std::sqrt(form.sigma[static_cast<std::size_t>(i % form.dof)]);
    basis.col(i) /= scale;
    inverse.row(i) *= scale;
  }
  form.basis = numbers(basis);
  form.inverse = numbers(inverse);
  return form;
}

DarbouxForm darboux_form(std::span<const double> structure_matrix, int size, int dof) {
  DarbouxForm form = darboux_form(structure_matrix, size);
  if (form.dof != dof) {
    throw std::invalid_argument("the structure matrix J has rank " + std::to_string(2 * form.dof) +
                                " where the scene declares " + std::to_string(2 * dof));
  }
  return form;
}

DarbouxForm darboux_form(std::span<const double> structure_matrix,
                         int size,
                         int dof,
                         std::span<const double> own_basis) {
  using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
  const SquareMatrix j = checked(square(structure_matrix, size));
  const SquareMatrix basis = square(own_basis, size);
  const SquareMatrix jt = j.lazyProduct(basis);
  const SquareMatrix moved =
      basis.transpose().lazyProduct(jt) - canonical_structure<SquareMatrix>(size, dof);
  const SquareMatrix sizes = basis.cwiseAbs().transpose().lazyProduct(jt.cwiseAbs());
  const double defect = moved.cwiseAbs().maxCoeff();
  if (!(defect <= round_off(j) * sizes.maxCoeff())) {
    throw std::invalid_argument(
        "the scene's own T does not bring J to Darboux form: T'J T is wrong by " + text(defect));
  }
  RowMajor factor = basis;
  RowMajor inverse = RowMajor::Identity(size, size);
  constexpr double kHalfTheDigits = 1e-8;
  if (!lu_solve(size, factor.data(), size, inverse.data()) ||
      !SquareMatrix(inverse.lazyProduct(basis)).isIdentity(kHalfTheDigits)) {
    throw std::invalid_argument("the scene's own T of Darboux coordinates has no inverse");
  }
  return {dof, numbers(basis), numbers(inverse), {}};
}

}  // namespace carnot
