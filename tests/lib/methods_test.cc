#include "carnot/tableau/methods.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <boost/multiprecision/cpp_bin_float.hpp>
#include <boost/multiprecision/eigen.hpp>
#include <cmath>
#include <complex>
#include <limits>
#include <set>
#include <string>
#include <vector>

#include "carnot/numerics/lu.h"
#include "carnot/tableau/make_tableau.h"
#include "carnot/tableau/order_conditions.h"
#include "carnot/tableau/rooted_trees.h"
#include "carnot/tableau/tableau_laws.h"

namespace carnot::methods_test {
namespace {

constexpr double kEps = std::numeric_limits<double>::epsilon();

class MethodTest : public ::testing::TestWithParam<Method> {
 protected:
  const Method& method_ = GetParam();
  const Tableau<double> tableau_ = make_tableau(method_);
};

INSTANTIATE_TEST_SUITE_P(AllMethods,
                         MethodTest,
                         ::testing::ValuesIn(methods()),
                         [](const auto& method) { return method.param.name; });

TEST_P(MethodTest, HasTheDeclaredTableau) {
  EXPECT_EQ(tableau_.order, method_.order);
  EXPECT_EQ(tableau_.stages(), method_.stages);
  EXPECT_LE(method_.stages,
            tableau_.coupling == Coupling::kFull ? kMostCoupledStages : kMostStages);
  EXPECT_EQ(tableau_.partitioned, method_.family == kLobattoFamily);
  EXPECT_FALSE(method_.summary.empty());
}

// The number in the name is the order; without one it is 2, but for dop853.
TEST_P(MethodTest, IsNamedByItsOrder) {
  if (method_.name == "dop853") return;
  const std::size_t digits = method_.name.find_first_of("0123456789");
  EXPECT_EQ(digits == std::string::npos ? 2 : std::stoi(method_.name.substr(digits)),
            method_.order);
}

TEST_P(MethodTest, IsFoundByName) {
  const Method* found = find_method(method_.name);
  ASSERT_NE(found, nullptr);
  EXPECT_EQ(found->name, method_.name);
}

TEST_P(MethodTest, HasTheDeclaredOrder) {
  constexpr int kMostOrder = 8;
  constexpr int kRoundings = 4;  // every entry of a term is rounded to half a unit
  const int most = tableau_.partitioned ? kMostOrder - 1 : kMostOrder;  // many trees
  const RootedTrees<double> trees(tableau_, most);
  EXPECT_EQ(trees.order(kRoundings), std::min(method_.order, most));
}

TEST_P(MethodTest, IsSymplecticIfDeclared) {
  EXPECT_EQ(is_symplectic(tableau_), method_.symplectic);
  if (method_.symplectic) {
    EXPECT_LE(symplecticity_defect(tableau_), 2 * kEps);  // products of b and mu are rounded
  } else {
    EXPECT_GT(symplecticity_defect(tableau_), 1e-4);
  }
}

TEST_P(MethodTest, IsSymmetricIfDeclared) {
  if (method_.symmetric) {
    EXPECT_LE(symmetry_defect(tableau_), 2 * kEps);  // products of b and mu are rounded
  } else {
    EXPECT_GT(symmetry_defect(tableau_), 1e-3);
  }
}

// R(iy) on z' = iy z, R(w) = 1 + w b^T (1 - wA)^{-1} 1. With u + iv the stages, v = y A u and
// (1 + y^2 A^2) u = 1.
std::complex<double> stability(const Tableau<double>& tableau, double y) {
  const int s = tableau.stages();
  const auto a = coefficients_of(tableau);
  std::vector<double> matrix, u(s, 1.0);  // by rows
  for (int i = 0; i < s; ++i) {
    for (int j = 0; j < s; ++j) {
      long double square = 0;
      for (int k = 0; k < s; ++k) square += a(i, k) * a(k, j);
      matrix.push_back((i == j ? 1 : 0) + y * y * static_cast<double>(square));
    }
  }
  EXPECT_TRUE(lu_solve(s, matrix.data(), 1, u.data()));
  double real = 1;
  double imaginary = 0;
  for (int i = 0; i < s; ++i) {
    double v = 0;
    for (int j = 0; j < s; ++j) v += y * static_cast<double>(a(i, j)) * u[j];
    real -= y * tableau.b[i] * v;
    imaginary += y * tableau.b[i] * u[i];
  }
  return {real, imaginary};
}

// A symmetric method turns without damping, as does a symplectic one; Radau IIA damps, and DOP853
// grows or damps.
TEST_P(MethodTest, TurnsWithoutDampingIfGeometric) {
  if (tableau_.partitioned) return;  // q and p differ: R is a matrix
  for (const double y : {0.3, 1.0, 2.5}) {
    const double change = std::abs(std::abs(stability(tableau_, y)) - 1);
    if (method_.symmetric) {
      EXPECT_LE(change, 64 * kEps) << y;  // a solve with 17 unknowns, well conditioned
    } else if (y == 2.5) {
      EXPECT_GT(change, 1e-8) << y;
    }
  }
}

TEST(MethodsTest, NamesAreUnique) {
  std::set<std::string> names;
  for (const Method& method : methods()) names.insert(method.name);
  EXPECT_EQ(names.size(), methods().size());
}

TEST(MethodsTest, KnowTheAliasAndRefuseTheRest) {
  ASSERT_NE(find_method("gauss2"), nullptr);
  EXPECT_EQ(find_method("gauss2"), find_method("midpoint"));
  for (const char* name : {"", "gauss", "gauss3", "gauss26", "Midpoint", "midpoint2", "rattle8"}) {
    EXPECT_EQ(find_method(name), nullptr) << name;
  }
}

// Every order that the families are to offer.
TEST(MethodsTest, OfferTheFamilies) {
  for (int order = 4; order <= 24; order += 2) {
    EXPECT_NE(find_method("gauss" + std::to_string(order)), nullptr);
  }
  for (const char* name : {"midpoint4",
                           "midpoint6",
                           "midpoint8",
                           "lobatto2",
                           "lobatto4",
                           "lobatto6",
                           "lobatto8",
                           "radau3",
                           "radau5",
                           "radau9",
                           "dop853",
                           "rattle",
                           "rattle4",
                           "rattle6"}) {
    EXPECT_NE(find_method(name), nullptr) << name;
  }
}

// The steps of a RATTLE composition are those of the midpoint composition of the same order.
TEST(MethodsTest, RattleReusesTheCompositions) {
  for (const int order : {4, 6}) {
    const auto rattle = make_tableau(*find_method("rattle" + std::to_string(order)));
    const auto midpoint = make_tableau(*find_method("midpoint" + std::to_string(order)));
    EXPECT_EQ(rattle.b, midpoint.b);
  }
  EXPECT_EQ(make_tableau(*find_method("rattle")).b[0], 1.0);
}

using Quad = boost::multiprecision::cpp_bin_float_quad;

// The largest difference of an entry of mu (of p too) from that in quad, per its size.
template <class T>
double error_of_mu(const Tableau<T>& tableau, const Tableau<Quad>& quad) {
  double error = 0;
  for (int i = 0; i < tableau.stages(); ++i) {
    for (int j = 0; j < tableau.stages(); ++j) {
      const auto q = static_cast<double>(Quad(tableau.mu(i, j)) - quad.mu(i, j));
      const auto p = static_cast<double>(Quad(tableau.momentum_mu(i, j)) - quad.momentum_mu(i, j));
      const double size = std::max(1.0, static_cast<double>(std::abs(tableau.mu(i, j))));
      error = std::max({error, std::abs(q) / size, std::abs(p) / size});
    }
  }
  return error;
}

// Tables in quad have the same structure, and those in double and long double agree with them.
TEST_P(MethodTest, RoundsTheTableInQuad) {
  const auto quad = make_tableau<Quad>(method_);
  const auto wide = make_tableau<long double>(method_);
  EXPECT_EQ(is_symplectic(quad), method_.symplectic);
  EXPECT_EQ(is_symplectic(wide), method_.symplectic);
  constexpr auto kWideEps = static_cast<double>(std::numeric_limits<long double>::epsilon());
  constexpr double kSum = 4;  // long double is its own wider type: a sum of up to 12 terms
  EXPECT_LE(error_of_mu(tableau_, quad), 0.51 * kEps);  // rounded once
  EXPECT_LE(error_of_mu(wide, quad), kSum * kWideEps);
  for (int i = 0; i < method_.stages; ++i) {
    // Rounded once, or as both ends of a step of a composition.
    EXPECT_NEAR(static_cast<double>(Quad(tableau_.b[i]) - quad.b[i]),
                0,
                1.01 * kEps * std::max(1.0, std::abs(tableau_.b[i])));
    EXPECT_NEAR(static_cast<double>(Quad(tableau_.c[i]) - quad.c[i]), 0, 0.51 * kEps);
  }
}

}  // namespace
}  // namespace carnot::methods_test
