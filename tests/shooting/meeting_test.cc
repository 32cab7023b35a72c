// Where two extremals meet: along rays that are neighbours, and shortly before conjugate times.
#include "carnot/shooting/rays/meeting.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "carnot/shooting/cut_time.h"
#include "carnot/shooting/rays/conjugate_time.h"
#include "shooting/problems.h"

namespace carnot::internal::meeting_test {
namespace {

const std::vector<double> kOrigin(4, 0.0);

Dynamics vehicle() { return test::vehicle(kOrigin, kOrigin).dynamics; }

std::vector<double> at_unit_speed(const Dynamics& dynamics, std::vector<double> p) {
  const double speed = speed_of(dynamics, kOrigin, p);
  for (double& x : p) x /= speed;
  return p;
}

double apart(const std::vector<double>& a, const std::vector<double>& b) {
  double sum = 0;
  for (std::size_t j = 0; j < a.size(); ++j) sum += (a[j] - b[j]) * (a[j] - b[j]);
  return std::sqrt(sum);
}

// A ray of the vehicle and a rival of it, which Newton's method has led to a meeting.
struct MeetingOfVehicles {
  Ray ray;
  Rival rival;
};

MeetingOfVehicles meeting_of_vehicles(const Dynamics& dynamics) {
  const Ray ray(dynamics, kOrigin, at_unit_speed(dynamics, {0.784, 66.9, -81.06, 0.6208}));
  Rival rival{{0.8536, 66.75, -62.63, -0.5209}, std::vector<double>(4, 0.0), 1.01};
  EXPECT_TRUE(polish_meeting(ray, ray.enough_steps(rival.t), rival));
  return {ray, rival};
}

// What is missed when a rival is carried is of second order in the change of the ray.
TEST(Meeting, RivalsAreCarriedToFirstOrder) {
  const Dynamics dynamics = vehicle();
  const MeetingOfVehicles meeting = meeting_of_vehicles(dynamics);
  const Ray& ray = meeting.ray;
  const Rival& rival = meeting.rival;
  const std::vector<double> way{-0.3, 0.2, -0.5, 0.1};
  const auto missed = [&](double step) {
    std::vector<double> to = ray.p();
    for (std::size_t j = 0; j < to.size(); ++j) to[j] += step * way[j];
    to = at_unit_speed(dynamics, to);
    const Ray next(dynamics, kOrigin, to);
    const auto guess = carried(ray, rival, to, ray.enough_steps(rival.t));
    EXPECT_TRUE(guess.has_value());
    Rival exact = *guess;
    EXPECT_TRUE(polish_meeting(next, next.enough_steps(exact.t), exact));
    // Nothing is carried where the rival does not move at all.
    EXPECT_GT(apart(exact.p, rival.p), 10 * apart(exact.p, guess->p));
    return std::hypot(apart(exact.p, guess->p), exact.t - guess->t);
  };
  constexpr double kStep = 1e-2;
  constexpr double kOrder = 0.2;  // of a slope
  EXPECT_NEAR(std::log2(missed(kStep) / missed(0.5 * kStep)), 2, kOrder);
}

// Two families of neighbours are nearly conjugate at one time on extremals that start along the
// abnormal covector: the branch that leaves the first conjugate time bends towards the second
// family. The search of all extremals knows nothing of branches.
TEST(Meeting, NeighboursAreMetWhereTheBranchBends) {
  constexpr double kSearched = 1e-8;  // of the time that a search finds
  constexpr double kHorizon = 1.5;
  const Dynamics dynamics = vehicle();
  const std::vector<double> p =
      at_unit_speed(dynamics, {0.971651695, 95.749139, -83.385896, 0.2364173});
  const Ray ray(dynamics, kOrigin, p);
  const double conjugate = conjugate_time(ray, kHorizon);
  const auto meeting = meet_neighbours(ray, conjugate);
  ASSERT_TRUE(meeting.has_value());
  EXPECT_LT(meeting->rival.t, conjugate);
  CutTimeOptions options;
  options.max_time = kHorizon;
  const CutTime cut = cut_time(dynamics, kOrigin, p, options);
  ASSERT_TRUE(cut.cut_time.has_value());
  EXPECT_NEAR(meeting->rival.t, *cut.cut_time, kSearched);
  ASSERT_TRUE(cut.partner_p0.has_value());
  EXPECT_LT(apart(meeting->rival.p, *cut.partner_p0), 1e-3 * apart(meeting->rival.p, p));
}

}  // namespace
}  // namespace carnot::internal::meeting_test
