#include "carnot/shooting/front/cusp_ends.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace carnot::internal {

double distance_of(const UnitMomentum& a, const UnitMomentum& b) {
  return std::hypot((a.c - b.c).norm(), (a.w - b.w).norm() / (1 + a.w.norm()));
}

namespace {

// The largest of the distances between neighbours.
double largest_gap(const CuspLine& line) {
  double largest = 0;
  for (std::size_t i = 1; i < line.points.size(); ++i) {
    largest = std::max(largest, distance_of(line.points[i - 1].at, line.points[i].at));
  }
  return largest;
}

// A free end of an open line near an umbilic.
struct End {
  std::size_t line;
  bool first;
  double away;
};

std::vector<End> ends_near(const Umbilic& umbilic, const std::vector<CuspLine>& lines) {
  // Largest gaps of the line. On the ellipsoid of the tests lines stop short by up to 2.1 of them.
  constexpr double kReach = 3;
  std::vector<End> ends;
  for (std::size_t i = 0; i < lines.size(); ++i) {
    const CuspLine& line = lines[i];
    if (line.closed || line.points.empty()) continue;
    const double reach = kReach * largest_gap(line);
    const double from_first = distance_of(line.points.front().at, umbilic.at);
    const double from_last = distance_of(line.points.back().at, umbilic.at);
    if (line.first_umbilic < 0 && from_first <= reach) ends.push_back({i, true, from_first});
    if (line.last_umbilic < 0 && from_last <= reach) ends.push_back({i, false, from_last});
  }
  std::sort(ends.begin(), ends.end(), [](const End& a, const End& b) { return a.away < b.away; });
  return ends;
}

// The umbilic becomes an end of the line.
void attach(const Umbilic& umbilic, int number, bool first, CuspLine& line) {
  const CausticPoint point{umbilic.at, umbilic.t};
  if (first) {
    line.points.insert(line.points.begin(), point);
    line.first_umbilic = number;
  } else {
    line.points.push_back(point);
    line.last_umbilic = number;
  }
}

// The points of a piece, its far end first.
std::vector<CausticPoint> towards(const Umbilic& umbilic, std::vector<CausticPoint> points) {
  if (distance_of(points.front().at, umbilic.at) < distance_of(points.back().at, umbilic.at)) {
    std::reverse(points.begin(), points.end());
  }
  return points;
}

// The longest line that ends near a hyperbolic umbilic takes the pieces between them, and ends
// there.
void lead_one(const Umbilic& umbilic,
              int number,
              const std::vector<End>& ends,
              std::vector<CuspLine>& lines) {
  const End main = *std::max_element(ends.begin(), ends.end(), [&](const End& a, const End& b) {
    return lines[a.line].points.size() < lines[b.line].points.size();
  });
  CuspLine& line = lines[main.line];
  if (main.first) std::reverse(line.points.begin(), line.points.end());
  // From the line to the umbilic: those that are nearer come later.
  for (std::size_t k = ends.size(); k-- > 0;) {
    const End& end = ends[k];
    CuspLine& piece = lines[end.line];
    if (end.line == main.line || end.away >= main.away || piece.points.empty()) continue;
    if (piece.first_umbilic >= 0 || piece.last_umbilic >= 0) continue;
    const auto points = towards(umbilic, std::move(piece.points));
    line.points.insert(line.points.end(), points.begin(), points.end());
    piece.points.clear();
  }
  if (main.first) std::reverse(line.points.begin(), line.points.end());
  attach(umbilic, number, main.first, line);
}

}  // namespace

void lead_to_umbilics(const std::vector<Umbilic>& umbilics, std::vector<CuspLine>& lines) {
  constexpr std::size_t kAtElliptic = 3;
  for (std::size_t i = 0; i < umbilics.size(); ++i) {
    const std::vector<End> ends = ends_near(umbilics[i], lines);
    if (ends.empty()) continue;
    const int number = static_cast<int>(i);
    if (umbilics[i].hyperbolic) {
      lead_one(umbilics[i], number, ends, lines);
      continue;
    }
    for (std::size_t k = 0; k < std::min(kAtElliptic, ends.size()); ++k) {
      attach(umbilics[i], number, ends[k].first, lines[ends[k].line]);
    }
  }
  std::erase_if(lines, [](const CuspLine& line) { return line.points.empty(); });
}

}  // namespace carnot::internal
