#include "carnot/shooting/front/caustic_lines.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <utility>

#include "carnot/numerics/parallel.h"
#include "carnot/shooting/linear/illinois.h"

namespace carnot::internal {
namespace {

double dot(const std::vector<double>& a, const std::vector<double>& b) {
  double sum = 0;
  for (std::size_t j = 0; j < a.size(); ++j) sum += a[j] * b[j];
  return sum;
}

class Lines {
 public:
  explicit Lines(const CausticRequest& request) : request_(request) {}

  CausticLines run() {
    CausticLines lines;
    const int count = static_cast<int>(request_.surface.vertices.size());
    forms_.resize(count);
    parallel_for(count, thread_count(request_.threads), [&](int i) {
      if (!(request_.times[i] <= request_.length) || !request_.go_on()) return;
      forms_[i] = form_at(request_.surface.vertices[i].place, request_.times[i]);
    });
    if (!request_.go_on()) return lines;
    find_umbilics(lines.umbilics);
    find_cusps(lines.cusps);
    for (const CuspLine& line : lines.cusps) find_swallowtails(line, lines.swallowtails);
    lead_to_umbilics(lines.umbilics, lines.cusps);
    lines.finished = request_.go_on();
    return lines;
  }

 private:
  [[nodiscard]] std::optional<CausticForm> form_at(const UnitMomentum& at, double t) const {
    return caustic_form(request_.dynamics, request_.from, request_.momenta, at, t);
  }

  void find_umbilics(std::vector<Umbilic>& umbilics) const {
    constexpr double kNear = 1e-6;  // of momenta and times: the same umbilic
    const auto neighbours = request_.surface.neighbours();
    for (std::size_t i = 0; i < forms_.size() && request_.go_on(); ++i) {
      if (!forms_[i]) continue;
      const auto is_nearer = [&](int j) {
        return forms_[j] && forms_[j]->other < forms_[i]->other;
      };
      if (std::any_of(neighbours[i].begin(), neighbours[i].end(), is_nearer)) continue;
      const auto found = find_umbilic(
          request_.dynamics, request_.from, request_.momenta, forms_[i]->at, forms_[i]->t);
      if (!found || !(found->t <= request_.length)) continue;
      // Of the order that is asked for, and not another one.
      const double conjugate = request_.conjugate_time(found->at);
      if (!(std::abs(conjugate - found->t) <= kNear * found->t)) continue;
      const bool known = std::any_of(umbilics.begin(), umbilics.end(), [&](const Umbilic& other) {
        return (other.at.c - found->at.c).norm() <= kNear &&
               (other.at.w - found->at.w).norm() <= kNear * (1 + other.at.w.norm());
      });
      if (!known) umbilics.push_back(*found);
    }
  }

  // C at both ends of an edge, for kernels of one side; or nothing where they do not tell.
  [[nodiscard]] std::optional<std::pair<double, double>> cubics(const CausticForm& a,
                                                                const CausticForm& b) const {
    constexpr double kAlike = 0.3;  // cosine of the angle between two kernels
    const double along = dot(a.kernel_momenta, b.kernel_momenta);
    const double size = std::sqrt(dot(a.kernel_momenta, a.kernel_momenta) *
                                  dot(b.kernel_momenta, b.kernel_momenta));
    if (!(std::abs(along) > kAlike * size)) return std::nullopt;
    return std::pair{a.cubic, along > 0 ? b.cubic : -b.cubic};
  }

  // The place on the edge where C vanishes.
  [[nodiscard]] CausticPoint locate(int a, int b, double at_a, double at_b) const {
    constexpr double kEnough = 1e-9;  // of the edge; C is good to 1e-10
    const UnitMomentum& first = request_.surface.vertices[a].place;
    const UnitMomentum& second = request_.surface.vertices[b].place;
    CausticPoint point;
    const auto cubic_at = [&](double part) -> std::optional<double> {
      point.at = between(first, second, part);
      point.t = request_.conjugate_time(point.at);
      if (!std::isfinite(point.t)) return std::nullopt;
      const auto form = form_at(point.at, point.t);
      if (!form) return std::nullopt;
      const auto values = cubics(*forms_[a], *form);
      return values ? std::optional(values->second) : std::nullopt;
    };
    (void)illinois(0, at_a, 1, at_b, kEnough, cubic_at);
    return point;
  }

  void find_cusps(std::vector<CuspLine>& cusps) {
    struct Crossing {
      Edge edge;
      std::pair<double, double> values;
    };
    std::map<Edge, int> number;
    std::vector<Crossing> crossings;
    const auto look_at = [&](int a, int b) {
      const Edge edge = edge_of(a, b);
      const auto [found, is_new] = number.emplace(edge, -1);
      if (!is_new || !forms_[edge.first] || !forms_[edge.second]) return;
      const auto values = cubics(*forms_[edge.first], *forms_[edge.second]);
      if (!values || values->first * values->second > 0) return;
      found->second = static_cast<int>(crossings.size());
      crossings.push_back({edge, *values});
    };
    for (const auto& t : request_.surface.triangles) {
      for (int k = 0; k < 3; ++k) look_at(t[k], t[(k + 1) % 3]);
    }
    std::vector<CausticPoint> points(crossings.size());
    parallel_for(static_cast<int>(crossings.size()), thread_count(request_.threads), [&](int i) {
      const auto& [edge, values] = crossings[i];
      if (!request_.go_on()) return;
      points[i] = locate(edge.first, edge.second, values.first, values.second);
    });
    std::vector<std::vector<int>> next(points.size());
    for (const auto& t : request_.surface.triangles) {
      std::vector<int> met;
      for (int k = 0; k < 3; ++k) {
        const int i = number.at(edge_of(t[k], t[(k + 1) % 3]));
        if (i >= 0) met.push_back(i);
      }
      if (met.size() != 2) continue;
      next[met[0]].push_back(met[1]);
      next[met[1]].push_back(met[0]);
    }
    chain(points, next, cusps);
  }

  // Where D changes its sign between two points of the line.
  void find_swallowtails(const CuspLine& line, std::vector<Swallowtail>& swallowtails) const {
    constexpr double kAway = 2;     // distances of the two points
    constexpr double kSame = 1e-4;  // found by another piece of a line
    const int count = static_cast<int>(line.points.size());
    std::vector<double> along(count);
    parallel_for(count, thread_count(request_.threads), [&](int i) {
      if (!request_.go_on()) return;
      const auto form = form_at(line.points[i].at, line.points[i].t);
      along[i] = form ? along_kernel(request_.dynamics, request_.from, request_.momenta, *form)
                      : std::nan("");
    });
    for (int i = 0; i + (line.closed ? 0 : 1) < count && request_.go_on(); ++i) {
      const int next = (i + 1) % count;
      if (!(along[i] * along[next] < 0)) continue;
      const UnitMomentum& a = line.points[i].at;
      const UnitMomentum& b = line.points[next].at;
      const double part = along[i] / (along[i] - along[next]);
      const auto found = find_swallowtail(request_.dynamics,
                                          request_.from,
                                          request_.momenta,
                                          between(a, b, part),
                                          request_.conjugate_time);
      if (!found || !(found->t <= request_.length)) continue;
      if (!(distance_of(found->at, a) <= kAway * distance_of(a, b))) continue;
      const bool known =
          std::any_of(swallowtails.begin(), swallowtails.end(), [&](const Swallowtail& other) {
            return distance_of(found->at, other.at) <= kSame;
          });
      if (!known) swallowtails.push_back(*found);
    }
  }

  // Lines from ends first, then those that are closed.
  static void chain(const std::vector<CausticPoint>& points,
                    const std::vector<std::vector<int>>& next,
                    std::vector<CuspLine>& cusps) {
    std::vector<bool> used(points.size(), false);
    for (const bool closed : {false, true}) {
      for (std::size_t start = 0; start < points.size(); ++start) {
        if (used[start] || next[start].empty() || (!closed && next[start].size() != 1)) continue;
        CuspLine line;
        line.closed = closed;
        for (int i = static_cast<int>(start); i >= 0;) {
          used[i] = true;
          line.points.push_back(points[i]);
          const auto on =
              std::find_if(next[i].begin(), next[i].end(), [&](int j) { return !used[j]; });
          i = on == next[i].end() ? -1 : *on;
        }
        cusps.push_back(std::move(line));
      }
    }
  }

  const CausticRequest& request_;
  std::vector<std::optional<CausticForm>> forms_;
};

}  // namespace

CausticLines caustic_lines(const CausticRequest& request) { return Lines(request).run(); }

}  // namespace carnot::internal
