#include "carnot/shooting/problem/mass_ladder.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <utility>

#include "carnot/transcription/transcription_functions.h"

namespace carnot::internal {
namespace {

// A scene whose coordinates have more mass each: what its transcription takes.
struct Heavier {
  Dynamics own;
  std::vector<double> more;  // is added to the diagonal of M
  TranscriptionFunctions transcription;

  static const Heavier& from(const void* opaque) { return *static_cast<const Heavier*>(opaque); }
  [[nodiscard]] const void* system() const { return own.system.get(); }
};

// The scene's own Hessians, which more mass does not change: of one point, or of a pack.
template <auto call>
void heavier_hessian(const void* opaque,
                     const double* q,
                     const double* v,
                     const double* lambda,
                     const GaugeUnits& units,
                     double* l_qq) {
  const Heavier& h = Heavier::from(opaque);
  (h.own.transcription->*call)(h.system(), q, v, lambda, units, l_qq);
}

// The entries of `lanes` points side by side, with more mass each.
template <auto call, int lanes>
void heavier_entries(
    const void* opaque, const double* q, const GaugeUnits& units, bool slopes, double* out) {
  const Heavier& h = Heavier::from(opaque);
  (h.own.transcription->*call)(h.system(), q, units, slopes, out);
  const int length = lanes == 1 ? row_length(h.own.dof) : 1 + h.own.dof;  // of a row with slopes
  const int row = (slopes ? length : 1) * lanes;
  for (std::size_t i = 0; i < h.more.size(); ++i) {
    double* const mass = out + (i * (i + 1) / 2 + i) * row;
    for (int l = 0; l < lanes; ++l) mass[l] += h.more[i];
  }
}

Dynamics heavier(const Dynamics& dynamics, std::vector<double> more) {
  using Functions = TranscriptionFunctions;
  const auto scene =
      std::make_shared<Heavier>(Heavier{dynamics, std::move(more), *dynamics.transcription});
  Functions& calls = scene->transcription;
  calls.entries = heavier_entries<&Functions::entries, 1>;
  calls.hessian = heavier_hessian<&Functions::hessian>;
  if (calls.packed_entries != nullptr) {
    calls.packed_entries = heavier_entries<&Functions::packed_entries, kTranscriptionLanes>;
    calls.packed_hessian = heavier_hessian<&Functions::packed_hessian>;
  }
  Dynamics result = dynamics;
  result.system = scene;
  result.transcription = &scene->transcription;
  result.functions = nullptr;
  result.kernel = {};
  result.calls = {};
  if (dynamics.calls.chart != nullptr) {
    result.calls.chart = [](const void* opaque, const double* q) {
      const Heavier& h = Heavier::from(opaque);
      return h.own.calls.chart(h.system(), q);
    };
  }
  return result;
}

// The masses of coordinates that may move freely; zero for the others, which move with them.
std::vector<double> free_masses(const BoundaryValueProblem& problem) {
  constexpr double kFree = 2;  // times its own mass, what it takes to move
  const Dynamics& dynamics = problem.dynamics;
  const int n = dynamics.dof;
  std::vector<double> entries(entry_count(*dynamics.transcription));
  dynamics.transcription->entries(
      dynamics.system.get(), problem.from.data(), {}, false, entries.data());
  std::vector<double> masses(n, 0.0), p(n, 0.0), velocity(n), lambda(dynamics.multipliers);
  for (int j = 0; j < n; ++j) {
    const double mass = entries[j * (j + 1) / 2 + j];
    p[j] = 1;
    const auto status = dynamics.evaluate(0, problem.from, p, velocity, lambda).status;
    p[j] = 0;
    if (mass > 0 && status == RateStatus::kOk && velocity[j] * kFree * mass > 1) masses[j] = mass;
  }
  return masses;
}

}  // namespace

MassLadder::MassLadder(const BoundaryValueProblem& problem) : problem_(problem) {
  // Of 140 random targets of a vehicle (alpha and beta log-uniform, beta from 1e-4 to 100) 14 are
  // missed or not solved in 230 s without a ladder; with one below 0.0125, 0.05 and 0.2 one, two
  // and two of them are, in 98, 86 and 84 s. A car with a trailer and a mass of 0.065 in its
  // steering, which the coordinates end beside, has more least actions missed with a ladder (4 of
  // 25, not 2); with 0.0065 ten are not solved without one and none with it.
  constexpr double kLight = 0.05;
  constexpr int kHighest = 8;  // at the foot there are 256 times the intervals
  const TranscriptionFunctions* transcription = problem.dynamics.transcription;
  if (transcription == nullptr || transcription->gauge) return;
  masses_ = free_masses(problem);
  for (const double mass : masses_) {
    if (mass > 0) lightest_ = std::min(lightest_, mass);
  }
  if (lightest_ > kLight) return;
  while (least_on(height()) < 1 && height() < kHighest) {
    heavier_.push_back(with_masses_from(least_on(height() + 1)));
  }
}

double MassLadder::least_on(double rung) const {
  return std::min(1.0, lightest_ * std::pow(4, rung));
}

BoundaryValueProblem MassLadder::with_masses_from(double least) const {
  std::vector<double> more(masses_.size(), 0.0);
  for (std::size_t j = 0; j < masses_.size(); ++j) {
    if (masses_[j] > 0) more[j] = std::max(0.0, least - masses_[j]);
  }
  BoundaryValueProblem result = problem_;
  result.dynamics = heavier(problem_.dynamics, std::move(more));
  return result;
}

BoundaryValueProblem MassLadder::below(int rung, double share) const {
  return with_masses_from(least_on(rung - share));
}

int MassLadder::rung_for(int intervals) const {
  constexpr int kCoarse = 16;  // intervals that are enough for a mass of one
  const double rungs = std::ceil(std::log2(kCoarse / (intervals * std::sqrt(lightest_))));
  return std::clamp(static_cast<int>(rungs), 0, height());
}

int MassLadder::rung_of(int start, int intervals) const {
  if (height() == 0) return 0;
  // Heavier problems have fewer extremals, so some begin on the problem itself. Of 40 targets with
  // light steering five are missed where all start at the top, two where all start one rung lower,
  // and none where these and the problem itself take turns. Starts vary by threes in other ways
  // (starts.cc), so the turns are moved by one after three of them.
  const int turn = (start + start / 3) % 3;
  if (turn == 2) return 0;
  return std::max(0, rung_for(intervals) - turn);
}

}  // namespace carnot::internal
