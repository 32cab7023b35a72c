// A Runge-Kutta method of one's own, by its coefficients.
//
//   const OwnMethod method = own_method({.name = "crouzeix", .a = {...}, .b = {...}});
//   const Dynamics dynamics = make_dynamics(Vehicle{}, method);
#pragma once

#include <string>
#include <vector>

#include "carnot/tableau/methods.h"
#include "carnot/tableau/tableau.h"

namespace carnot {

// a_ij and b_j, with s stages. The nodes are c_i = sum_j a_ij.
struct ButcherTableau {
  std::string name = "own";
  std::vector<std::vector<double>> a = {};  // s rows of s
  std::vector<double> b = {};
  // Of the momenta, where these have coefficients of their own, as in a Lobatto pair: `a` is then
  // that of q, and b and c are common. Else empty.
  std::vector<std::vector<double>> a_p = {};
};

// What make_dynamics() takes: a method with its coefficients.
struct OwnMethod {
  Method method;  // its order and its laws are measured, not declared
  Tableau<double> tableau;
};

// Coefficients that agree with a law to so many units of round-off are taken to obey it. Those that
// are written with all digits of a double agree to a few; a digit less is ten times as much.
inline constexpr int kOwnRoundings = 64;

// Measures the order and the laws of the method, and finds which stages depend on each other:
// explicit and diagonally implicit methods are recognized by their zeros. Where the condition
// b_i a^_ij + b_j a_ji = b_i b_j of symplectic methods holds to round-off, the coefficients are
// moved in the last digits so that it holds exactly, as in the methods of the library.
//
// Throws std::invalid_argument where sizes do not agree, a number is not finite, b does not sum to
// one, or there are more than kMostStages stages, of which kMostCoupledStages may depend on each
// other. Costs some milliseconds.
OwnMethod own_method(const ButcherTableau& butcher);

}  // namespace carnot
