#include "benchmark/benchmark_reference.h"

#include <fmt/format.h>

#include <algorithm>
#include <boost/multiprecision/eigen.hpp>
#include <boost/multiprecision/float128.hpp>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "carnot/flow/flow.h"
#include "carnot/scenes/heisenberg.h"
#include "carnot/scenes/vehicle.h"
#include "carnot/scenes/vehicle_cosine.h"
#include "carnot/step/gauss.h"
#include "carnot/system/velocity_constraints.h"
#include "text/progress_bar.h"

namespace carnot::apps {
namespace {

using Quad = boost::multiprecision::float128;
constexpr int kStages = 12;
constexpr int kDigits = 34;

// Steps of a length that is a power of two times the duration, so that no node is rounded. The
// error of the coarser run is below 1e-24.
constexpr long kCount = 64;
constexpr long kLongCount = 256;  // of the Heisenberg problem, ten times as long

template <class Scene>
Vector<Quad, 2 * Scene::kDof> end_point(const BenchmarkTrajectory& trajectory,
                                        long count,
                                        const Progress& progress) {
  constexpr int n = Scene::kDof;
  using System = VelocityConstraints<Scene>;
  const System system{Scene{}};
  Gauss<System, kStages, Quad> stepper(system);
  const std::vector<Quad> start = benchmark_start<Quad>(trajectory);
  State<Quad, n> z{Eigen::Map<const Vector<Quad, 2 * n>>(start.data()),
                   Vector<Quad, 2 * n>::Constant(Quad(0))};
  const StepPlan plan = StepPlan::equal(0, trajectory.duration, count);
  const FlowReport report = flow(stepper, plan, z, [&](long i, const auto&, const auto&) {
    return !progress || progress(static_cast<double>(i) / static_cast<double>(count));
  });
  if (!report.completed()) {
    throw std::runtime_error(
        fmt::format("the reference of {} failed: {}", trajectory.scene, report.reason()));
  }
  return z.value;
}

template <class Scene>
BenchmarkReference compute(const BenchmarkTrajectory& trajectory, const Progress& progress) {
  const long count = trajectory.duration > 10 ? kLongCount : kCount;
  const auto coarse = end_point<Scene>(trajectory, count, part_of(progress, 0, 1.0 / 3));
  const auto fine = end_point<Scene>(trajectory, 2 * count, part_of(progress, 1.0 / 3, 2.0 / 3));
  BenchmarkReference reference;
  for (int i = 0; i < fine.size(); ++i) {
    const Quad difference = abs(Quad(fine[i] - coarse[i]));
    reference.agreement = std::max(reference.agreement, static_cast<double>(difference));
    reference.digits.push_back(fine[i].str(kDigits, std::ios_base::scientific));
  }
  if (!(reference.agreement < kReferenceAgreement)) {
    throw std::runtime_error(fmt::format("two references of {} differ by {:.2g}, allowed {:g}",
                                         trajectory.scene,
                                         reference.agreement,
                                         kReferenceAgreement));
  }
  read_digits(reference);
  return reference;
}

}  // namespace

double BenchmarkReference::error(const double* z) const {
  double norm = 0;
  for (std::size_t i = 0; i < high.size(); ++i) {
    const double difference = std::abs((z[i] - high[i]) - low[i]);
    if (!std::isfinite(difference)) return std::numeric_limits<double>::infinity();
    norm = std::max(norm, difference);
  }
  return norm;
}

void read_digits(BenchmarkReference& reference) {
  reference.high.clear();
  reference.low.clear();
  for (const std::string& text : reference.digits) {
    const Quad value(text);  // throws on what is no number
    if (!isfinite(value)) throw std::runtime_error("a reference is not finite");
    reference.high.push_back(static_cast<double>(value));
    reference.low.push_back(static_cast<double>(value - Quad(reference.high.back())));
  }
}

BenchmarkReference compute_reference(const BenchmarkTrajectory& trajectory,
                                     const Progress& progress) {
  if (trajectory.scene == "vehicle-cosine") {
    return compute<scenes::VehicleCosine>(trajectory, progress);
  }
  if (trajectory.scene == "vehicle") return compute<scenes::Vehicle>(trajectory, progress);
  return compute<scenes::Heisenberg>(trajectory, progress);
}

}  // namespace carnot::apps
