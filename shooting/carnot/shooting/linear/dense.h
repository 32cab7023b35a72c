// Decompositions of dense matrices whose sizes are known at run time only.
//
// Eigen's decompositions are templates, and the compiler spends seconds on each file that uses one.
// They are instantiated once, in dense.cc. Everything takes plain matrices and returns results.
// Nothing here fails: where a matrix is singular the results hold infinities or NaN.
#pragma once

#include <Eigen/Core>
#include <optional>

namespace carnot::internal {

// Matrices of at most kMostSmall rows and columns, which need no allocation.
inline constexpr int kMostSmall = 16;
using SmallVector = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, kMostSmall, 1>;
using SmallMatrix =
    Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, kMostSmall, kMostSmall>;

// A B and A'B, so that Eigen's product of large matrices is instantiated once, too. A transpose
// that is made first would add the same terms in another order.
Eigen::MatrixXd product(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b);
Eigen::MatrixXd transposed_product(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b);

// A^-1 B and A^-1, by elimination with partial pivoting.
Eigen::MatrixXd lu_solve(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b);
Eigen::MatrixXd lu_inverse(const Eigen::MatrixXd& a);
// The same without an allocation.
SmallVector small_lu_solve(const SmallMatrix& a, const SmallVector& b);
SmallMatrix small_lu_inverse(const SmallMatrix& a);
// A^-1 by LU factors with full pivoting. Nothing where a pivot is below `threshold` times the
// largest one.
std::optional<Eigen::MatrixXd> inverse_if_regular(const Eigen::MatrixXd& a, double threshold);

// det A by its sign and by the logarithm of its size.
struct Determinant {
  int sign = 0;
  double log_size = 0;
};
Determinant determinant_of(const Eigen::MatrixXd& a);

// An orthonormal basis of the space that the columns span, as many columns, by Householder's QR.
Eigen::MatrixXd orthonormal(const Eigen::MatrixXd& columns);
// The same basis Q, and the square R of columns = Q R, an upper triangle.
struct QrFactors {
  Eigen::MatrixXd q;
  Eigen::MatrixXd r;
};
QrFactors qr_factors(const Eigen::MatrixXd& columns);
// The direction, of length 1, that n rows of length n + 1 map to zero. Nothing where the least
// pivot of QR factors with column pivoting is not above `full_rank` times the largest one.
std::optional<Eigen::VectorXd> kernel_line(const Eigen::MatrixXd& rows, double full_rank);

// A = V diag(values) V' of a symmetric matrix, values ascending.
struct SymmetricEigen {
  Eigen::VectorXd values;
  Eigen::MatrixXd vectors;
};
SymmetricEigen symmetric_eigen(const Eigen::MatrixXd& a);

// About the largest size of an eigenvalue of an n x n matrix, from the means of their 16th and 32nd
// powers. These are traces, so another unit of a coordinate, D A D^-1, changes nothing. Norms of
// powers do not have that: |A^16|^(1/16) becomes 5.6 times as much where units are 1e12 apart. It
// is exact where all eigenvalues are of one size and in phase, and about n^(1/16) times less than
// the largest one where that is alone.
double spectral_radius(const Eigen::MatrixXd& a);

// How many eigenvalues of a symmetric matrix are below `bound`: as many as A - bound I has negative
// pivots (Sylvester's law of inertia). Where a pivot says too little, they are computed. First
// conjugate times take nine tenths of the time by it.
int count_below(const SmallMatrix& a, double bound);

// Singular values, descending, and the right singular vectors as columns in the same order, as many
// as A has columns: where it has fewer rows, the last values are zeros.
struct RightSingular {
  Eigen::VectorXd values;
  Eigen::MatrixXd vectors;
};
RightSingular right_singular(const Eigen::MatrixXd& a);
// As many as the lesser of rows and columns.
Eigen::VectorXd singular_values(const Eigen::MatrixXd& a);

// The x of least norm that minimises |A x - b|, where singular values below `threshold` times the
// largest one count as zero.
Eigen::VectorXd least_squares(const Eigen::MatrixXd& a, const Eigen::VectorXd& b, double threshold);

}  // namespace carnot::internal
