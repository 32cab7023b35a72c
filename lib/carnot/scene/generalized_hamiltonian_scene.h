// What the author of a generalized Hamiltonian scene writes: J z' = grad H(z).
//
// Required: the sizes kSize (N, the length of z) and kDof (n, half the rank of J), the template
// hamiltonian(z) and structure_matrix() -> J, N x N, constant, antisymmetric, of rank 2n and in any
// basis. Sign: J = (0, -I; I, 0) is q' = H_p, p' = -H_q. The kernel of J, N - 2n directions, holds
// the variables that have no equation of motion: H must be stationary in them, in any way that
// leaves its second derivatives there regular.
//
// Optional: darboux_basis() -> T, N x N, where the scene wants configuration, momenta and
// multipliers of its own choice: z = T (q, p, y) with T'J T = (0 -I 0; I 0 0; 0 0 0). Without it
// they are those of darboux.h, which mean nothing unless J pairs the coordinates one by one. And
// what scene_info.h lists, of q.
#pragma once

#include <concepts>

#include "carnot/numerics/linear_algebra.h"

namespace carnot {

template <class S>
concept GeneralizedHamiltonianScene = requires(const S& scene, const Vector<double, S::kSize>& z) {
  { S::kDof } -> std::convertible_to<int>;
  { scene.hamiltonian(z) } -> std::convertible_to<double>;
  { scene.structure_matrix() } -> std::convertible_to<Matrix<double, S::kSize, S::kSize>>;
};

template <class S>
concept HasDarbouxBasis = requires(const S& scene) {
  { scene.darboux_basis() } -> std::convertible_to<Matrix<double, S::kSize, S::kSize>>;
};

}  // namespace carnot
