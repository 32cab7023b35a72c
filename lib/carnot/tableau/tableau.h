// A Runge-Kutta method as data: what the one stepping kernel of runge_kutta.h reads.
//
// With L_j = h omega_j f(U_j), omega_j = b_j (1 where b_j = 0), a step reads
//
//   U_i = z + sum_j mu_ij L_j,      z+ = z + sum_j u_j L_j,
//
// mu_ij = a_ij / omega_j and u_j = b_j / omega_j, 1 or 0. A partitioned method has other
// coefficients for the momenta, with the same b and c: q takes mu, p takes mu_p.
// It is symplectic iff mu_ij + mu_p_ji = 1 for all i, j (Sun 1993; Sanz-Serna & Abia 1991), and
// the tables of the symplectic methods satisfy that exactly in floating point.
#pragma once

#include <cassert>

#include "carnot/numerics/linear_algebra.h"

namespace carnot {

// Which stages must be solved together.
enum class Coupling {
  kFull,      // all of them
  kDiagonal,  // one after the other, each implicit
  kExplicit   // one after the other, none implicit
};

inline constexpr int kAnyStages = Eigen::Dynamic;
inline constexpr int kMostStages = 17;         // of any method
inline constexpr int kMostCoupledStages = 12;  // of a method with full coupling

template <class T, int s>
using StageVector = Eigen::Matrix<T, s, 1, 0, s == kAnyStages ? kMostStages : s, 1>;
template <class T, int s>
using StageMatrix =
    Eigen::Matrix<T, s, s, 0, s == kAnyStages ? kMostStages : s, s == kAnyStages ? kMostStages : s>;

// Where s is fixed a method may have fewer stages. The others are idle: all their coefficients are
// zero, so that they stay at the start of the step and add nothing. Aligned so that a row of eight
// lies in one cache line.
template <class T, int s = kAnyStages>
struct Tableau {
  int order = 0;
  int active = 0;  // stages, where s is fixed
  Coupling coupling = Coupling::kFull;
  bool partitioned = false;
  StageVector<T, s> c;                  // nodes
  StageVector<T, s> b;                  // weights
  alignas(64) StageVector<T, s> omega;  // b, with 1 for 0
  StageVector<T, s> update;             // 1, or 0 where b is 0
  alignas(64) StageMatrix<T, s> mu;     // of q, and of p unless partitioned
  StageMatrix<T, s> mu_p;               // of p where partitioned, else empty (fixed s: unused)

  // Row i, column j: weight of L_j of the last step in the first guess of L_i of the next one of
  // the same length, by extrapolation of the collocation polynomial. Full coupling only.
  alignas(64) StageMatrix<T, s> extrapolation;
  // The same by the first four Legendre coefficients of that polynomial alone, for long steps:
  // beyond the step the others grow too much.
  alignas(64) StageMatrix<T, s> cautious;
  // Row k, column j: weight of L_j in Legendre coefficient k. Collocation methods only.
  alignas(64) StageMatrix<T, s> legendre;

  [[nodiscard]] int stages() const { return s == kAnyStages ? static_cast<int>(c.size()) : active; }
  // Whether no b is 0, of the stages that are not idle.
  [[nodiscard]] bool all_weighted() const {
    for (int i = 0; i < stages(); ++i) {
      if (update[i] != T(1)) return false;
    }
    return true;
  }
  [[nodiscard]] T momentum_mu(int i, int j) const { return partitioned ? mu_p(i, j) : mu(i, j); }
};

// mu_ij + mu_p_ji = 1 for every pair, to the last bit.
template <class T, int s>
bool is_symplectic(const Tableau<T, s>& tableau) {
  for (int i = 0; i < tableau.stages(); ++i) {
    for (int j = 0; j < tableau.stages(); ++j) {
      if (tableau.mu(i, j) + tableau.momentum_mu(j, i) != T(1)) return false;
    }
  }
  return tableau.all_weighted();
}

// omega and update from b.
template <class T, int s>
void set_weights(Tableau<T, s>& tableau) {
  tableau.omega = tableau.b;
  tableau.update = tableau.b;
  for (int i = 0; i < tableau.b.size(); ++i) tableau.update[i] = T(1);
  for (int i = 0; i < tableau.stages(); ++i) {
    if (tableau.b[i] != T(0)) continue;
    tableau.omega[i] = T(1);
    tableau.update[i] = T(0);
  }
}

// The extrapolation weights of the nodes c: omega_i/omega_j times the Lagrange polynomial l_j at
// 1 + c_i. Of nodes that are equal to one another the first one counts.
template <class T, int s>
void set_extrapolation(Tableau<T, s>& tableau) {
  const int count = tableau.stages();
  const auto repeats = [&](int j) {
    for (int i = 0; i < j; ++i) {
      if (tableau.c[i] == tableau.c[j]) return true;
    }
    return false;
  };
  tableau.extrapolation.setZero(count, count);
  for (int i = 0; i < count; ++i) {
    for (int j = 0; j < count; ++j) {
      if (repeats(j)) continue;
      T weight = tableau.omega[i] / tableau.omega[j];
      for (int k = 0; k < count; ++k) {
        if (k == j || repeats(k)) continue;
        weight *= (T(1) + tableau.c[i] - tableau.c[k]) / (tableau.c[j] - tableau.c[k]);
      }
      tableau.extrapolation(i, j) = weight;
    }
  }
}

// The same method with room for s stages, known at compile time. Full coupling only.
template <int s, class T>
Tableau<T, s> fixed_stages(const Tableau<T, kAnyStages>& of) {
  assert(of.coupling == Coupling::kFull && of.stages() <= s);
  const auto vector = [](const StageVector<T, kAnyStages>& some) {
    StageVector<T, s> all;
    for (int i = 0; i < s; ++i) all[i] = i < some.size() ? some[i] : T(0);
    return all;
  };
  const auto matrix = [](const StageMatrix<T, kAnyStages>& some) {
    StageMatrix<T, s> all;
    for (int i = 0; i < s; ++i) {
      for (int j = 0; j < s; ++j)
        all(i, j) = i < some.rows() && j < some.cols() ? some(i, j) : T(0);
    }
    return all;
  };
  Tableau<T, s> tableau;
  tableau.order = of.order;
  tableau.active = of.stages();
  tableau.coupling = of.coupling;
  tableau.c = vector(of.c);
  tableau.b = vector(of.b);
  tableau.omega = vector(of.omega);
  tableau.update = vector(of.update);
  tableau.partitioned = of.partitioned;
  tableau.mu = matrix(of.mu);
  tableau.mu_p = of.partitioned ? matrix(of.mu_p) : tableau.mu;
  tableau.extrapolation = matrix(of.extrapolation);
  tableau.cautious = matrix(of.cautious);
  tableau.legendre = matrix(of.legendre);
  return tableau;
}

}  // namespace carnot
