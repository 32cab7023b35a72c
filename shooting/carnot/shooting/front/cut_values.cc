#include "carnot/shooting/front/cut_values.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <utility>

#include "carnot/numerics/parallel.h"
#include "carnot/shooting/cut_time.h"
#include "carnot/shooting/linear/norm.h"
#include "carnot/shooting/rays/conjugate_time.h"

namespace carnot::internal {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kNear = 0.5;       // of |p|: another partner is meant
constexpr double kSameTime = 1e-9;  // relative: both are the same but for round-off

bool same_kind(const Rival& a, const Rival& b) {
  return a.offset == b.offset && a.signs == b.signs;
}

bool has_partner(const CutValue& value) { return value.known && !value.partner.p.empty(); }

}  // namespace

long CutValues::unknown(double from) const {
  return std::count_if(values_.begin(), values_.end(), [&](const CutValue& value) {
    return !value.known && value.t >= from;
  });
}

bool CutValues::go_on() {
  if (!stopped_ && options_.progress && !options_.progress(0)) stopped_ = true;
  return !stopped_;
}

CutValue CutValues::searched(const std::vector<double>& p) {
  CutTimeOptions search;
  search.max_time = options_.horizon;
  search.mod_angles = options_.mod_angles;
  search.signs = options_.signs;
  search.seed = options_.seed;
  search.threads = 1;
  search.progress = [this](double) { return go_on(); };
  const CutTime cut = cut_time(dynamics_, from_, p, search);
  ++searches_;
  CutValue value;
  value.known = cut.status == CutStatus::kConverged;
  value.conjugate = cut.conjugate_time.value_or(kInfinity);
  value.t = cut.cut_time.value_or(value.conjugate);
  value.at_conjugate = cut.cut_time && !cut.partner_p0;
  if (!cut.partner_p0) return value;
  const auto n = p.size();
  value.partner = {*cut.partner_p0, std::vector<double>(n, 0.0), value.t};
  const Ray own(dynamics_, from_, p);
  const Ray other(dynamics_, from_, *cut.partner_p0);
  const long steps = own.enough_steps(value.t);
  const std::vector<double> a = own.at(value.t, steps);
  const std::vector<double> b = other.at(value.t, steps);
  if (a.empty() || b.empty()) return value;
  // The partner ends at S a + offset, with whole turns in the offset; which S, is where it is so.
  double closest = kInfinity;
  for (const std::vector<double>& signs : {std::vector<double>{}, options_.signs}) {
    std::vector<double> offset(n, 0.0);
    double distance = 0;
    for (std::size_t j = 0; j < n; ++j) {
      const double period = dynamics_.info.configuration[j].period;
      const double difference = b[j] - (signs.empty() ? a[j] : signs[j] * a[j]);
      if (period > 0) offset[j] = period * std::round(difference / period);
      distance += std::abs(difference - offset[j]);
    }
    if (!(distance < closest)) continue;
    closest = distance;
    value.partner.offset = std::move(offset);
    value.partner.signs = signs;
  }
  return value;
}

// How far apart two momenta are, in directions and relative to their place on the line.
double CutValues::turned(const std::vector<double>& a, const std::vector<double>& b) const {
  const UnitMomentum one = all_momenta_.place(a);
  const UnitMomentum other = all_momenta_.place(b);
  const double along = one.w.norm() + other.w.norm();
  return (one.c - other.c).norm() + (along > 0 ? 2 * (one.w - other.w).norm() / along : 0);
}

// Near the edge of the cut locus the equations of a meeting are badly conditioned. Both rays are
// neighbours there, and nearly conjugate: times differ like the square of the angle. Beside an
// abnormal extremal neighbours may meet long before they are conjugate, and nothing is wrong with
// that. On Martinet's sphere conjugate times are 1.46 of the times of meetings there, and without
// this difference ten times as many rays had to be searched.
bool CutValues::is_at_edge(const std::vector<double>& p,
                           const std::vector<double>& partner,
                           double t,
                           double conjugate) const {
  constexpr double kEdge = 0.1;
  constexpr double kConjugate = 1.1;
  return turned(p, partner) < kEdge && conjugate < kConjugate * t;
}

Rival CutValues::moved(const Way& from, const Way& to, const Rival& rival) const {
  Rival guess = rival;
  if (std::isfinite(from.conjugate) && std::isfinite(to.conjugate)) {
    guess.t *= to.conjugate / from.conjugate;
  }
  if (!all_momenta_.has_line()) return guess;
  const Eigen::Vector2d w = all_momenta_.place(from.p).w;
  const Eigen::Vector2d change = all_momenta_.place(to.p).w - w;
  UnitMomentum place = all_momenta_.place(rival.p);
  for (int k = 0; k < all_momenta_.lines(); ++k) {
    place.w[k] += std::copysign(1.0, w[k] * place.w[k]) * change[k];
  }
  guess.p = all_momenta_.momentum(place);
  return guess;
}

// Takes the rival of a ray to another one, in as many steps as Newton's method needs.
bool CutValues::follow(const Way& from, const Way& to, int halvings, Rival& rival) const {
  constexpr double kItself = 1e-6;  // of |p|: the ray is a rival of its own, which is not meant
  constexpr double kSooner = 0.5;   // of the time: what is carried to before that is far away
  const Ray ray(dynamics_, from_, to.p);
  const double size = norm(from.p);
  const auto leads = [&](const Rival& guess) {
    Rival next = guess;
    if (!polish_meeting(ray, ray.enough_steps(guess.t), next) || !(next.t > 0) ||
        distance(next.p, guess.p) > kNear * size || distance(next.p, to.p) <= kItself * size) {
      return false;
    }
    rival = std::move(next);
    return true;
  };
  if (leads(moved(from, to, rival))) return true;
  const Ray before(dynamics_, from_, from.p);
  const auto first = carried(before, rival, to.p, before.enough_steps(rival.t));
  if (first && distance(first->p, rival.p) <= kNear * size && first->t > kSooner * rival.t &&
      leads(*first)) {
    return true;
  }
  if (halvings == 0) return false;
  Way middle{from.p, 0.5 * (from.conjugate + to.conjugate)};
  for (std::size_t j = 0; j < middle.p.size(); ++j) middle.p[j] = 0.5 * (from.p[j] + to.p[j]);
  const double speed = speed_of(dynamics_, from_, middle.p);
  for (double& x : middle.p) x /= speed;
  return follow(from, middle, halvings - 1, rival) && follow(middle, to, halvings - 1, rival);
}

CutValues::Led CutValues::lead(const Ray& ray,
                               const Neighbour& neighbour,
                               int halvings,
                               AtEdge at_edge,
                               CutValue& value) const {
  const CutValue& its = *neighbour.value;
  const auto is_left = [&](const std::vector<double>& p, const Rival& rival, double conjugate) {
    return at_edge == AtEdge::kLeft && is_at_edge(p, rival.p, rival.t, conjugate);
  };
  Rival rival = its.partner;
  rival.t = its.t;
  if (is_left(*neighbour.p, rival, its.conjugate)) return Led::kNowhere;
  const Way from{*neighbour.p, its.conjugate};
  if (!follow(from, {ray.p(), value.conjugate}, halvings, rival)) return Led::kNowhere;
  const long steps = ray.enough_steps(rival.t);
  if (rival.t > options_.horizon || rival.t > (1 + kSameTime) * value.conjugate ||
      !(rival.t < (1 - kSameTime) * value.t)) {
    return Led::kLater;
  }
  if (is_left(ray.p(), rival, value.conjugate)) return Led::kNowhere;
  if (same_path(ray, rival, steps)) return Led::kNowhere;
  value.known = true;
  value.t = rival.t;
  value.at_conjugate = false;
  value.partner = std::move(rival);
  return Led::kEarlier;
}

CutValue CutValues::led_to(const std::vector<double>& p,
                           double conjugate,
                           const std::vector<Neighbour>& neighbours) const {
  constexpr int kHalvings = 4;
  constexpr double kNeighbours = 0.9;   // what is turned by less may be met as a neighbour,
  constexpr double kBefore = 1.3;       // where that is so long before the conjugate time
  constexpr double kSamePartner = 0.3;  // of |p|: its neighbours lead to the same one
  CutValue value;
  value.t = kInfinity;
  value.conjugate = conjugate;
  const Ray own(dynamics_, from_, p);
  bool beside_conjugate = false;
  double near_edge = 0;  // how far a neighbour and its partner are apart, where they are neighbours
  bool beside_none = false;
  bool later = false;    // some neighbour leads to what is too late to count,
  bool nowhere = false;  // or nowhere
  for (const Neighbour& neighbour : neighbours) {
    const CutValue& its = *neighbour.value;
    if (!its.known) continue;
    beside_conjugate = beside_conjugate || its.at_conjugate;
    beside_none = beside_none || std::isinf(its.t);
    if (!has_partner(its)) continue;
    if (its.conjugate < kBefore * its.t && turned(*neighbour.p, its.partner.p) < kNeighbours) {
      near_edge = distance(its.partner.p, *neighbour.p);
    }
    const bool same = value.known && same_kind(value.partner, its.partner) &&
                      distance(value.partner.p, its.partner.p) < kSamePartner * norm(p);
    if (same) continue;
    const Led led = lead(own, neighbour, kHalvings, AtEdge::kLeft, value);
    later = later || led == Led::kLater;
    nowhere = nowhere || led == Led::kNowhere;
  }
  if (value.known) return value;
  // But for abnormal extremals cut times have no jumps. So where all that is known nearby is too
  // late to count, the ray has no cut before it is conjugate, other than with its neighbours.
  const bool nothing_before = (later || beside_none) && !nowhere;
  const bool at_border = beside_conjugate && (later || nowhere);  // of what is cut where conjugate
  if (std::isinf(conjugate)) {
    value.known = beside_none || nothing_before;
    return value;
  }
  if (near_edge > 0 || nothing_before || at_border) {
    if (auto meeting = meet_neighbours(own, conjugate, near_edge)) {
      value.known = true;
      value.t = meeting->rival.t;
      value.partner = std::move(meeting->rival);
      return value;
    }
  }
  if (near_edge > 0) {
    for (const Neighbour& neighbour : neighbours) {
      if (has_partner(*neighbour.value))
        (void)lead(own, neighbour, kHalvings, AtEdge::kAllowed, value);
    }
    return value;
  }
  value.known = value.at_conjugate = beside_conjugate;
  if (value.known) value.t = conjugate;
  return value;
}

std::vector<CutValues::Neighbour> CutValues::those(const std::vector<int>& neighbours) const {
  std::vector<Neighbour> list;
  list.reserve(neighbours.size());
  for (const int j : neighbours) list.push_back(neighbour(j));
  return list;
}

CutValue CutValues::led_to_or_searched(const std::vector<double>& p,
                                       double conjugate,
                                       const std::vector<Neighbour>& neighbours) {
  CutValue value = led_to(p, conjugate, neighbours);
  return value.known ? value : searched(p);
}

bool CutValues::add_between(const std::vector<std::vector<double>>& momenta,
                            const std::vector<std::pair<int, int>>& parents,
                            std::vector<CutValue> found) {
  found.resize(momenta.size());
  parallel_for(static_cast<int>(momenta.size()), thread_count(options_.threads), [&](int i) {
    if (found[i].known || !go_on()) return;
    const double conjugate = conjugate_time(Ray(dynamics_, from_, momenta[i]), options_.horizon);
    found[i] =
        led_to_or_searched(momenta[i], conjugate, those({parents[i].first, parents[i].second}));
  });
  momenta_.insert(momenta_.end(), momenta.begin(), momenta.end());
  values_.insert(values_.end(), found.begin(), found.end());
  return !stopped_;
}

void CutValues::add_partners(const std::vector<int>& of) {
  for (const int i : of) {
    CutValue value = values_[i];
    const std::vector<double> p = value.partner.p;
    value.partner.p = momenta_[i];
    for (std::size_t j = 0; j < p.size(); ++j) {
      const double sign = value.partner.signs.empty() ? 1 : value.partner.signs[j];
      value.partner.offset[j] *= -sign;
    }
    value.conjugate = conjugate_time(Ray(dynamics_, from_, p), options_.horizon);
    momenta_.push_back(p);
    values_.push_back(std::move(value));
  }
}

CutValue CutValues::beside(const std::vector<double>& p, const CutRay& a, const CutRay& b) {
  const double conjugate = conjugate_time(Ray(dynamics_, from_, p), options_.horizon);
  // One that has none up to the horizon tells less than one that has.
  std::vector<Neighbour> neighbours;
  for (const CutRay* one : {&a, &b}) {
    if (std::isfinite(one->value.t)) neighbours.push_back({&one->p, &one->value});
  }
  if (neighbours.empty()) neighbours.push_back({&a.p, &a.value});
  return led_to_or_searched(p, conjugate, neighbours);
}

bool CutValues::add(const std::vector<std::vector<double>>& momenta,
                    const std::vector<std::vector<int>>& neighbours,
                    const std::vector<int>& seeds,
                    int checked) {
  constexpr int kRounds = 3;
  const int count = static_cast<int>(momenta.size());
  momenta_ = momenta;
  values_.assign(momenta.size(), {});
  given_up_.assign(momenta.size(), 0);
  parallel_for(count, thread_count(options_.threads), [&](int i) {
    if (go_on()) values_[i].conjugate = conjugate_time(ray(i), options_.horizon);
  });
  if (!search_some(seeds) || !spread(neighbours) || !relax(neighbours)) return false;
  for (int round = 0; round < kRounds && check(checked, neighbours, seeds) > 0;) ++round;
  return go_on();
}

std::optional<std::vector<CutValue>> CutValues::of_mesh(
    const std::vector<std::vector<double>>& momenta,
    const std::vector<std::vector<int>>& neighbours,
    int checked) {
  std::vector<int> number(momenta.size(), -1);
  std::vector<std::vector<double>> used;
  for (std::size_t i = 0; i < momenta.size(); ++i) {
    if (neighbours[i].empty()) continue;
    number[i] = static_cast<int>(used.size());
    used.push_back(momenta[i]);
  }
  std::vector<std::vector<int>> beside;
  for (const std::vector<int>& list : neighbours) {
    if (list.empty()) continue;
    std::vector<int>& numbers = beside.emplace_back();
    for (const int j : list) numbers.push_back(number[j]);
  }
  std::vector<int> all(used.size());
  std::iota(all.begin(), all.end(), 0);
  if (!add(used, beside, all, checked)) return std::nullopt;
  CutValue none;
  none.t = std::nan("");
  none.conjugate = std::nan("");
  std::vector<CutValue> values(momenta.size(), none);
  for (std::size_t i = 0; i < momenta.size(); ++i) {
    if (number[i] >= 0) values[i] = values_[number[i]];
  }
  return values;
}

// A few of these, spread evenly.
bool CutValues::search_some(const std::vector<int>& of) {
  constexpr int kMost = 12;
  constexpr int kFewest = 4;  // of a curve
  constexpr int kShare = 16;
  const int count = static_cast<int>(of.size());
  const int some = std::min(count, std::clamp(count / kShare, kFewest, kMost));
  parallel_for(some, thread_count(options_.threads), [&](int k) {
    // The golden section spreads them over both coordinates of the mesh.
    const double place = std::fmod(0.5 + 0.6180339887498949 * k, 1.0);
    const int i = of[static_cast<int>(place * count)];
    if (!go_on()) return;
    values_[i] = searched(momenta_[i]);
    given_up_[i] = values_[i].known ? 0 : 1;
  });
  return !stopped_;
}

// From what is known to its neighbours, layer by layer; where this leads no further a few are
// searched, and also in a part of the mesh that borders on nothing known.
bool CutValues::spread(const std::vector<std::vector<int>>& neighbours) {
  const int count = static_cast<int>(values_.size());
  std::vector<long> tried(count, 0);  // with so many known neighbours
  for (;;) {
    std::vector<int> rest;    // may be searched,
    std::vector<int> border;  // of these, is beside what is known
    std::vector<int> layer;
    for (int i = 0; i < count; ++i) {
      if (values_[i].known) continue;
      const auto known = [&](int j) { return values_[j].known; };
      const auto helpers = std::count_if(neighbours[i].begin(), neighbours[i].end(), known);
      if (given_up_[i] == 0) rest.push_back(i);
      if (given_up_[i] == 0 && helpers > 0) border.push_back(i);
      if (helpers > tried[i]) layer.push_back(i);
      tried[i] = helpers;
    }
    if (layer.empty() && rest.empty()) break;
    if (layer.empty() && !search_some(border.empty() ? rest : border)) return false;
    std::vector<CutValue> made(layer.size());
    parallel_for(static_cast<int>(layer.size()), thread_count(options_.threads), [&](int k) {
      const int i = layer[k];
      if (go_on()) made[k] = led_to(momenta_[i], values_[i].conjugate, those(neighbours[i]));
    });
    if (stopped_) return false;
    for (std::size_t k = 0; k < layer.size(); ++k) values_[layer[k]] = std::move(made[k]);
  }
  for (CutValue& value : values_) {
    if (!value.known) value.t = value.conjugate;
  }
  return !stopped_;
}

// Whether a neighbour has another kind of partner, which is met earlier.
bool CutValues::improve(int i, const std::vector<int>& neighbours, CutValue& value) const {
  constexpr double kSamePartner = 0.3;
  const Ray own = ray(i);
  bool better = false;
  for (const int j : neighbours) {
    const CutValue& neighbour = values_[j];
    if (!has_partner(neighbour)) continue;
    const bool same =
        has_partner(value) && same_kind(value.partner, neighbour.partner) &&
        distance(value.partner.p, neighbour.partner.p) < kSamePartner * norm(momenta_[i]);
    if (same) continue;
    const Led led = lead(own, this->neighbour(j), 1, AtEdge::kLeft, value);
    better = better || led == Led::kEarlier;
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

int CutValues::check(int count,
                     const std::vector<std::vector<int>>& neighbours,
                     const std::vector<int>& of) {
  const auto all = static_cast<int>(of.size());
  count = std::min(count, all);
  std::vector<CutValue> found(count);
  std::vector<int> which(count);
  parallel_for(count, thread_count(options_.threads), [&](int k) {
    which[k] = of[static_cast<int>(std::fmod(0.25 + 0.7548776662466927 * k, 1.0) * all)];
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
