#include "carnot/shooting/wavefront.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <chrono>
#include <cmath>
#include <optional>
#include <set>
#include <sstream>
#include <stdexcept>

#include "carnot/numerics/parallel.h"
#include "carnot/shooting/front/cut_values.h"
#include "carnot/shooting/front/cylinder.h"
#include "carnot/shooting/front/momentum_bound.h"
#include "carnot/shooting/front/ray_ends.h"
#include "carnot/shooting/front/seam.h"
#include "carnot/shooting/front/surface.h"
#include "carnot/shooting/linear/illinois.h"
#include "carnot/shooting/rays/first_conjugate.h"
#include "carnot/shooting/rays/ray.h"

namespace carnot {

using namespace internal;

namespace {

constexpr double kNone = std::numeric_limits<double>::infinity();
constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();

void refuse_unless(bool ok, const char* what) {
  if (!ok) throw std::invalid_argument(what);
}

void validate(const Dynamics& dynamics,
              const std::vector<double>& from,
              const FrontOptions& options) {
  refuse_unless(static_cast<int>(from.size()) == dynamics.dof,
                "from needs one number for each coordinate");
  refuse_unless(dynamics.dof >= 3, "a surface needs three coordinates");
  refuse_unless(dynamics.holonomic == 0, "surfaces are not of scenes with holonomic constraints");
  refuse_unless(options.length > 0 && std::isfinite(options.length), "length must be > 0");
  refuse_unless(options.edge > 0 && options.angle > 0, "edge and angle must be > 0");
  refuse_unless(options.bound >= 0 && std::isfinite(options.bound), "bound must be >= 0");
  refuse_unless(options.project.empty() || options.project.size() == 3,
                "three coordinates are seen");
  for (const int j : options.project) {
    refuse_unless(j >= 0 && j < dynamics.dof, "there is no such coordinate");
  }
  std::set<int> fixed;
  for (const auto& [j, value] : options.fixed) {
    refuse_unless(j >= 0 && j < dynamics.dof && std::isfinite(value), "there is no such momentum");
    refuse_unless(fixed.insert(j).second, "a momentum is fixed twice");
  }
}

// All times are those of unit speed.
class FrontMaker {
 public:
  FrontMaker(const Dynamics& dynamics, const std::vector<double>& from, const FrontOptions& options)
      : dynamics_(dynamics),
        from_(from),
        options_(options),
        n_(dynamics.dof),
        cylinder_(dynamics, from, options.fixed),
        seen_(options.project.empty() ? std::vector<int>{0, 1, 2} : options.project),
        horizon_(kMargin * options.length),
        cuts_(dynamics,
              from,
              {horizon_, options.mod_angles, options.seed, options.threads, options.progress}) {
    (void)validated_speed(dynamics, from, cylinder_.momentum(0, 0));
  }

  void run(FrontMesh& mesh) {
    mesh.length = options_.length;
    bound_ = options_.bound > 0 ? options_.bound : chosen_bound();
    surface_ = cylinder_grid(kAround, kAlong, bound_);
    mesh.finished = make_first() && refined() && cut_out() && made_times();
    if (mesh.finished) deliver(mesh);
    mesh.searches = cuts_.searches();
    mesh.message = left_out();
  }

 private:
  [[nodiscard]] bool needs_cuts() const {
    return options_.what == FrontKind::kSphere || options_.what == FrontKind::kCut;
  }
  [[nodiscard]] bool at_length() const {
    return options_.what == FrontKind::kFront || options_.what == FrontKind::kSphere;
  }
  [[nodiscard]] std::vector<double> momentum(int i) const {
    return cylinder_.momentum(surface_.vertices[i].phi, surface_.vertices[i].w);
  }
  bool go_on() {
    if (!stopped_ && options_.progress && !options_.progress(0)) stopped_ = true;
    return !stopped_ && !cuts_.stopped();
  }
  template <class Work>
  void for_all(int first, int last, const Work& work) {
    parallel_for(last - first, thread_count(options_.threads), [&](int k) { work(first + k); });
  }

  [[nodiscard]] double chosen_bound() const {
    // Of a front: what is conjugate up to half its length, some two turns. Of what ends at R: down
    // to an eighth of it, which looks much the same, only smaller.
    constexpr double kOfFront = 0.5;
    constexpr double kOfTimes = 0.125;
    constexpr double kAnyway = 16;  // where conjugate times tell nothing
    double part = 1;
    if (options_.what == FrontKind::kFront) part = kOfFront;
    if (!at_length()) part = kOfTimes;
    const double bound =
        conjugate_bound(dynamics_, from_, cylinder_, part * options_.length, options_.threads);
    return std::isfinite(bound) ? bound : kAnyway / options_.length;
  }

  // The ends of rays from `first` on, at the time that counts.
  bool make_images(int first) {
    const int last = static_cast<int>(surface_.vertices.size());
    ends_.resize(static_cast<std::size_t>(last) * n_, kUnknown);
    if (!go_on()) return false;
    if (at_length()) {
      const std::vector<double> ends =
          ray_ends(dynamics_,
                   from_,
                   momenta_from(first),
                   {cylinder_.momentum(0.7, bound_), cylinder_.momentum(2.3, -bound_)},
                   options_.length,
                   options_.threads);
      std::copy(ends.begin(), ends.end(), ends_.begin() + static_cast<long>(first) * n_);
    } else {
      times_.resize(last, kUnknown);
      for_all(first, last, [&](int i) {
        if (!go_on()) return;
        const Ray ray(dynamics_, from_, momentum(i));
        times_[i] =
            options_.what == FrontKind::kCut ? cuts_[i].t : first_conjugate_time(ray, horizon_);
        if (!(times_[i] <= kFarthest * options_.length)) return;
        const std::vector<double> z = ray.at(times_[i], ray.enough_steps(times_[i]));
        if (!z.empty()) std::copy_n(z.begin(), n_, ends_.begin() + static_cast<long>(i) * n_);
      });
    }
    if (sizes_.empty()) find_sizes();
    for (int i = first; i < last; ++i) {
      surface_.vertices[i].image.clear();
      for (int k = 0; k < 3; ++k) {
        surface_.vertices[i].image.push_back(ends_[static_cast<std::size_t>(i) * n_ + seen_[k]] /
                                             sizes_[k]);
      }
    }
    return go_on();
  }

  // How wide the first images are in each coordinate that is seen.
  void find_sizes() {
    for (const int j : seen_) {
      double low = kNone;
      double high = -kNone;
      for (std::size_t i = j; i < ends_.size(); i += n_) {
        if (!std::isfinite(ends_[i])) continue;
        low = std::min(low, ends_[i]);
        high = std::max(high, ends_[i]);
      }
      sizes_.push_back(high > low ? high - low : 0);
    }
    // A surface that is thin in one direction is not to be magnified there.
    constexpr double kThin = 1e-3;
    const double largest = *std::max_element(sizes_.begin(), sizes_.end());
    for (double& size : sizes_) size = std::max({size, kThin * largest, 1e-300});
  }

  [[nodiscard]] std::vector<std::vector<double>> momenta_from(int first) const {
    std::vector<std::vector<double>> momenta;
    for (int i = first; i < static_cast<int>(surface_.vertices.size()); ++i) {
      momenta.push_back(momentum(i));
    }
    return momenta;
  }

  bool make_first() {
    if (needs_cuts() && !find_cuts()) return false;
    // What is not the shortest any longer is not seen, but for what borders on it.
    if (options_.what == FrontKind::kSphere) {
      std::erase_if(surface_.triangles, [&](const auto& t) {
        return std::none_of(t.begin(), t.end(), [&](int i) { return is_inside(i); });
      });
    }
    return make_images(0);
  }

  // Of the mesh as it is, and checked.
  bool find_cuts() {
    constexpr int kChecked = 16;
    constexpr int kRounds = 3;
    const std::vector<std::vector<int>> neighbours = neighbours_of_vertices();
    if (!cuts_.add(momenta_from(0), neighbours)) return false;
    for (int round = 0; round < kRounds && cuts_.check(kChecked, neighbours) > 0; ++round) {
      if (!go_on()) return false;
    }
    return go_on();
  }

  [[nodiscard]] std::vector<std::vector<int>> neighbours_of_vertices() const {
    std::vector<std::set<int>> sets(surface_.vertices.size());
    for (const auto& t : surface_.triangles) {
      for (const int i : t) sets[i].insert(t.begin(), t.end());
    }
    std::vector<std::vector<int>> neighbours;
    for (std::size_t i = 0; i < sets.size(); ++i) {
      sets[i].erase(static_cast<int>(i));
      neighbours.emplace_back(sets[i].begin(), sets[i].end());
    }
    return neighbours;
  }

  // Whether a vertex belongs to the surface.
  [[nodiscard]] bool is_inside(int i) const {
    if (options_.what == FrontKind::kFront) return true;
    if (options_.what == FrontKind::kSphere) return cuts_[i].t >= options_.length;
    return times_[i] <= options_.length;
  }

  bool make(int first, const std::vector<Between>& parents) {
    if (needs_cuts()) {
      std::vector<std::pair<int, int>> pairs;
      for (const Between& place : parents) pairs.emplace_back(place.a, place.b);
      if (!cuts_.add_between(momenta_from(first), pairs)) return false;
    }
    return make_images(first);
  }

  bool refined() {
    constexpr double kShortest = 0.125;
    Refinement how{options_.edge, options_.angle, kShortest * options_.edge, options_.most, {}};
    how.make = [this](int first, const std::vector<Between>& parents) {
      return make(first, parents);
    };
    rough_ = refine(how, surface_);
    return rough_ >= 0;
  }

  // The time that tells inside from outside, at a momentum beside vertex `near`.
  [[nodiscard]] CutValue value_at(const std::vector<double>& p, int near) {
    if (needs_cuts()) return cuts_.beside(p, near);
    CutValue value;
    value.t = first_conjugate_time(Ray(dynamics_, from_, p), horizon_);
    return value;
  }

  // The place on an edge where the time is the length.
  void locate(Between& place) {
    constexpr double kEnough = 1e-13;
    const double wanted = 1 / options_.length;
    const auto time = [&](int i) { return needs_cuts() ? cuts_[i].t : times_[i]; };
    const auto rate_at = [&](double part) {
      const SurfaceVertex trial = surface_.between({place.a, place.b, part});
      const int near = std::abs(part) < 0.5 && std::isfinite(time(place.a)) ? place.a : place.b;
      const double t = value_at(cylinder_.momentum(trial.phi, trial.w), near).t;
      return std::optional(1 / t - wanted);
    };
    place.part =
        illinois(0, 1 / time(place.a) - wanted, 1, 1 / time(place.b) - wanted, kEnough, rate_at);
  }

  // Leaves the inside, with its border and, of a sphere, sewn.
  bool cut_out() {
    if (options_.what == FrontKind::kFront) return true;
    const int count = static_cast<int>(surface_.vertices.size());
    std::vector<bool> inside(count);
    for (int i = 0; i < count; ++i) inside[i] = is_inside(i);
    clip(
        inside,
        [&](std::vector<Between>& places) {
          for_all(0, static_cast<int>(places.size()), [&](int k) {
            if (go_on()) locate(places[k]);
          });
        },
        [&](int first, const std::vector<Between>& parents) {
          border_ = first;
          return make(first, parents);
        },
        surface_);
    return go_on();
  }

  bool made_times() {
    if (options_.what != FrontKind::kFront || !options_.times) return true;
    return find_cuts();
  }

  void sew_sphere(FrontMesh& mesh) {
    std::vector<BorderVertex> border;
    for (int i = border_; i < static_cast<int>(surface_.vertices.size()); ++i) {
      const CutValue& value = cuts_[i];
      BorderVertex one{i, value.at_conjugate || value.partner.p.empty(), {}};
      if (!one.at_conjugate) one.partner = cylinder_.coordinates(value.partner.p);
      border.push_back(one);
    }
    const std::vector<int> classes = sew(
        border,
        [&](int first, const std::vector<int>& of) {
          cuts_.add_partners(of);
          (void)make_images(first);
        },
        surface_);
    Surface whole{{}, surface_.triangles};
    merge(classes, whole);
    const Topology topology = topology_of(whole);
    mesh.closed = topology.closed;
    mesh.euler = topology.euler;
    if (mesh.closed) mesh.volume = volume();
    // In one place only what has the same image: angles may have turned once more.
    constexpr double kSamePlace = 1e-7;
    std::vector<int> same = classes;
    for (std::size_t i = 0; i < same.size(); ++i) {
      const auto& a = surface_.vertices[i].image;
      const auto& b = surface_.vertices[classes[i]].image;
      for (int k = 0; k < 3; ++k) {
        if (!(std::abs(a[k] - b[k]) <= kSamePlace)) same[i] = static_cast<int>(i);
      }
    }
    merge(same, surface_);
  }

  // The flux of (x, 0, 0) through the surface, where x is no angle: it does not matter that images
  // may be periods of angles apart.
  [[nodiscard]] double volume() const {
    int x = 0;
    while (x < 2 && dynamics_.info.configuration[x].period > 0) ++x;
    const auto at = [&](int i, int k) {
      return ends_[static_cast<std::size_t>(i) * n_ + (x + k) % 3];
    };
    double sum = 0;
    for (const auto& [a, b, c] : surface_.triangles) {
      const double area = (at(b, 1) - at(a, 1)) * (at(c, 2) - at(a, 2)) -
                          (at(b, 2) - at(a, 2)) * (at(c, 1) - at(a, 1));
      sum += area * (at(a, 0) + at(b, 0) + at(c, 0)) / 6;
    }
    return std::abs(sum);
  }

  void deliver(FrontMesh& mesh) {
    if (options_.what == FrontKind::kSphere && n_ == 3) sew_sphere(mesh);
    std::vector<int> kept;
    drop_unused(surface_, kept);
    for (const int i : kept) {
      FrontVertex vertex;
      const auto end = ends_.begin() + static_cast<long>(i) * n_;
      vertex.q.assign(end, end + n_);
      vertex.p0 = momentum(static_cast<int>(mesh.vertices.size()));
      fill_times(i, vertex);
      mesh.vertices.push_back(std::move(vertex));
    }
    mesh.triangles = surface_.triangles;
  }

  void fill_times(int i, FrontVertex& vertex) const {
    constexpr std::array kNames{"front", "sphere", "caustic", "cut"};
    vertex.label = kNames[static_cast<int>(options_.what)];
    if (needs_cuts() || (options_.what == FrontKind::kFront && options_.times)) {
      vertex.cut_time = cuts_[i].t;
      vertex.conjugate_time = cuts_[i].conjugate;
      const bool on_seam = options_.what == FrontKind::kCut || (border_ >= 0 && i >= border_);
      if (on_seam) vertex.label = cuts_[i].at_conjugate ? "conjugate" : "maxwell";
    } else if (options_.what == FrontKind::kCaustic) {
      vertex.conjugate_time = times_[i];
    }
  }

  [[nodiscard]] std::string left_out() const {
    std::ostringstream text;
    text.precision(4);
    if (options_.what != FrontKind::kSphere) {
      text << "left out: momenta beyond " << bound_ << " along the line of the cylinder";
      if (!at_length() && options_.bound == 0)
        text << ", where times are below " << options_.length / 8;
    }
    if (rough_ > 0) {
      if (!text.str().empty()) text << "; ";
      text << rough_ << " edges are longer or sharper than asked for: more vertices were needed";
    }
    return text.str();
  }

  static constexpr int kAround = 48;  // vertices of the first mesh
  static constexpr int kAlong = 33;
  // Times are followed to here, so that what borders on the surface has an image, too.
  static constexpr double kMargin = 1.5;
  static constexpr double kFarthest = 2;  // where images are still made

  const Dynamics& dynamics_;
  const std::vector<double>& from_;
  const FrontOptions& options_;
  int n_;
  Cylinder cylinder_;
  std::vector<int> seen_;
  double horizon_;
  CutValues cuts_;
  Surface surface_;
  double bound_ = 0;
  std::vector<double> ends_;   // q of each vertex
  std::vector<double> times_;  // of each vertex, of a caustic or a cut locus
  std::vector<double> sizes_;
  int border_ = -1;  // the first vertex of the border
  long rough_ = 0;
  std::atomic<bool> stopped_{false};
};

}  // namespace

void check_wavefront(const Dynamics& dynamics,
                     const std::vector<double>& from,
                     const FrontOptions& options) {
  validate(dynamics, from, options);
  const Cylinder cylinder(dynamics, from, options.fixed);
  (void)validated_speed(dynamics, from, cylinder.momentum(0, 0));
}

FrontMesh wavefront(const Dynamics& dynamics,
                    const std::vector<double>& from,
                    const FrontOptions& options) {
  const auto began = std::chrono::steady_clock::now();
  validate(dynamics, from, options);
  FrontMesh mesh;
  FrontMaker(dynamics, from, options).run(mesh);
  const std::chrono::duration<double> elapsed = std::chrono::steady_clock::now() - began;
  mesh.elapsed_seconds = elapsed.count();
  return mesh;
}

}  // namespace carnot
