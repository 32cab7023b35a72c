// Cut times from neighbour to neighbour, against searches of single ones.
#include "carnot/shooting/front/cut_values.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <vector>

#include "carnot/shooting/cut_time.h"
#include "carnot/shooting/rays/ray.h"
#include "shooting/problems.h"

namespace carnot::internal::cut_values_test {
namespace {

constexpr double kHorizon = 1.5;
const std::vector<double> kOrigin(4, 0.0);

Dynamics vehicle() { return test::vehicle(kOrigin, kOrigin).dynamics; }

// A straight line of momenta, which are then of unit speed.
std::vector<std::vector<double>> line(const Dynamics& dynamics,
                                      const std::vector<double>& first,
                                      const std::vector<double>& last,
                                      int count) {
  std::vector<std::vector<double>> momenta;
  for (int i = 0; i < count; ++i) {
    std::vector<double> p = first;
    for (std::size_t j = 0; j < p.size(); ++j) p[j] += i * (last[j] - first[j]) / (count - 1);
    const double speed = speed_of(dynamics, kOrigin, p);
    for (double& x : p) x /= speed;
    momenta.push_back(std::move(p));
  }
  return momenta;
}

// Each with the one before and the one after it.
void add_chain(const std::vector<std::vector<double>>& momenta, CutValues& values) {
  const int count = static_cast<int>(momenta.size());
  std::vector<std::vector<int>> neighbours(count);
  std::vector<int> all;
  for (int i = 0; i < count; ++i) {
    if (i > 0) neighbours[i].push_back(i - 1);
    if (i + 1 < count) neighbours[i].push_back(i + 1);
    all.push_back(i);
  }
  ASSERT_TRUE(values.add(momenta, neighbours, all, 0));
}

CutValues values_of(const Dynamics& dynamics) {
  return {dynamics, kOrigin, UnitMomenta(dynamics, kOrigin, {}, true), {kHorizon}};
}

TEST(CutValues, AreThoseOfSearches) {
  constexpr double kSame = 1e-9;  // both end with Newton's method
  const Dynamics dynamics = vehicle();
  const auto momenta = line(dynamics, {0.6, -3, 2, 0.8}, {0.8, -6, 4, 0.6}, 24);
  CutValues values = values_of(dynamics);
  add_chain(momenta, values);
  EXPECT_LT(values.searches(), 20);
  EXPECT_EQ(values.unknown(0), 0);
  CutTimeOptions search;
  search.max_time = kHorizon;
  for (int i = 0; i < 24; i += 5) {
    const CutTime cut = cut_time(dynamics, kOrigin, momenta[i], search);
    ASSERT_EQ(cut.status, CutStatus::kConverged);
    if (cut.cut_time) {
      EXPECT_NEAR(values[i].t, *cut.cut_time, kSame * *cut.cut_time);
    } else {
      EXPECT_TRUE(std::isinf(values[i].t));
    }
  }
}

TEST(CutValues, OfAMeshLeaveOutWhatHasNoNeighbours) {
  constexpr double kSame = 1e-9;
  const Dynamics dynamics = vehicle();
  auto momenta = line(dynamics, {0.6, -3, 2, 0.8}, {0.62, -3.06, 2.04, 0.79}, 3);
  momenta.insert(momenta.begin() + 1, std::vector<double>(4, std::nan("")));
  CutValues cuts = values_of(dynamics);
  const auto values = cuts.of_mesh(momenta, {{2}, {}, {0, 3}, {2}}, 1);
  ASSERT_TRUE(values);
  ASSERT_EQ(values->size(), 4U);
  EXPECT_FALSE((*values)[1].known);
  EXPECT_TRUE(std::isnan((*values)[1].t));
  CutTimeOptions search;
  search.max_time = kHorizon;
  for (const int i : {0, 2, 3}) {
    const CutTime cut = cut_time(dynamics, kOrigin, momenta[i], search);
    const double expected = cut.cut_time.value_or(std::numeric_limits<double>::infinity());
    EXPECT_TRUE((*values)[i].known);
    if ((*values)[i].t != expected) {
      EXPECT_NEAR((*values)[i].t, expected, kSame * expected);
    }
  }
}

// Here the search of one fails: what is shorter is not followed back. An extremal is never shortest
// beyond its conjugate time, so none may be told to be.
TEST(CutValues, AreConjugateTimesAtMost) {
  const Dynamics dynamics = vehicle();
  const auto momenta =
      line(dynamics,
           {-0.88921684203568441, -86.968305922, 81.018018979, 0.45748596463726032},
           {-0.88921684203568441, -87.912477442133522, 81.994284005541132, 0.45748596463726032},
           2);
  CutValues values = values_of(dynamics);
  add_chain(momenta, values);
  long unknown = 0;
  for (int i = 0; i < 2; ++i) {
    ASSERT_LT(values[i].conjugate, 1);
    EXPECT_LE(values[i].t, values[i].conjugate);
    if (values[i].known) continue;
    EXPECT_EQ(values[i].t, values[i].conjugate);
    ++unknown;
  }
  EXPECT_EQ(values.unknown(0), unknown);
  EXPECT_EQ(values.unknown(1), 0);
}

}  // namespace
}  // namespace carnot::internal::cut_values_test
