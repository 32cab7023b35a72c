// The structure matrix of Darboux coordinates (q, p, y):
//
//           ( 0 -I  0 )
//   J_0  =  ( I  0  0 ),   J_0 z' = grad H:   q' = H_p,  p' = -H_q,  0 = H_y.
//           ( 0  0  0 )
//
// Without y it is the J of phase space: a map is symplectic where its derivative M has M'JM = J.
#pragma once

namespace carnot {

// J_0 of this size and rank 2 `dof`, as a matrix of Eigen.
template <class Square>
Square canonical_structure(int size, int dof) {
  using T = typename Square::Scalar;
  Square j = Square::Zero(size, size);
  for (int i = 0; i < dof; ++i) {
    j(i, dof + i) = T(-1);
    j(dof + i, i) = T(1);
  }
  return j;
}

}  // namespace carnot
