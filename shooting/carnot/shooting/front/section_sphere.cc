#include "carnot/shooting/front/section_sphere.h"

#include <Eigen/Core>
#include <algorithm>
#include <atomic>
#include <cmath>
#include <map>
#include <optional>
#include <set>
#include <utility>

#include "carnot/numerics/parallel.h"
#include "carnot/shooting/find_geodesics.h"
#include "carnot/shooting/front/level_point.h"
#include "carnot/shooting/linear/illinois.h"

namespace carnot::internal {
namespace {

using Corners = std::array<GridPlace, 4>;
using Side =
    std::pair<GridPlace, GridPlace>;  // of a tetrahedron: from the nearer place to the farther one
using Face = std::array<GridPlace, 3>;  // the place that is alone on its side, and both others

class SectionSphereMaker {
 public:
  SectionSphereMaker(const Dynamics& dynamics,
                     const std::vector<double>& from,
                     const SectionOptions& options)
      : dynamics_(dynamics), from_(from), options_(options), field_(dynamics, from, options) {}

  SectionSphere run() {
    if (!field_.fit()) return std::move(sphere_);
    make_tetrahedra();
    make_inverses();
    make_vertices();
    while (improve()) {
    }
    search_unknown();
    while (improve()) {
    }
    make_seam();
    triangulate();
    sphere_.searches = field_.searches() + searches_;
    sphere_.finished = go_on();
    return std::move(sphere_);
  }

 private:
  // A vertex on a side of a tetrahedron.
  struct OnSide {
    Side side;
    double part = 0;        // from the nearer place
    NearExtremal extremal;  // that ends there
    bool known = false;
  };
  // Two vertices that share a face.
  struct OnFace {
    Face face;
    int first = 0;  // vertices on the sides from the lone place to the second and the third one
    int second = 0;
    bool joined = false;  // the extremal of the first leads to that of the second
    int seam = -1;        // the vertex between them
  };

  bool go_on() {
    if (!stopped_ && options_.progress && !options_.progress(0)) stopped_ = true;
    return !stopped_;
  }
  template <class Work>
  void for_all(std::size_t count, const Work& work) {
    parallel_for(static_cast<int>(count), thread_count(options_.threads), [&](int k) {
      if (go_on()) work(k);
    });
  }

  void make_tetrahedra() {
    std::array<long, 3> count{};
    for (int k = 0; k < 3; ++k) count[k] = static_cast<long>(field_.grid().axes[k].values.size());
    const std::array<long, 3> stride{count[1] * count[2], count[2], 1};
    std::array<int, 3> order{0, 1, 2};
    std::vector<std::array<int, 3>> orders;
    do {
      orders.push_back(order);
    } while (std::next_permutation(order.begin(), order.end()));
    for (long i = 0; i < field_.grid().size(); ++i) {
      bool last = false;
      for (int k = 0; k < 3; ++k) last = last || i / stride[k] % count[k] == count[k] - 1;
      if (last) continue;
      for (const auto& way : orders) {
        Corners corners{i};
        for (int k = 0; k < 3; ++k) corners[k + 1] = corners[k] + stride[way[k]];
        const auto inside = std::count_if(corners.begin(), corners.end(), [&](GridPlace corner) {
          return field_.is_inside(corner);
        });
        if (inside > 0 && inside < 4) tetrahedra_.push_back(corners);
      }
    }
    for (const Corners& corners : tetrahedra_) {
      for (const GridPlace a : corners) {
        for (const GridPlace b : corners) {
          if (field_.is_inside(a) && !field_.is_inside(b)) add_side({a, b});
        }
      }
    }
  }
  void add_side(const Side& side) {
    if (numbers_.emplace(side, static_cast<int>(vertices_.size())).second) {
      vertices_.emplace_back().side = side;
    }
  }
  [[nodiscard]] int vertex_on(GridPlace a, GridPlace b) const {
    return numbers_.at(field_.is_inside(a) ? Side{a, b} : Side{b, a});
  }

  // Of the extremals to places with a side that is cut.
  void make_inverses() {
    level_.emplace(LevelProblem{dynamics_, from_, options_.length, field_.widths()});
    std::vector<GridPlace> places;
    for (const OnSide& one : vertices_) {
      for (const GridPlace i : {one.side.first, one.side.second}) {
        if (field_.is_known(i) && inverses_.emplace(i, Eigen::MatrixXd()).second)
          places.push_back(i);
      }
    }
    for_all(places.size(), [&](int k) {
      inverses_.at(places[k]) = momentum_by_end(*level_, field_.momentum(places[k]));
    });
  }

  // From an extremal to q to the vertex on a side that it leads to, if there is one.
  [[nodiscard]] std::optional<LevelPoint> led(const Side& side,
                                              double part,
                                              const NearExtremal& extremal) const {
    constexpr double kRounded = 1e-9;
    const Simplex simplex{field_.grid().target(side.first),
                          field_.place(side.second) - field_.place(side.first)};
    auto point = lead(*level_, simplex, Eigen::VectorXd::Constant(1, part), {extremal});
    const bool on_side = point && point->s[0] >= -kRounded && point->s[0] <= 1 + kRounded;
    return on_side ? std::move(point) : std::nullopt;
  }

  // Keeps what is farther out. Whether it is so by more than round-off.
  static bool keep(const std::optional<LevelPoint>& found, OnSide& vertex) {
    constexpr double kSame = 1e-8;
    if (!found || (vertex.known && found->s[0] <= vertex.part + kSame)) return false;
    vertex.known = true;
    vertex.part = found->s[0];
    vertex.extremal.p = found->p[0];
    return true;
  }

  // From an end of a side step by step, to the place where the distance is R, and on from there.
  void walk(bool from_far, OnSide& vertex) const {
    constexpr int kParts = 16;
    const GridPlace start = from_far ? vertex.side.second : vertex.side.first;
    if (!field_.is_known(start)) return;
    NearExtremal at{field_.momentum(start), inverses_.at(start), field_.place(start)};
    for (int k = 1; k <= kParts; ++k) {
      const double done = static_cast<double>(k) / kParts;
      const double part = from_far ? 1 - done : done;
      auto p = bring(*level_, at, place_on(vertex.side, part));
      if (!p) return;
      at = extremal_to(place_on(vertex.side, part), std::move(*p));
      const bool beyond = excess_energy(*level_, at.p) >= 0;
      if (beyond == from_far) continue;
      keep(led(vertex.side, part, at), vertex);
      return;
    }
  }
  [[nodiscard]] NearExtremal extremal_to(Eigen::VectorXd q, Eigen::VectorXd p) const {
    Eigen::MatrixXd inverse = momentum_by_end(*level_, p);
    return {std::move(p), std::move(inverse), std::move(q)};
  }
  [[nodiscard]] Eigen::VectorXd place_on(const Side& side, double part) const {
    return (1 - part) * field_.place(side.first) + part * field_.place(side.second);
  }

  // The place on a side where searches tell that the distance is R.
  void search(OnSide& vertex) {
    constexpr double kEnough = 1e-4;  // of the side; from there Newton's method goes on
    const auto& [near, far] = vertex.side;
    Eigen::VectorXd p;
    const auto beyond = [&](double part) -> std::optional<double> {
      const std::vector<double> q = numbers_of(place_on(vertex.side, part));
      GeodesicOptions one;
      one.seed = options_.seed;
      one.mod_angles = false;
      one.threads = 1;
      ++searches_;
      const GeodesicReport report = find_geodesics({dynamics_, from_, q, options_.length}, one);
      if (report.geodesics.empty() || !go_on()) return std::nullopt;
      p = vector_of(report.geodesics[0].p0);
      return std::sqrt(2 * report.geodesics[0].action / options_.length) - 1;
    };
    const double part = illinois(0, field_.beyond(near), 1, field_.beyond(far), kEnough, beyond);
    if (p.size() == 0) return;
    keep(led(vertex.side, part, extremal_to(place_on(vertex.side, part), p)), vertex);
  }

  // Vertices that no extremal leads to, as beside an abnormal curve: there momenta grow beyond all
  // bounds, and most searches are in vain.
  void search_unknown() {
    constexpr std::size_t kMost = 64;
    std::vector<int> unknown;
    for (std::size_t k = 0; k < vertices_.size() && unknown.size() < kMost; ++k) {
      if (!vertices_[k].known) unknown.push_back(static_cast<int>(k));
    }
    for_all(unknown.size(), [&](int k) {
      search(vertices_[unknown[k]]);
      finish(vertices_[unknown[k]]);
    });
    for (const int k : unknown) {
      if (vertices_[k].known) news_.insert(k);
    }
  }

  void make_vertices() {
    for_all(vertices_.size(), [&](int k) {
      OnSide& vertex = vertices_[k];
      const auto& [near, far] = vertex.side;
      const double guess = -field_.beyond(near) / (field_.beyond(far) - field_.beyond(near));
      for (const GridPlace i : {near, far}) {
        if (!field_.is_known(i)) continue;
        const NearExtremal there{field_.momentum(i), inverses_.at(i), field_.place(i)};
        keep(led(vertex.side, guess, there), vertex);
      }
      for (const bool from_far : {false, true}) {
        if (!vertex.known) walk(from_far, vertex);
      }
      finish(vertex);
      if (!vertex.known) vertex.part = guess;
    });
    for (const Corners& corners : tetrahedra_) add_faces(corners);
  }
  void finish(OnSide& vertex) const {
    if (!vertex.known) return;
    vertex.extremal = extremal_to(place_on(vertex.side, vertex.part), vertex.extremal.p);
  }
  void add_faces(const Corners& corners) {
    for (int left_out = 0; left_out < 4; ++left_out) {
      std::vector<GridPlace> inside;
      std::vector<GridPlace> outside;
      for (int k = 0; k < 4; ++k) {
        if (k != left_out) (field_.is_inside(corners[k]) ? inside : outside).push_back(corners[k]);
      }
      if (inside.empty() || outside.empty()) continue;
      const std::vector<GridPlace>& two = inside.size() == 2 ? inside : outside;
      const GridPlace lone = inside.size() == 1 ? inside[0] : outside[0];
      const Face face{lone, std::min(two[0], two[1]), std::max(two[0], two[1])};
      if (!face_numbers_.emplace(face, static_cast<int>(faces_.size())).second) continue;
      faces_.push_back({face, vertex_on(lone, face[1]), vertex_on(lone, face[2])});
    }
  }

  // Leads each vertex to those beside it, and not back where it leads to the extremal that is
  // there. Whether any became better.
  bool improve() {
    std::vector<std::array<std::optional<LevelPoint>, 2>> found(faces_.size());
    const auto is_news = [&](int v) { return round_ == 0 || news_.contains(v); };
    for_all(faces_.size(), [&](int k) {
      OnFace& face = faces_[k];
      const OnSide& a = vertices_[face.first];
      const OnSide& b = vertices_[face.second];
      if (is_news(face.first) || is_news(face.second)) face.joined = false;
      if (a.known && is_news(face.first)) {
        found[k][1] = led(b.side, b.part, a.extremal);
        face.joined = is_at(found[k][1], b);
      }
      if (b.known && is_news(face.second) && !face.joined) {
        found[k][0] = led(a.side, a.part, b.extremal);
      }
    });
    std::set<int> better;
    for (std::size_t k = 0; k < faces_.size(); ++k) {
      for (const int side : {0, 1}) {
        const int vertex = side == 0 ? faces_[k].first : faces_[k].second;
        if (keep(found[k][side], vertices_[vertex])) better.insert(vertex);
      }
    }
    for (OnFace& face : faces_) {
      if (better.contains(face.first) || better.contains(face.second)) face.joined = false;
    }
    const std::vector<int> changed(better.begin(), better.end());
    for_all(changed.size(), [&](int k) { finish(vertices_[changed[k]]); });
    news_ = std::move(better);
    ++round_;
    return !news_.empty() && go_on();
  }

  [[nodiscard]] bool same_extremal(const Eigen::VectorXd& a, const Eigen::VectorXd& b) const {
    constexpr double kSame = 1e-6;
    return (a - b).cwiseAbs().maxCoeff() <= kSame * std::max(a.cwiseAbs().maxCoeff(), 1e-300);
  }
  [[nodiscard]] bool is_at(const std::optional<LevelPoint>& found, const OnSide& vertex) const {
    return found && vertex.known && same_extremal(found->p[0], vertex.extremal.p);
  }

  void make_seam() {
    std::vector<std::optional<SphereVertex>> seam(faces_.size());
    for_all(faces_.size(), [&](int k) {
      const OnFace& one = faces_[k];
      const OnSide& a = vertices_[one.first];
      const OnSide& b = vertices_[one.second];
      if (!a.known || !b.known || one.joined) return;
      if (is_at(led(b.side, b.part, a.extremal), b)) return;
      seam[k] = between(one, a, b);
    });
    for (std::size_t k = 0; k < faces_.size(); ++k) {
      if (!seam[k]) continue;
      faces_[k].seam = static_cast<int>(vertices_.size() + seam_.size());
      seam_.push_back(std::move(*seam[k]));
    }
  }

  // Where the extremals of two vertices of a face are as short.
  [[nodiscard]] std::optional<SphereVertex> between(const OnFace& one,
                                                    const OnSide& a,
                                                    const OnSide& b) const {
    Simplex simplex{field_.grid().target(one.face[0]), Eigen::MatrixXd(dynamics_.dof, 2)};
    const Eigen::VectorXd corner = field_.place(one.face[0]);
    simplex.sides.col(0) = field_.place(one.face[1]) - corner;
    simplex.sides.col(1) = field_.place(one.face[2]) - corner;
    const bool lone_is_near = field_.is_inside(one.face[0]);
    const auto out = [&](const OnSide& v) { return lone_is_near ? v.part : 1 - v.part; };
    const Eigen::VectorXd middle = 0.5 * Eigen::Vector2d(out(a), out(b));
    const auto point = lead(*level_, simplex, middle, {a.extremal, b.extremal});
    if (!point || point->s.minCoeff() < 0 || point->s.sum() > 1) return std::nullopt;
    if (same_extremal(point->p[0], point->p[1])) return std::nullopt;
    return SphereVertex{numbers_of(corner + simplex.sides * point->s),
                        numbers_of(point->p[0]),
                        numbers_of(point->p[1])};
  }

  void triangulate() {
    for (const OnSide& vertex : vertices_) {
      sphere_.rough += vertex.known ? 0 : 1;
      SphereVertex one{numbers_of(place_on(vertex.side, vertex.part)), {}, {}};
      one.p0.assign(dynamics_.dof, std::nan(""));
      if (vertex.known) one.p0 = numbers_of(vertex.extremal.p);
      sphere_.vertices.push_back(std::move(one));
    }
    sphere_.vertices.insert(sphere_.vertices.end(), seam_.begin(), seam_.end());
    sphere_.unknown = field_.unknown();
    for (const Corners& corners : tetrahedra_) triangulate(corners);
  }

  [[nodiscard]] int seam_on(GridPlace a, GridPlace b, GridPlace c) const {
    Face face{a, b, c};
    for (int k = 1; k < 3; ++k) {
      const auto differs = [&](GridPlace i) {
        return field_.is_inside(i) != field_.is_inside(face[k]);
      };
      const bool lone = std::count_if(face.begin(), face.end(), differs) == 2;
      if (lone) std::swap(face[0], face[k]);
    }
    if (face[1] > face[2]) std::swap(face[1], face[2]);
    return faces_[face_numbers_.at(face)].seam;
  }

  void triangulate(const Corners& corners) {
    std::vector<GridPlace> inside;
    std::vector<GridPlace> outside;
    for (const GridPlace i : corners) (field_.is_inside(i) ? inside : outside).push_back(i);
    // The polygon, vertex after vertex, and the seam's vertex on each of its sides.
    std::vector<int> ring;
    std::vector<std::size_t> crossings;
    const auto add = [&](int vertex, int seam) {
      ring.push_back(vertex);
      if (seam < 0) return;
      crossings.push_back(ring.size());
      ring.push_back(seam);
    };
    if (inside.size() == 2) {
      const auto& [a, b] = std::pair(inside[0], inside[1]);
      const auto& [c, d] = std::pair(outside[0], outside[1]);
      add(vertex_on(a, c), seam_on(a, c, d));
      add(vertex_on(a, d), seam_on(a, b, d));
      add(vertex_on(b, d), seam_on(b, c, d));
      add(vertex_on(b, c), seam_on(a, b, c));
    } else {
      const GridPlace lone = inside.size() == 1 ? inside[0] : outside[0];
      const std::vector<GridPlace>& three = inside.size() == 1 ? outside : inside;
      for (int k = 0; k < 3; ++k) {
        add(vertex_on(lone, three[k]), seam_on(lone, three[k], three[(k + 1) % 3]));
      }
    }
    Eigen::VectorXd outwards = Eigen::VectorXd::Zero(dynamics_.dof);
    for (const GridPlace i : outside)
      outwards += field_.place(i) / static_cast<double>(outside.size());
    for (const GridPlace i : inside)
      outwards -= field_.place(i) / static_cast<double>(inside.size());
    if (crossings.size() == 2) {
      // Along the seam.
      const auto first = ring.begin() + static_cast<long>(crossings[0]);
      const auto second = ring.begin() + static_cast<long>(crossings[1]);
      std::vector<int> one(first, second + 1);
      std::vector<int> other(second, ring.end());
      other.insert(other.end(), ring.begin(), first + 1);
      fan(one, outwards);
      fan(other, outwards);
      return;
    }
    if (!crossings.empty()) {
      std::rotate(ring.begin(), ring.begin() + static_cast<long>(crossings[0]), ring.end());
    }
    fan(ring, outwards);
  }

  // Triangles about the first corner of a ring.
  void fan(const std::vector<int>& ring, const Eigen::VectorXd& outwards) {
    for (std::size_t k = 1; k + 1 < ring.size(); ++k) {
      std::array<int, 3> triangle{ring[0], ring[k], ring[k + 1]};
      const auto at = [&](int i) {
        Eigen::Vector3d x;
        for (int j = 0; j < 3; ++j) x[j] = sphere_.vertices[triangle[i]].q[field_.seen()[j]];
        return x;
      };
      Eigen::Vector3d out;
      for (int j = 0; j < 3; ++j) out[j] = outwards[field_.seen()[j]];
      const Eigen::Vector3d u = at(1) - at(0);
      const Eigen::Vector3d v = at(2) - at(0);
      const Eigen::Vector3d normal{
          u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]};
      if (normal.dot(out) < 0) std::swap(triangle[1], triangle[2]);
      sphere_.triangles.push_back(triangle);
      const Eigen::Vector3d w = at(0);
      sphere_.volume += (normal.dot(out) < 0 ? -1 : 1) * normal.dot(w) / 6;
    }
  }

  const Dynamics& dynamics_;
  const std::vector<double>& from_;
  const SectionOptions& options_;
  SectionField field_;
  std::vector<Corners> tetrahedra_;
  std::vector<OnSide> vertices_;
  std::map<Side, int> numbers_;
  std::vector<OnFace> faces_;
  std::map<Face, int> face_numbers_;
  std::map<GridPlace, Eigen::MatrixXd> inverses_;
  std::optional<LevelProblem> level_;
  std::set<int> news_;  // vertices that became better in the last round
  int round_ = 0;
  std::vector<SphereVertex> seam_;
  std::atomic<long> searches_{0};
  std::atomic<bool> stopped_{false};
  SectionSphere sphere_;
};

}  // namespace

SectionSphere section_sphere(const Dynamics& dynamics,
                             const std::vector<double>& from,
                             const SectionOptions& options) {
  return SectionSphereMaker(dynamics, from, options).run();
}

}  // namespace carnot::internal
