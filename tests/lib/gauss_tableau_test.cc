#include "carnot/gauss_tableau.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <string>

namespace carnot {
namespace {

constexpr double kEps = std::numeric_limits<double>::epsilon();
constexpr long double kWideEps = std::numeric_limits<long double>::epsilon();

template <class Stages>
class GaussTableauTest : public ::testing::Test {
 protected:
  static constexpr int kStages = Stages::value;
  const GaussTableau<double, kStages>& tableau_ = gauss_tableau<double, kStages>();
  const GaussTableau<long double, kStages>& wide_ = gauss_tableau<long double, kStages>();
  // Each law sums kStages terms of size at most 1 whose factors carry a few roundings of the nodes.
  const long double tolerance_ = 16 * kStages * kWideEps;
};

template <int s>
using Stages = std::integral_constant<int, s>;
using AllStages = ::testing::Types<Stages<1>,
                                   Stages<2>,
                                   Stages<3>,
                                   Stages<4>,
                                   Stages<5>,
                                   Stages<6>,
                                   Stages<7>,
                                   Stages<8>,
                                   Stages<9>,
                                   Stages<10>,
                                   Stages<11>,
                                   Stages<12>>;
struct StageNames {
  template <class S>
  static std::string GetName(int /*index*/) {
    return "s" + std::to_string(S::value);
  }
};
TYPED_TEST_SUITE(GaussTableauTest, AllStages, StageNames);

// B(2s): the quadrature is exact for degree < 2s, and not for degree 2s.
TYPED_TEST(GaussTableauTest, QuadratureHasDegreeOfExactness2s) {
  constexpr int s = TypeParam::value;
  for (int k = 1; k <= 2 * s + 1; ++k) {
    long double sum = 0;
    for (int i = 0; i < s; ++i) sum += this->wide_.b[i] * std::pow(this->wide_.c[i], k - 1);
    const long double defect = std::abs(k * sum - 1);
    if (k <= 2 * s) {
      EXPECT_LE(defect, k * this->tolerance_) << "k = " << k;
    } else if (s <= 8) {  // the defect, (s!)^4 / (2s)!^2, is above round-off up to here
      EXPECT_GT(defect, 4 * this->tolerance_) << "k = " << k;
    }
  }
}

// C(s): the stages are exact for polynomials of degree < s.
TYPED_TEST(GaussTableauTest, StagesCollocate) {
  constexpr int s = TypeParam::value;
  for (int k = 1; k <= s; ++k) {
    for (int i = 0; i < s; ++i) {
      long double sum = 0;
      for (int j = 0; j < s; ++j) {
        sum += this->wide_.mu(i, j) * this->wide_.b[j] * std::pow(this->wide_.c[j], k - 1);
      }
      EXPECT_NEAR(static_cast<double>(k * sum - std::pow(this->wide_.c[i], k)),
                  0,
                  static_cast<double>(k * this->tolerance_));
    }
  }
}

// D(s): sum_i b_i c_i^{k-1} a_ij = b_j (1 - c_j^k) / k.
TYPED_TEST(GaussTableauTest, TransposedStagesCollocate) {
  constexpr int s = TypeParam::value;
  for (int k = 1; k <= s; ++k) {
    for (int j = 0; j < s; ++j) {
      long double sum = 0;
      for (int i = 0; i < s; ++i) {
        sum += this->wide_.b[i] * std::pow(this->wide_.c[i], k - 1) * this->wide_.mu(i, j);
      }
      EXPECT_NEAR(static_cast<double>(k * sum - (1 - std::pow(this->wide_.c[j], k))),
                  0,
                  static_cast<double>(k * this->tolerance_));
    }
  }
}

TYPED_TEST(GaussTableauTest, SymplecticityHoldsExactly) {
  constexpr int s = TypeParam::value;
  for (int i = 0; i < s; ++i) {
    for (int j = 0; j < s; ++j) {
      EXPECT_EQ(this->tableau_.mu(i, j) + this->tableau_.mu(j, i), 1.0);
      EXPECT_EQ(this->tableau_.mu(j, i), 1.0 - this->tableau_.mu(i, j));
      EXPECT_EQ(this->wide_.mu(i, j) + this->wide_.mu(j, i), 1.0L);
    }
  }
}

// Reflection t -> 1 - t maps the method to itself.
TYPED_TEST(GaussTableauTest, IsSymmetric) {
  constexpr int s = TypeParam::value;
  for (int i = 0; i < s; ++i) {
    const int ri = s - 1 - i;
    EXPECT_EQ(this->tableau_.b[i], this->tableau_.b[ri]);
    EXPECT_NEAR(this->tableau_.c[i] + this->tableau_.c[ri], 1, kEps);
    for (int j = 0; j < s; ++j) {
      // mu_ij of neighbours is near 1; two entries, each rounded once.
      EXPECT_NEAR(this->tableau_.mu(i, j) + this->tableau_.mu(ri, s - 1 - j), 1, 2 * kEps);
    }
  }
}

// Rounded once: each double entry is the long double one to half a unit.
TYPED_TEST(GaussTableauTest, DoubleIsTheRoundedWideTableau) {
  constexpr int s = TypeParam::value;
  constexpr double kHalfUnit = 0.5001 * kEps;  // of numbers up to 1, plus the wide error
  for (int i = 0; i < s; ++i) {
    EXPECT_NEAR(static_cast<double>(this->tableau_.c[i] - this->wide_.c[i]), 0, kHalfUnit);
    EXPECT_NEAR(static_cast<double>(this->tableau_.b[i] - this->wide_.b[i]), 0, kHalfUnit);
    for (int j = 0; j < s; ++j) {
      const long double mu = this->wide_.mu(i, j);
      const double unit = std::max(1.0, static_cast<double>(std::abs(mu)));
      EXPECT_NEAR(static_cast<double>(this->tableau_.mu(i, j) - mu), 0, 2 * kHalfUnit * unit);
    }
  }
}

TYPED_TEST(GaussTableauTest, NodesAscendInsideTheStep) {
  constexpr int s = TypeParam::value;
  for (int i = 0; i < s; ++i) {
    EXPECT_GT(this->tableau_.c[i], i == 0 ? 0.0 : this->tableau_.c[i - 1]);
    EXPECT_LT(this->tableau_.c[i], 1.0);
    EXPECT_GT(this->tableau_.b[i], 0.0);
  }
  EXPECT_NEAR(this->tableau_.b.sum(), 1, s * kEps);
}

// The extrapolated increments of a polynomial rate of degree < s are those of the next step.
TYPED_TEST(GaussTableauTest, ExtrapolationReproducesPolynomials) {
  constexpr int s = TypeParam::value;
  for (int degree = 0; degree < s; ++degree) {
    for (int i = 0; i < s; ++i) {
      long double sum = 0;
      long double size = 0;
      for (int j = 0; j < s; ++j) {
        const long double term =
            this->wide_.extrapolation(i, j) * this->wide_.b[j] * std::pow(this->wide_.c[j], degree);
        sum += term;
        size += std::abs(term);
      }
      const long double exact = this->wide_.b[i] * std::pow(1 + this->wide_.c[i], degree);
      // Extrapolation is ill-conditioned: the terms are larger than their sum; node differences
      // as small as 1/s^2 enter s times.
      const long double tolerance = 16 * s * s * kWideEps * size;
      EXPECT_LE(std::abs(sum - exact), tolerance) << "degree " << degree << ", node " << i;
    }
  }
}

TEST(GaussTableauClosedForm, OneStageIsTheMidpointRule) {
  const auto& t = gauss_tableau<double, 1>();
  EXPECT_EQ(t.c[0], 0.5);
  EXPECT_EQ(t.b[0], 1.0);
  EXPECT_EQ(t.mu(0, 0), 0.5);
  EXPECT_EQ(t.extrapolation(0, 0), 1.0);
}

TEST(GaussTableauClosedForm, TwoStages) {
  const auto& t = gauss_tableau<double, 2>();
  const double r = std::sqrt(3.0) / 6;
  EXPECT_NEAR(t.c[0], 0.5 - r, kEps);
  EXPECT_NEAR(t.c[1], 0.5 + r, kEps);
  EXPECT_NEAR(t.b[0], 0.5, kEps);
  EXPECT_NEAR(t.mu(0, 1) * t.b[1], 0.25 - r, kEps);
  EXPECT_NEAR(t.mu(1, 0) * t.b[0], 0.25 + r, kEps);
}

TEST(GaussTableauClosedForm, ThreeStages) {
  const auto& t = gauss_tableau<double, 3>();
  const double r = std::sqrt(15.0);
  Matrix<double, 3, 3> a;
  // clang-format off
  a << 5. / 36,          2. / 9 - r / 15,  5. / 36 - r / 30,
       5. / 36 + r / 24, 2. / 9,           5. / 36 - r / 24,
       5. / 36 + r / 30, 2. / 9 + r / 15,  5. / 36;
  // clang-format on
  EXPECT_NEAR(t.c[0], 0.5 - r / 10, kEps);
  EXPECT_EQ(t.c[1], 0.5);
  EXPECT_NEAR(t.b[0], 5. / 18, kEps);
  EXPECT_NEAR(t.b[1], 4. / 9, kEps);
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) EXPECT_NEAR(t.mu(i, j) * t.b[j], a(i, j), kEps);
  }
}

}  // namespace
}  // namespace carnot
