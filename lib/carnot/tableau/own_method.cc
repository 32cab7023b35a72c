#include "carnot/tableau/own_method.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <utility>

#include "carnot/tableau/collocation.h"
#include "carnot/tableau/method_order.h"
#include "carnot/tableau/tableau_laws.h"

namespace carnot {

namespace {

using RowsOfNumbers = std::vector<std::vector<double>>;

constexpr double kRoundOff = kOwnRoundings * std::numeric_limits<double>::epsilon();

void refuse_unless(bool good, const ButcherTableau& butcher, const std::string& what) {
  if (!good) throw std::invalid_argument("method " + butcher.name + ": " + what);
}

void check_rows(const ButcherTableau& butcher, const RowsOfNumbers& rows, const std::string& name) {
  const std::size_t s = butcher.b.size();
  const std::string wanted =
      name + " must have " + std::to_string(s) + " rows of " + std::to_string(s);
  const std::string infinite = name + " has an entry that is not finite";
  refuse_unless(rows.size() == s, butcher, wanted + ", as b has entries");
  for (const std::vector<double>& row : rows) {
    refuse_unless(row.size() == s, butcher, wanted);
    for (const double entry : row) {
      refuse_unless(std::isfinite(entry), butcher, infinite);
    }
  }
}

void check(const ButcherTableau& butcher) {
  refuse_unless(!butcher.name.empty(), butcher, "its name is empty");
  refuse_unless(!butcher.b.empty(), butcher, "b is empty");
  double sum = 0;
  double size = 0;
  for (const double entry : butcher.b) {
    refuse_unless(std::isfinite(entry), butcher, "b has an entry that is not finite");
    sum += entry;
    size += std::abs(entry);
  }
  refuse_unless(std::abs(sum - 1) <= kRoundOff * size,
                butcher,
                "b must sum to 1: the steps go to another time otherwise");
  check_rows(butcher, butcher.a, "a");
  if (!butcher.a_p.empty()) check_rows(butcher, butcher.a_p, "a_p");
}

// By the zeros of a.
Coupling coupling_of(const ButcherTableau& butcher) {
  if (!butcher.a_p.empty()) return Coupling::kFull;  // q of a stage needs p of later ones
  Coupling coupling = Coupling::kExplicit;
  for (std::size_t i = 0; i < butcher.b.size(); ++i) {
    for (std::size_t j = i + 1; j < butcher.b.size(); ++j) {
      if (butcher.a[i][j] != 0) return Coupling::kFull;
    }
    if (butcher.a[i][i] != 0) coupling = Coupling::kDiagonal;
  }
  return coupling;
}

StageMatrix<double, kAnyStages> mu_of(const RowsOfNumbers& a, const Tableau<double>& tableau) {
  const int s = tableau.stages();
  StageMatrix<double, kAnyStages> mu(s, s);
  for (int i = 0; i < s; ++i) {
    for (int j = 0; j < s; ++j) mu(i, j) = a[i][j] / tableau.omega[j];
  }
  return mu;
}

// Moves mu so that mu_ij + mu^_ji = 1 holds exactly. Of a pair the larger number stays, since one
// minus it is exact (gauss_tableau.h).
void make_symplectic(Tableau<double>& tableau) {
  const int s = tableau.stages();
  if (tableau.partitioned) {
    for (int i = 0; i < s; ++i) {
      for (int j = 0; j < s; ++j) {
        double& mu = tableau.mu(i, j);
        if (mu < 0.5) mu = 1 - (1 - mu);  // both are exact now
        tableau.mu_p(j, i) = 1 - mu;
      }
    }
    return;
  }
  for (int i = 0; i < s; ++i) {
    tableau.mu(i, i) = 0.5;
    for (int j = 0; j < i; ++j) {
      double& mu = tableau.mu(i, j);
      double& other = tableau.mu(j, i);
      (mu < other ? mu : other) = 1 - std::max(mu, other);
    }
  }
}

}  // namespace

OwnMethod own_method(const ButcherTableau& butcher) {
  check(butcher);
  const int s = static_cast<int>(butcher.b.size());
  Tableau<double> tableau;
  tableau.coupling = coupling_of(butcher);
  const bool coupled = tableau.coupling == Coupling::kFull;
  const int most = coupled ? kMostCoupledStages : kMostStages;
  refuse_unless(s <= most,
                butcher,
                "more than " + std::to_string(most) + " stages" +
                    (coupled ? " that depend on each other" : ""));
  tableau.partitioned = !butcher.a_p.empty();
  tableau.b.resize(s);
  tableau.c.resize(s);
  for (int i = 0; i < s; ++i) {
    tableau.b[i] = butcher.b[i];
    tableau.c[i] = 0;
    for (const double entry : butcher.a[i]) tableau.c[i] += entry;
  }
  set_weights(tableau);
  tableau.mu = mu_of(butcher.a, tableau);
  if (tableau.partitioned) tableau.mu_p = mu_of(butcher.a_p, tableau);

  double scale = 1;  // of the products b_i b_j
  for (const double entry : butcher.b) scale = std::max(scale, entry * entry);
  const bool symplectic =
      tableau.all_weighted() && symplecticity_defect(tableau) <= kRoundOff * scale;
  if (symplectic) make_symplectic(tableau);
  if (coupled) {
    set_extrapolation(tableau);
    set_legendre(tableau);
  }
  tableau.order = order_of(tableau, kOwnRoundings);
  Method method{butcher.name,
                tableau.partitioned ? kOwnPartitionedFamily : kOwnFamily,
                tableau.order,
                s,
                symplectic,
                symmetry_defect(tableau) <= kRoundOff * scale,
                "by its coefficients"};
  return {std::move(method), std::move(tableau)};
}

}  // namespace carnot
