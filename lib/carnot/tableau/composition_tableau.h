// Symmetric compositions of the midpoint rule, as diagonally implicit Runge-Kutta methods.
//
// s midpoint steps of lengths gamma_1 h, ..., gamma_s h are one method with b_i = gamma_i,
// a_ij = b_j for j < i and a_ii = b_i / 2: mu_ij is 1, 1/2 or 0, so it is symplectic exactly, and
// symmetric as gamma_i = gamma_{s+1-i}. Each stage is one implicit equation, solved alone.
//
//   order  stages  gamma
//   2       1      1
//   4       5      Suzuki, Phys. Lett. A 146 (1990): gamma_1 = gamma_2 = 1 / (4 - 4^{1/3})
//   6       9      Kahan & Li, Math. Comp. 66 (1997), their s9odr6a
//   8      17      Kahan & Li, s17odr8a
//
// Those of Kahan & Li agree with the 26 digits that public codes quote from Hairer, Lubich &
// Wanner, Geometric Numerical Integration, V.3.2, and were refined in 90 digits by Newton's method
// on the conditions of all rooted trees up to the order (of least correction: both belong to
// families with one parameter).
//
// Others have fewer stages and larger errors. Let e be the Euclidean norm of the coefficients of
// h^{p+1} over the trees, (Phi - 1/gamma(t)) / sigma(t). At equal work the error is e s^p:
//
//   order 4:  Suzuki 1.55,   the triple jump of 3 stages 8.2
//   order 6:  this one 192,  Yoshida's A of 7 stages 523
//   order 8:  this one 5.9e4,  the one of 15 stages (Suzuki & Umeno, McLachlan) 1.9e5
//
// The ends gamma_1 + ... + gamma_i of the steps lie in [0, 1]; they are rounded to multiples of
// epsilon, and everything else follows from them exactly: b as their differences, c as their means,
// the symmetry, and sum_i b_i = 1 to the last bit (as long as no partial sum leaves [-2, 2]). So
// b_i is off by up to one epsilon, absolutely; the conditions of all trees up to the order still
// hold to 1e-16 in double.
#pragma once

#include <array>
#include <cassert>
#include <string_view>

#include "carnot/numerics/coefficients.h"
#include "carnot/tableau/tableau.h"

namespace carnot {

// gamma_1, ..., up to the one before the middle.
inline constexpr std::array<std::string_view, 2> kComposition4 = {
    "0.414490771794375737142354062860761496", "0.414490771794375737142354062860761496"};
inline constexpr std::array<std::string_view, 4> kComposition6 = {
    "0.392161444007314139279250557422671404",
    "0.332599136789359438599748637500049647",
    "-0.706246172557639359809964819549256459",
    "0.082213596293550800231490448102056331"};
inline constexpr std::array<std::string_view, 8> kComposition8 = {
    "0.130202483088890080878817632096700522",
    "0.561162981775108384561964407700150567",
    "-0.389474962644847286408078598235248389",
    "0.158841906555155600896210745707152481",
    "-0.395903894133237577336231539347938937",
    "0.184539640978315707091832541533375463",
    "0.258374387686322047293979109994939472",
    "0.295011723609310298870966240218228113"};

// The composition of 2k + 1 steps of which the first k are given.
template <class T, std::size_t k>
Tableau<T> make_composition_tableau(int order, const std::array<std::string_view, k>& first) {
  using Wide = Wider<T>;
  constexpr int s = 2 * static_cast<int>(k) + 1;
  std::array<T, s + 1> end;  // of the steps, from the start of the first
  end[0] = T(0);
  end[s] = T(1);
  Wide sum(1);
  for (int i = 1; i <= static_cast<int>(k); ++i) {
    sum += decimal<Wide>(first[i - 1]);
    end[i] = T(sum) - T(1);  // the numbers of T in [1, 2] are multiples of epsilon
    end[s - i] = T(1) - end[i];
  }
  Tableau<T> tableau;
  tableau.order = order;
  tableau.coupling = Coupling::kDiagonal;
  tableau.b.resize(s);
  tableau.c.resize(s);
  tableau.mu.resize(s, s);
  for (int i = 0; i < s; ++i) {
    tableau.b[i] = end[i + 1] - end[i];
    tableau.c[i] = (end[i] + end[i + 1]) / T(2);
    for (int j = 0; j < s; ++j) tableau.mu(i, j) = j < i ? T(1) : T(0);
    tableau.mu(i, i) = T(1) / T(2);
  }
  set_weights(tableau);
  return tableau;
}

// The composition of order 2 (the midpoint rule itself), 4, 6 or 8.
template <class T>
Tableau<T> composition_tableau(int order) {
  assert(order == 2 || order == 4 || order == 6 || order == 8);
  if (order == 8) return make_composition_tableau<T>(order, kComposition8);
  if (order == 6) return make_composition_tableau<T>(order, kComposition6);
  if (order == 4) return make_composition_tableau<T>(order, kComposition4);
  return make_composition_tableau<T>(order, std::array<std::string_view, 0>{});
}

}  // namespace carnot
