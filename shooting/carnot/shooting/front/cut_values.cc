#include "carnot/shooting/front/cut_values.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "carnot/numerics/parallel.h"
#include "carnot/shooting/cut_time.h"
#include "carnot/shooting/rays/conjugate_time.h"

namespace carnot::internal {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kNear = 0.5;       // of |p|: another partner is meant
constexpr double kSameTime = 1e-9;  // relative: both are the same but for round-off

double apart(const std::vector<double>& a, const std::vector<double>& b) {
  double sum = 0;
  for (std::size_t j = 0; j < a.size(); ++j) sum += (a[j] - b[j]) * (a[j] - b[j]);
  return std::sqrt(sum);
}

double size_of(const std::vector<double>& p) {
  return apart(p, std::vector<double>(p.size(), 0.0));
}

}  // namespace

bool CutValues::go_on() {
  if (!stopped_ && options_.progress && !options_.progress(0)) stopped_ = true;
  return !stopped_;
}

CutValue CutValues::searched(const std::vector<double>& p) {
  CutTimeOptions search;
  search.max_time = options_.horizon;
  search.mod_angles = options_.mod_angles;
  search.seed = options_.seed;
  search.threads = 1;
  search.progress = [this](double) { return go_on(); };
  const CutTime cut = cut_time(dynamics_, from_, p, search);
  ++searches_;
  CutValue value;
  value.known = cut.status == CutStatus::kConverged;
  value.t = cut.cut_time.value_or(kInfinity);
  value.conjugate = cut.conjugate_time.value_or(kInfinity);
  value.at_conjugate = cut.cut_time && !cut.partner_p0;
  if (!cut.partner_p0) return value;
  const auto n = p.size();
  value.partner = {*cut.partner_p0, std::vector<double>(n, 0.0), value.t};
  const Ray own(dynamics_, from_, p);
  const Ray other(dynamics_, from_, *cut.partner_p0);
  const long steps = own.enough_steps(value.t);
  const std::vector<double> a = own.at(value.t, steps);
  const std::vector<double> b = other.at(value.t, steps);
  for (std::size_t j = 0; j < n && !a.empty() && !b.empty(); ++j) {
    const double period = dynamics_.info.configuration[j].period;
    if (period > 0) value.partner.offset[j] = period * std::round((b[j] - a[j]) / period);
  }
  return value;
}

// Takes the rival of the ray from p to that from `to`, in as many steps as Newton's method needs.
bool CutValues::follow(const std::vector<double>& p,
                       const std::vector<double>& to,
                       int halvings,
                       Rival& rival) const {
  const Ray ray(dynamics_, from_, to);
  Rival next = rival;
  if (polish_meeting(ray, ray.enough_steps(rival.t), next) && next.t > 0 &&
      apart(next.p, rival.p) <= kNear * size_of(p)) {
    rival = std::move(next);
    return true;
  }
  if (halvings == 0) return false;
  std::vector<double> middle = p;
  for (std::size_t j = 0; j < p.size(); ++j) middle[j] = 0.5 * (p[j] + to[j]);
  const double speed = speed_of(dynamics_, from_, middle);
  for (double& x : middle) x /= speed;
  return follow(p, middle, halvings - 1, rival) && follow(middle, to, halvings - 1, rival);
}

// Whether the partner of ray j leads to one of this ray that is met before value.t.
bool CutValues::meets(const Ray& ray, int j, int halvings, CutValue& value) const {
  const CutValue& neighbour = values_[j];
  if (!neighbour.known || neighbour.at_conjugate || std::isinf(neighbour.t)) return false;
  Rival rival = neighbour.partner;
  rival.t = neighbour.t;
  if (!follow(momenta_[j], ray.p(), halvings, rival)) return false;
  const long steps = ray.enough_steps(rival.t);
  if (rival.t > (1 + kSameTime) * value.conjugate || !(rival.t < (1 - kSameTime) * value.t)) {
    return false;
  }
  if (same_path(ray, rival, steps)) return false;
  value.known = true;
  value.t = rival.t;
  value.at_conjugate = false;
  value.partner = std::move(rival);
  return true;
}

CutValue CutValues::from_neighbours(const std::vector<double>& p,
                                    double conjugate,
                                    const std::vector<int>& neighbours) {
  constexpr int kHalvings = 4;
  constexpr double kSamePartner = 0.3;  // of |p|: its neighbours lead to the same one
  CutValue value;
  value.t = kInfinity;
  value.conjugate = conjugate;
  const Ray own(dynamics_, from_, p);
  bool beside_conjugate = false;
  bool near_edge = false;  // a neighbour and its partner are neighbours
  bool beside_none = false;
  for (const int j : neighbours) {
    const CutValue& neighbour = values_[j];
    if (!neighbour.known) continue;
    beside_conjugate = beside_conjugate || neighbour.at_conjugate;
    near_edge = near_edge || (!neighbour.at_conjugate && std::isfinite(neighbour.t) &&
                              apart(neighbour.partner.p, p) < kNear * size_of(p));
    beside_none = beside_none || std::isinf(neighbour.t);
    const bool same = value.known && value.partner.offset == neighbour.partner.offset &&
                      apart(value.partner.p, neighbour.partner.p) < kSamePartner * size_of(p);
    if (!same) (void)meets(own, j, kHalvings, value);
  }
  if (value.known) return value;
  if (near_edge && std::isfinite(conjugate)) {
    if (auto meeting = meet_neighbours(own, conjugate)) {
      value.known = true;
      value.t = meeting->rival.t;
      value.partner = std::move(meeting->rival);
      return value;
    }
    return searched(p);
  }
  // Where a neighbour has none up to the horizon, so has this one, unless it is conjugate before.
  if (!(beside_none && std::isinf(conjugate)) && (!beside_conjugate || std::isinf(conjugate))) {
    return searched(p);
  }
  value.known = true;
  if (std::isinf(conjugate)) return value;
  value.at_conjugate = true;
  value.t = conjugate;
  return value;
}

bool CutValues::add_between(const std::vector<std::vector<double>>& momenta,
                            const std::vector<std::pair<int, int>>& parents) {
  const std::size_t first = values_.size();
  std::vector<CutValue> made(momenta.size());
  parallel_for(static_cast<int>(momenta.size()), thread_count(options_.threads), [&](int i) {
    if (!go_on()) return;
    const double conjugate = conjugate_time(Ray(dynamics_, from_, momenta[i]), options_.horizon);
    made[i] = from_neighbours(momenta[i], conjugate, {parents[i].first, parents[i].second});
  });
  momenta_.insert(momenta_.end(), momenta.begin(), momenta.end());
  values_.resize(first);
  values_.insert(values_.end(), made.begin(), made.end());
  return !stopped_;
}

void CutValues::add_partners(const std::vector<int>& of) {
  for (const int i : of) {
    CutValue value = values_[i];
    const std::vector<double> p = value.partner.p;
    value.partner.p = momenta_[i];
    for (double& x : value.partner.offset) x = -x;
    value.conjugate = conjugate_time(Ray(dynamics_, from_, p), options_.horizon);
    momenta_.push_back(p);
    values_.push_back(std::move(value));
  }
}

CutValue CutValues::beside(const std::vector<double>& p, int i) {
  const double conjugate = conjugate_time(Ray(dynamics_, from_, p), options_.horizon);
  return from_neighbours(p, conjugate, {i});
}

bool CutValues::add(const std::vector<std::vector<double>>& momenta,
                    const std::vector<std::vector<int>>& neighbours) {
  constexpr int kMostSeeds = 12;
  constexpr int kFewestSeeds = 4;  // of a curve
  constexpr int kShare = 16;
  const int count = static_cast<int>(momenta.size());
  const int seeds = std::min(count, std::clamp(count / kShare, kFewestSeeds, kMostSeeds));
  momenta_ = momenta;
  values_.assign(momenta.size(), {});
  const int threads = thread_count(options_.threads);
  parallel_for(count, threads, [&](int i) {
    if (go_on()) values_[i].conjugate = conjugate_time(ray(i), options_.horizon);
  });
  parallel_for(seeds, threads, [&](int k) {
    // The golden section spreads them over both coordinates of the mesh.
    const double place = std::fmod(0.5 + 0.6180339887498949 * k, 1.0);
    const auto i = static_cast<int>(place * count);
    if (go_on()) values_[i] = searched(momenta_[i]);
  });
  return spread(neighbours) && relax(neighbours);
}

// From what is known to its neighbours, layer by layer.
bool CutValues::spread(const std::vector<std::vector<int>>& neighbours) {
  const int count = static_cast<int>(values_.size());
  for (;;) {
    std::vector<int> layer;
    for (int i = 0; i < count; ++i) {
      const auto known = [&](int j) { return values_[j].known; };
      if (!known(i) && std::any_of(neighbours[i].begin(), neighbours[i].end(), known)) {
        layer.push_back(i);
      }
    }
    if (layer.empty()) return !stopped_;
    std::vector<CutValue> made(layer.size());
    parallel_for(static_cast<int>(layer.size()), thread_count(options_.threads), [&](int k) {
      const int i = layer[k];
      if (!go_on()) return;
      made[k] = from_neighbours(momenta_[i], values_[i].conjugate, neighbours[i]);
      made[k].known = true;  // or it would be tried for ever; t is then infinite
    });
    if (stopped_) return false;
    for (std::size_t k = 0; k < layer.size(); ++k) values_[layer[k]] = std::move(made[k]);
  }
}

// Whether a neighbour has another kind of partner, which is met earlier.
bool CutValues::improve(int i, const std::vector<int>& neighbours, CutValue& value) const {
  constexpr double kSamePartner = 0.3;
  const Ray own = ray(i);
  bool better = false;
  for (const int j : neighbours) {
    const CutValue& neighbour = values_[j];
    const bool same =
        !value.at_conjugate && std::isfinite(value.t) && !neighbour.at_conjugate &&
        value.partner.offset == neighbour.partner.offset &&
        apart(value.partner.p, neighbour.partner.p) < kSamePartner * size_of(momenta_[i]);
    if (!same && meets(own, j, 1, value)) better = true;
  }
  return better;
}

bool CutValues::relax(const std::vector<std::vector<int>>& neighbours) {
  constexpr int kRounds = 200;
  const int count = static_cast<int>(values_.size());
  std::vector<char> news(count, 1);
  for (int round = 0; round < kRounds; ++round) {
    std::vector<CutValue> next = values_;
    std::vector<char> changed(count, 0);
    parallel_for(count, thread_count(options_.threads), [&](int i) {
      const auto told = [&](int j) { return news[j] != 0; };
      if (!std::any_of(neighbours[i].begin(), neighbours[i].end(), told) || !go_on()) return;
      changed[i] = improve(i, neighbours[i], next[i]) ? 1 : 0;
    });
    if (stopped_) return false;
    values_ = std::move(next);
    news = changed;
    if (std::none_of(news.begin(), news.end(), [](char x) { return x != 0; })) break;
  }
  return true;
}

int CutValues::check(int count, const std::vector<std::vector<int>>& neighbours) {
  const int all = static_cast<int>(values_.size());
  count = std::min(count, all);
  std::vector<CutValue> found(count);
  std::vector<int> which(count);
  parallel_for(count, thread_count(options_.threads), [&](int k) {
    which[k] = static_cast<int>(std::fmod(0.25 + 0.7548776662466927 * k, 1.0) * all);
    if (go_on()) found[k] = searched(momenta_[which[k]]);
  });
  int lower = 0;
  for (int k = 0; k < count && !stopped_; ++k) {
    CutValue& value = values_[which[k]];
    if (!found[k].known || !(found[k].t < (1 - 1e-8) * value.t)) continue;
    value = found[k];
    ++lower;
  }
  if (lower > 0) (void)relax(neighbours);
  return lower;
}

}  // namespace carnot::internal
