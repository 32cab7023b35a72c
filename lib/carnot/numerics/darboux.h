// Darboux coordinates of a constant antisymmetric matrix, of any rank and in any basis.
//
// J z' = grad H(z) keeps its form under a linear map z = T x: T'J T x' = grad_x H(T x). There is a
// T with
//
//   x = (q, p, y),   T'J T = J_0,   that is q' = H_p, p' = -H_q, 0 = H_y,
//
// with the J_0 of canonical_structure.h.
//
// The real Schur form of an antisymmetric J has blocks (0, -sigma; sigma, 0) and zeros on the
// diagonal. The two columns of a block, over sqrt(sigma), are a pair (q_i, p_i); the columns of the
// zeros are y. Householder reflections bring J to tridiagonal form; there it couples only even
// coordinates with odd ones, by a bidiagonal matrix B, and B = X Sigma Y' gives the blocks: this
// keeps every matrix antisymmetric (Ward & Gray, ACM Trans. Math. Softw. 4 (1978), 278-285), where
// a general QR iteration sees a zero diagonal and now and then fails. The singular values are
// found by one-sided Jacobi rotations, which always converge and find small sigma well.
//
// T is not unique: the Schur form fixes neither the axes in a plane nor, for equal sigma, the
// planes. Pairs are sorted by falling sigma. A J that pairs the coordinates one by one, such as J_0
// with its rows in any order, needs no Schur form: its pairs are taken in the order of the q, so
// that T = I for J = J_0. A scene that wants other coordinates with a meaning writes its own T.
//
// Rank: a computed sigma is wrong by a few N eps sigma_max, and so is that of a J which was itself
// rounded. sigma counts as zero up to kRankTolerance N eps sigma_max.
//
// Accuracy: T'J T = J_0 to N eps sigma_max / sigma_min, where sigma_min is the least that is not
// zero; the last digits of J allow no more. In a wider scalar than double the flow is therefore
// that of a J which differs by so much from the given one.
//
// All matrices are plain numbers, column by column, so that what is compiled with the library and
// what is compiled with a scene need not have the same Eigen.
#pragma once

#include <span>
#include <vector>

namespace carnot {

// In units of N eps times the size of the matrix: what counts as zero.
inline constexpr double kRankTolerance = 8;

// z = basis (q, p, y) and back, both N x N.
struct DarbouxForm {
  int dof = 0;  // half the rank of J
  std::vector<double> basis;
  std::vector<double> inverse;
  std::vector<double> sigma;  // of the pairs (q_i, p_i); empty for a T written by hand
};

// The form of a J of this size. Throws std::invalid_argument for a J that is not finite, not
// antisymmetric or zero. Cost about 10 N^3 multiplications.
DarbouxForm darboux_form(std::span<const double> structure_matrix, int size);

// The same for a J whose rank is declared to be 2 `dof`; throws where it is not.
DarbouxForm darboux_form(std::span<const double> structure_matrix, int size, int dof);

// The same for a T written by hand; throws unless it has an inverse and T'J T = J_0 to round-off.
DarbouxForm darboux_form(std::span<const double> structure_matrix,
                         int size,
                         int dof,
                         std::span<const double> basis);

}  // namespace carnot
