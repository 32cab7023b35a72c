#include "carnot/numerics/darboux.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <span>
#include <string>
#include <vector>

#include "testing/canonical.h"
#include "testing/random_points.h"

namespace carnot::darboux_test {
namespace {

using Eigen::MatrixXd;
using test::canonical;
using ::testing::HasSubstr;

constexpr double kEps = std::numeric_limits<double>::epsilon();
constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kInf = std::numeric_limits<double>::infinity();
constexpr int kLargest = 12;

MatrixXd random_square(int size, test::Generator& generator) {
  std::normal_distribution<double> normal;
  MatrixXd a(size, size);
  for (int j = 0; j < size; ++j) {
    for (int i = 0; i < size; ++i) a(i, j) = normal(generator);
  }
  return a;
}

std::span<const double> numbers(const MatrixXd& a) {
  return {a.data(), static_cast<std::size_t>(a.size())};
}

MatrixXd square(const std::vector<double>& numbers) {
  const auto size = static_cast<int>(std::lround(std::sqrt(numbers.size())));
  return Eigen::Map<const MatrixXd>(numbers.data(), size, size);
}

// DarbouxForm with its matrices as such.
struct Form {
  int dof = 0;
  MatrixXd basis;
  MatrixXd inverse;
  std::vector<double> sigma;
};

template <class... Rest>
Form form_of(const MatrixXd& j, Rest... rest) {
  const DarbouxForm form = darboux_form(numbers(j), static_cast<int>(j.rows()), rest...);
  return {form.dof, square(form.basis), square(form.inverse), form.sigma};
}

// A product of reflections: orthogonal to a few eps.
MatrixXd random_orthogonal(int size, test::Generator& generator) {
  MatrixXd q = MatrixXd::Identity(size, size);
  const MatrixXd directions = random_square(size, generator);
  for (int k = 0; k < size; ++k) {
    const Eigen::VectorXd v = directions.col(k) / directions.col(k).norm();
    const Eigen::RowVectorXd w = v.transpose() * q;
    q -= 2 * v * w;
  }
  return q;
}

// Q'J Q where J has these sigma, antisymmetric to the last bit.
MatrixXd with_sigma(int size, const std::vector<double>& sigma, test::Generator& generator) {
  const auto dof = static_cast<int>(sigma.size());
  MatrixXd j = canonical(size, dof);
  for (int i = 0; i < dof; ++i) {
    j(i, dof + i) *= sigma[static_cast<std::size_t>(i)];
    j(dof + i, i) *= sigma[static_cast<std::size_t>(i)];
  }
  const MatrixXd q = random_orthogonal(size, generator);
  const MatrixXd moved = q.transpose() * (j * q);
  return 0.5 * (moved - moved.transpose());
}

double distance(const MatrixXd& a, const MatrixXd& b) {
  return a.size() == 0 ? 0 : (a - b).cwiseAbs().maxCoeff();
}

// T'J T = J_0 and T T^-1 = 1 to round-off: N eps times sigma_max / sigma_min, times its root.
void expect_darboux(const MatrixXd& j, int dof) {
  const Form form = form_of(j);
  ASSERT_EQ(form.dof, dof);
  ASSERT_EQ(form.sigma.size(), static_cast<std::size_t>(dof));
  const auto size = static_cast<int>(j.rows());
  const double condition = form.sigma.front() / form.sigma.back();
  constexpr double kFew = 8;
  const double unit = kFew * size * kEps;
  const MatrixXd moved = form.basis.transpose() * (j * form.basis);
  EXPECT_LE(distance(moved, canonical(size, dof)), unit * condition) << j;
  const MatrixXd identity = MatrixXd::Identity(size, size);
  EXPECT_LE(distance(form.basis * form.inverse, identity), unit * std::sqrt(condition));
  // The kernel comes with an orthonormal basis, so its scale is that of z.
  const MatrixXd kernel = form.basis.rightCols(size - 2 * dof);
  EXPECT_LE(
      distance(kernel.transpose() * kernel, identity.topLeftCorner(kernel.cols(), kernel.cols())),
      unit);
}

TEST(DarbouxTest, EveryRankInARandomBasis) {
  test::Generator generator(1);
  for (int size = 2; size <= kLargest; ++size) {
    for (int dof = 1; 2 * dof <= size; ++dof) {
      for (int sample = 0; sample < 10; ++sample) {
        const MatrixXd a = random_square(size, generator);
        // Terms cancel: the symmetric part that they leave is round-off of them, and not of J.
        const MatrixXd j = a.transpose() * (canonical(size, dof) * a);
        expect_darboux(0.5 * (j - j.transpose()), dof);
      }
    }
  }
}

TEST(DarbouxTest, FindsSigmaThatAreKnown) {
  test::Generator generator(2);
  for (int size = 2; size <= kLargest; ++size) {
    for (int dof = 1; 2 * dof <= size; ++dof) {
      std::vector<double> sigma;
      for (int i = 0; i < dof; ++i) sigma.push_back(3 * std::pow(0.2, i));
      const MatrixXd j = with_sigma(size, sigma, generator);
      expect_darboux(j, dof);
      const Form form = form_of(j);
      for (std::size_t i = 0; i < sigma.size(); ++i) {
        EXPECT_NEAR(form.sigma[i], sigma[i], 8 * size * kEps * sigma[0]);
      }
    }
  }
}

// All planes alike: here a QR iteration that looks at the diagonal for a scale may not end.
TEST(DarbouxTest, EqualSigma) {
  test::Generator generator(3);
  for (int size = 4; size <= kLargest; ++size) {
    for (int sample = 0; sample < 200; ++sample) {
      const int dof = 1 + sample % (size / 2);
      expect_darboux(with_sigma(size, std::vector<double>(dof, 2), generator), dof);
    }
  }
}

// J_0 in its own coordinates keeps them, to the last bit.
TEST(DarbouxTest, PairedCoordinatesStayThemselves) {
  for (int size = 2; size <= kLargest; ++size) {
    for (int dof = 1; 2 * dof <= size; ++dof) {
      const Form form = form_of(canonical(size, dof));
      EXPECT_EQ(form.dof, dof);
      EXPECT_EQ(form.basis, MatrixXd::Identity(size, size));
      EXPECT_EQ(form.inverse, MatrixXd::Identity(size, size));
    }
  }
  // z = (p, y, q) and J of size 4: q is z_3 sqrt(4), p is z_1 sqrt(4).
  MatrixXd j = MatrixXd::Zero(3, 3);
  j(0, 2) = 4;
  j(2, 0) = -4;
  MatrixXd expected = MatrixXd::Zero(3, 3);
  expected(2, 0) = expected(0, 1) = 0.5;
  expected(1, 2) = 1;
  EXPECT_EQ(form_of(j).basis, expected);
}

// Entries of any size, also where their squares would not be numbers.
TEST(DarbouxTest, DoesNotDependOnUnits) {
  test::Generator generator(4);
  const MatrixXd j = with_sigma(5, {1, 0.5}, generator);
  const Form form = form_of(j);
  for (const double unit : {std::ldexp(1.0, -900), std::ldexp(1.0, 900)}) {
    const Form other = form_of(unit * j);
    ASSERT_EQ(other.dof, 2);
    EXPECT_EQ(other.sigma[1], unit * form.sigma[1]);
    const MatrixXd pairs = std::sqrt(unit) * other.basis.leftCols(4);
    EXPECT_LE(distance(pairs, form.basis.leftCols(4)), 4 * kEps);
  }
}

// Ill-conditioned is not rank-deficient: the coordinates lose digits, no more than the condition.
TEST(DarbouxTest, SmallSigmaAreNotZero) {
  test::Generator generator(5);
  for (const double small : {1e-3, 1e-6, 1e-9, 1e-12}) {
    expect_darboux(with_sigma(7, {1, small}, generator), 2);
    expect_darboux(with_sigma(8, {1, 1, small, small}, generator), 4);
  }
}

// The two sides of the tolerance, kRankTolerance N eps sigma_max.
TEST(DarbouxTest, ToleranceOfTheRank) {
  test::Generator generator(6);
  for (int size = 4; size <= kLargest; ++size) {
    const double zero = kRankTolerance * size * kEps * 3;
    for (int sample = 0; sample < 20; ++sample) {
      EXPECT_EQ(form_of(with_sigma(size, {3, 4 * zero}, generator)).dof, 2);
      EXPECT_EQ(form_of(with_sigma(size, {3, zero / 4}, generator)).dof, 1);
    }
  }
}

template <class F>
std::string reason(const F& f) {
  try {
    f();
  } catch (const std::invalid_argument& e) {
    return e.what();
  }
  return "accepted";
}

TEST(DarbouxTest, RefusesWithAReason) {
  const auto of = [](const MatrixXd& j) { return reason([&] { (void)form_of(j); }); };
  MatrixXd j = canonical(5, 2);
  EXPECT_EQ(of(j), "accepted");
  EXPECT_THAT(of(MatrixXd::Zero(5, 5)), HasSubstr("purely algebraic"));
  EXPECT_THAT(of(MatrixXd::Zero(1, 1)), HasSubstr("purely algebraic"));
  for (const double bad : {kNan, kInf, -kInf}) {
    j = canonical(5, 2);
    j(1, 3) = bad;
    EXPECT_THAT(of(j), HasSubstr("not finite"));
  }
  EXPECT_THAT(of(MatrixXd::Identity(4, 4)), HasSubstr("not antisymmetric"));
  for (const auto& [r, c] : {std::pair{0, 1}, {2, 2}, {4, 0}}) {
    j = canonical(5, 2);
    j(r, c) += 1e-6;
    EXPECT_THAT(of(j), HasSubstr("not antisymmetric")) << r << c;
    j = canonical(5, 2);
    j(r, c) += kEps;
    EXPECT_EQ(of(j), "accepted") << "round-off of a product A'J A";
  }
}

TEST(DarbouxTest, RefusesAnotherRankThanDeclared) {
  test::Generator generator(7);
  const MatrixXd j = with_sigma(6, {2, 1}, generator);
  EXPECT_EQ(form_of(j, 2).dof, 2);
  for (const int declared : {1, 3}) {
    const std::string why = reason([&] { (void)form_of(j, declared); });
    EXPECT_THAT(why, HasSubstr("has rank 4"));
    EXPECT_THAT(why, HasSubstr("declares " + std::to_string(2 * declared)));
  }
}

TEST(DarbouxTest, ChecksACoordinateSystemWrittenByHand) {
  test::Generator generator(8);
  const MatrixXd j = with_sigma(6, {2, 1}, generator);
  const MatrixXd t = form_of(j).basis;
  const auto of = [&](const MatrixXd& basis) {
    return reason([&] { (void)form_of(j, 2, numbers(basis)); });
  };
  const Form form = form_of(j, 2, numbers(t));
  EXPECT_EQ(form.basis, t);
  EXPECT_LE(distance(form.inverse * t, MatrixXd::Identity(6, 6)), 100 * kEps);
  EXPECT_THAT(of(MatrixXd::Identity(6, 6)), HasSubstr("does not bring J to Darboux form"));
  EXPECT_THAT(of(MatrixXd::Constant(6, 6, kNan)), HasSubstr("does not bring J to Darboux form"));
  MatrixXd wrong = t;
  wrong.col(0).swap(wrong.col(2));  // q' = -H_p: the other sign
  EXPECT_THAT(of(wrong), HasSubstr("does not bring J to Darboux form"));
  wrong = t;
  wrong.col(5) = wrong.col(4);
  EXPECT_THAT(of(wrong), HasSubstr("no inverse"));
  wrong.col(5).setZero();
  EXPECT_THAT(of(wrong), HasSubstr("no inverse"));
}

}  // namespace
}  // namespace carnot::darboux_test
