#include "carnot/shooting/front/front_maker.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <iterator>
#include <limits>
#include <map>
#include <numeric>
#include <optional>
#include <ostream>
#include <sstream>
#include <string>
#include <utility>

#include "carnot/numerics/parallel.h"
#include "carnot/shooting/extremal/abnormal_curve.h"
#include "carnot/shooting/front/caustic_lines.h"
#include "carnot/shooting/front/columns.h"
#include "carnot/shooting/front/cut_values.h"
#include "carnot/shooting/front/enclosed.h"
#include "carnot/shooting/front/end_section.h"
#include "carnot/shooting/front/image_scale.h"
#include "carnot/shooting/front/maxwell_label.h"
#include "carnot/shooting/front/omissions.h"
#include "carnot/shooting/front/ray_ends.h"
#include "carnot/shooting/front/seam.h"
#include "carnot/shooting/front/section_surface.h"
#include "carnot/shooting/front/surface.h"
#include "carnot/shooting/front/unit_momenta.h"
#include "carnot/shooting/linear/illinois.h"
#include "carnot/shooting/rays/conjugate_time.h"
#include "carnot/shooting/rays/ray.h"

namespace carnot::internal {
namespace {

constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();

// All times are those of unit speed.
class FrontMaker {
 public:
  FrontMaker(const Dynamics& dynamics, const std::vector<double>& from, const FrontOptions& options)
      : dynamics_(dynamics),
        from_(from),
        options_(options),
        n_(dynamics.dof),
        momenta_(measured_momenta(dynamics, from, options)),
        scale_(seen_coordinates(dynamics, options)),
        horizon_(kMargin * options.length),
        cuts_(dynamics,
              from,
              momenta_,
              {horizon_,
               options.mod_angles,
               options.signs,
               options.seed,
               options.threads,
               options.progress}) {
    if (!options.section) return;
    section_.emplace(
        dynamics_, from_, momenta_, *options.section, options.length, options.mod_angles);
  }

  FrontMesh run() {
    FrontMesh mesh;
    mesh.length = options_.length;
    if (section_) {
      begin_section();
    } else {
      begin_whole();
    }
    mesh.finished = make_first() && refined() && made_cusps(mesh) && cut_out() && made_times();
    if (mesh.finished) deliver(mesh);
    mesh.searches = cuts_.searches();
    mesh.message = left_out();
    return mesh;
  }

 private:
  void begin_whole() {
    const std::vector<Column> columns =
        momenta_.has_line() ? first_columns() : std::vector<Column>{};
    surface_ = first_surface(momenta_, columns);
    for (std::size_t i = 0; i < surface_.vertices.size() && !columns.empty(); ++i) {
      if (!columns[i % columns.size()].added) seeds_.push_back(static_cast<int>(i));
    }
  }
  void begin_section() {
    const double conjugate = options_.bound > 0 ? 0 : part_of_front(options_) * options_.length;
    surface_ = section_surface(
        {dynamics_, from_, momenta_, options_.length, conjugate, options_.threads}, *section_);
  }
  // With the axes of a plane.
  static UnitMomenta measured_momenta(const Dynamics& dynamics,
                                      const std::vector<double>& from,
                                      const FrontOptions& options) {
    UnitMomenta momenta(dynamics, from, options.fixed, options.section.has_value());
    if (!options.section) return momenta;
    if (options.bound > 0) {
      momenta.set_plane(options.bound * Eigen::Matrix2d::Identity());
    } else {
      const double conjugate = part_of_front(options) * options.length;
      momenta.set_plane(plane_axes(dynamics, from, momenta, conjugate, options.threads));
    }
    return momenta;
  }

  [[nodiscard]] bool needs_cuts() const {
    return options_.what == FrontKind::kSphere || options_.what == FrontKind::kCut;
  }
  [[nodiscard]] bool at_length() const {
    return options_.what == FrontKind::kFront || options_.what == FrontKind::kSphere;
  }
  [[nodiscard]] std::vector<double> momentum(int i) const {
    return momenta_.momentum(surface_.vertices[i].place);
  }
  bool go_on() {
    if (!stopped_ && options_.progress && !options_.progress(0)) stopped_ = true;
    return !stopped_ && !cuts_.stopped();
  }
  template <class Work>
  void for_all(int first, int last, const Work& work) {
    parallel_for(last - first, thread_count(options_.threads), [&](int k) { work(first + k); });
  }

  // Sets bound_, too.
  std::vector<Column> first_columns() {
    std::vector<Column> columns;
    if (options_.what == FrontKind::kSphere && options_.bound == 0) {
      columns = conjugate_columns(
          {dynamics_, from_, momenta_, options_.length, longest_edge(), options_.threads}, scale_);
    }
    if (columns.empty()) {
      columns = even_columns(momenta_, options_.bound > 0 ? options_.bound : chosen_bound());
    }
    for (const Column& column : columns) bound_ = std::max({bound_, column.high, -column.low});
    return columns;
  }

  // Of a front: what is conjugate up to half its length, some two turns, is enough. Of a section
  // that part folds too often for 100,000 vertices.
  static double part_of_front(const FrontOptions& options) {
    constexpr double kOfFront = 0.5;
    return options.what == FrontKind::kFront && !options.section ? kOfFront : 1;
  }
  // Sets least_part_, too.
  double chosen_bound() {
    // Of what ends at R: down to an eighth of it, which looks much the same, only smaller. Where
    // some directions have no such bound, momenta grow like the inverse square of the time, and
    // down to a half of R in half of the directions is enough: Martinet's caustic takes 0.3 s then,
    // and more than a minute down to an eighth.
    constexpr double kOfHalf = 0.5;
    constexpr double kAnyway = 16;  // where conjugate times tell nothing
    least_part_ = at_length() ? part_of_front(options_) : kOfTimes;
    const auto at = [&](const auto& bound_at) {
      return bound_at(dynamics_, from_, momenta_, least_part_ * options_.length, options_.threads);
    };
    double bound = at(conjugate_bound);
    if (std::isfinite(bound)) return bound;
    least_part_ = at_length() ? 1 : kOfHalf;
    bound = at(median_conjugate_bound);
    if (std::isfinite(bound)) return bound;
    least_part_ = 0;
    return kAnyway / options_.length;
  }

  // The ends of rays from `first` on, at the time that counts.
  bool make_images(int first) {
    const int last = static_cast<int>(surface_.vertices.size());
    ends_.resize(static_cast<std::size_t>(last) * n_, kUnknown);
    if (!go_on()) return false;
    if (at_length()) {
      const double reach = section_ ? 1 : bound_;
      std::vector<std::vector<double>> longest;
      for (const Eigen::Vector3d& c : momenta_.directions(3)) {
        for (int k = 0; k < std::max(momenta_.lines(), 1); ++k) {
          for (const double side : {1.0, -1.0}) {
            longest.push_back(momenta_.momentum({c, side * reach * Eigen::Vector2d::Unit(k)}));
          }
        }
      }
      const std::vector<double> ends = ray_ends(
          dynamics_, from_, momenta_from(first), longest, options_.length, options_.threads);
      std::copy(ends.begin(), ends.end(), ends_.begin() + static_cast<long>(first) * n_);
    } else {
      times_.resize(last, kUnknown);
      for_all(first, last, [&](int i) {
        if (!go_on()) return;
        const Ray ray(dynamics_, from_, momentum(i));
        ConjugatePoint point;
        if (options_.what == FrontKind::kCut) {
          point.t = cuts_[i].t;
        } else {
          point = conjugate_point(ray, horizon_, options_.order);
        }
        times_[i] = point.t;
        if (!(point.t <= kFarthest * options_.length)) return;
        if (point.q.empty()) point.q = ray.follow(point.t).z;
        if (point.q.empty()) return;
        std::copy_n(point.q.begin(), n_, ends_.begin() + static_cast<long>(i) * n_);
      });
    }
    if (!scale_.is_measured()) scale_.measure(ends_, n_);
    for (int i = first; i < last; ++i) {
      surface_.vertices[i].image = scale_.image(&ends_[static_cast<std::size_t>(i) * n_]);
    }
    return go_on();
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
    if (!make_images(0)) return false;
    leave_inside();
    return true;
  }

  // What is outside is not seen, but for what borders on the inside.
  void leave_inside() {
    std::erase_if(surface_.triangles, [&](const auto& t) {
      return std::none_of(t.begin(), t.end(), [&](int i) { return is_inside(i); });
    });
    std::erase_if(surface_.segments,
                  [&](const auto& s) { return !is_inside(s[0]) && !is_inside(s[1]); });
  }

  [[nodiscard]] std::vector<int> every_vertex() const {
    std::vector<int> all(surface_.vertices.size());
    std::iota(all.begin(), all.end(), 0);
    return all;
  }

  // Of the mesh as it is.
  bool find_cuts() {
    const std::vector<int> seeds = seeds_.empty() ? every_vertex() : seeds_;
    return cuts_.add(momenta_from(0), surface_.neighbours(), seeds, checked()) && go_on();
  }
  // So many rays of a mesh are searched once more.
  [[nodiscard]] int checked() const { return momenta_.dimension() == 1 ? 4 : 16; }

  // Whether a vertex belongs to the surface.
  [[nodiscard]] bool is_inside(int i) const {
    if (options_.what == FrontKind::kFront) return true;
    if (options_.what == FrontKind::kSphere) return cuts_[i].t >= options_.length;
    return times_[i] <= options_.length;
  }

  // Middles of edges are beside a section.
  void settle(int first) {
    if (!section_) return;
    const int last = static_cast<int>(surface_.vertices.size());
    astray_.resize(last, 0);
    for_all(first, last, [&](int i) {
      if (go_on()) astray_[i] = section_->settle(surface_.vertices[i].place) ? 0 : 1;
    });
  }

  // Of places on a border the cut times are found already.
  bool make(int first, const std::vector<Between>& parents, std::vector<CutValue> found = {}) {
    settle(first);
    if (needs_cuts()) {
      std::vector<std::pair<int, int>> pairs;
      pairs.reserve(parents.size());
      for (const Between& place : parents) pairs.emplace_back(place.a, place.b);
      if (!cuts_.add_between(momenta_from(first), pairs, std::move(found))) return false;
    }
    return make_images(first);
  }

  // Curves cost little, and their kinks are seen.
  [[nodiscard]] double part_of_curves() const { return momenta_.dimension() == 1 ? 0.25 : 1; }
  [[nodiscard]] double longest_edge() const { return part_of_curves() * options_.edge; }

  bool refined() {
    constexpr double kShortest = 0.125;
    const double edge = longest_edge();
    SurfaceRefinement how{
        edge, part_of_curves() * options_.angle, kShortest * edge, options_.most, {}};
    how.make = [this](int first, const std::vector<Between>& parents) {
      if (!make(first, parents)) return false;
      leave_inside();
      return true;
    };
    rough_ = refine(how, surface_);
    leave_astray();
    return rough_ >= 0;
  }

  // Takes triangles away whose corners are not on a section.
  void leave_astray() {
    std::erase_if(surface_.triangles, [&](const auto& t) {
      return std::any_of(t.begin(), t.end(), [&](int i) {
        return i < static_cast<int>(astray_.size()) && astray_[i] != 0;
      });
    });
  }

  // The cut time at a place on an edge. The known places on either side of it lead there, and it
  // becomes one of them where it has a partner. Others lead nowhere, and beside an abnormal
  // extremal conjugate times jump.
  double cut_time_at(double part, std::vector<double> p, std::map<double, CutRay>& known) {
    auto after = known.lower_bound(part);
    if (after == known.end()) --after;
    const auto before = after == known.begin() ? after : std::prev(after);
    CutRay found{std::move(p), {}};
    found.value = cuts_.beside(found.p, before->second, after->second);
    const double t = found.value.t;
    const bool leads = found.value.known && !found.value.partner.p.empty();
    if (leads) known.insert_or_assign(part, std::move(found));
    return t;
  }

  // Finds the place on an edge where the time is the length and, of a sphere, the value there.
  CutValue locate(Between& place) {
    constexpr double kEnough = 1e-13;    // of the edge
    constexpr double kRoundOff = 1e-13;  // of the length
    const double wanted = 1 / options_.length;
    const auto time = [&](int i) { return needs_cuts() ? cuts_[i].t : times_[i]; };
    std::map<double, CutRay> known;
    if (needs_cuts()) known = {{0, cuts_.cut_ray(place.a)}, {1, cuts_.cut_ray(place.b)}};
    const auto rate_at = [&](double part) {
      const SurfaceVertex trial = surface_.between({place.a, place.b, part});
      const std::vector<double> p = momenta_.momentum(trial.place);
      const double t = needs_cuts()
                           ? cut_time_at(part, p, known)
                           : conjugate_time(Ray(dynamics_, from_, p), horizon_, options_.order);
      const double rate = 1 / t - wanted;
      return std::optional(std::abs(rate) <= kRoundOff * wanted ? 0 : rate);
    };
    constexpr double kMet = 1e-6;  // relative: what is further off is a jump
    constexpr int kHalvings = 3;
    const double inside = 1 / time(place.a) - wanted;
    const double outside = 1 / time(place.b) - wanted;
    double found = outside;
    const auto watched = [&](double part) {
      const auto rate = rate_at(part);
      found = rate.value_or(found);
      return rate;
    };
    place.part = illinois(0, inside, 1, outside, kEnough, watched);
    // Where the edge crosses an abnormal extremal times jump up, and the border is before that.
    for (int i = 0; needs_cuts() && i < kHalvings && !(std::abs(found) <= kMet * wanted); ++i) {
      const double middle = 0.5 * place.part;
      const auto rate = watched(middle);
      if (!rate || *rate <= 0) break;
      place.part = illinois(0, inside, middle, *rate, kEnough, watched);
    }
    const auto last = known.find(place.part);
    return last == known.end() ? CutValue{} : std::move(last->second.value);
  }

  // Leaves the inside, with its border and, of a sphere, sewn.
  bool cut_out() {
    if (options_.what == FrontKind::kFront) return true;
    const int count = static_cast<int>(surface_.vertices.size());
    std::vector<bool> inside(count);
    // What was left out before borders on the outside only.
    const std::vector<bool> border = surface_.on_border();
    for (int i = 0; i < count; ++i) {
      inside[i] = is_inside(i);
      open_at_bound_ = open_at_bound_ || (inside[i] && border[i]);
    }
    std::vector<CutValue> found;
    clip(
        inside,
        [&](std::vector<Between>& places) {
          found.resize(places.size());
          for_all(0, static_cast<int>(places.size()), [&](int k) {
            if (go_on()) found[k] = locate(places[k]);
          });
        },
        [&](int first, const std::vector<Between>& parents) {
          border_ = first;
          return make(first, parents, found);
        },
        surface_);
    return go_on();
  }

  // Of the mesh before it is cut at R: lines may cross its border.
  bool made_cusps(FrontMesh& mesh) {
    if (!options_.cusps) return true;
    const CausticLines lines = caustic_lines(
        {dynamics_,
         from_,
         momenta_,
         surface_,
         times_,
         [this](const UnitMomentum& at) {
           return conjugate_time(
               Ray(dynamics_, from_, momenta_.momentum(at)), horizon_, options_.order);
         },
         options_.length,
         options_.threads,
         [this] { return go_on(); }});
    for (const CuspLine& line : lines.cusps) {
      CuspEdge edge{{}, line.closed, line.first_umbilic, line.last_umbilic};
      for (const CausticPoint& point : line.points) {
        edge.points.push_back(vertex_at(point.at, point.t, FrontLabel::kCusp));
      }
      mesh.cusps.push_back(std::move(edge));
    }
    for (const Umbilic& one : lines.umbilics) {
      const FrontLabel label =
          one.hyperbolic ? FrontLabel::kHyperbolicUmbilic : FrontLabel::kEllipticUmbilic;
      mesh.umbilics.push_back(vertex_at(one.at, one.t, label));
    }
    for (const Swallowtail& one : lines.swallowtails) {
      mesh.swallowtails.push_back(vertex_at(one.at, one.t, FrontLabel::kSwallowtail));
    }
    return lines.finished;
  }

  [[nodiscard]] FrontVertex vertex_at(const UnitMomentum& at, double t, FrontLabel label) const {
    FrontVertex vertex;
    vertex.p0 = momenta_.momentum(at);
    vertex.conjugate_time = t;
    vertex.label = label;
    const Ray ray(dynamics_, from_, vertex.p0);
    vertex.q = ray.follow(t).z;
    vertex.q.resize(n_, kUnknown);
    return vertex;
  }

  // Whether cut times are asked for that the mesh itself does not need.
  [[nodiscard]] bool adds_cuts() const { return options_.times && !needs_cuts(); }
  bool made_times() {
    if (!adds_cuts()) return true;
    auto values = cuts_.of_mesh(momenta_from(0), surface_.neighbours(), checked());
    if (!values) return false;
    added_cuts_ = std::move(*values);
    return go_on();
  }

  void sew_sphere(FrontMesh& mesh) {
    std::vector<BorderVertex> border;
    for (int i = border_; i < static_cast<int>(surface_.vertices.size()); ++i) {
      const CutValue& value = cuts_[i];
      BorderVertex one{i, value.at_conjugate || value.partner.p.empty(), {}};
      if (!one.at_conjugate) one.partner = momenta_.place(value.partner.p);
      border.push_back(one);
    }
    std::vector<int> classes = sew(
        border,
        [&](int first, const std::vector<int>& of) {
          cuts_.add_partners(of);
          (void)make_images(first);
        },
        surface_);
    seam_end_ = static_cast<int>(surface_.vertices.size());
    const auto make_middles = [this](int first, const std::vector<Between>& parents) {
      return make(first, parents);
    };
    (void)cut_edges(doubled_edges(classes, surface_), make_middles, surface_);
    while (classes.size() < surface_.vertices.size()) {
      classes.push_back(static_cast<int>(classes.size()));
    }
    Surface whole{{}, surface_.triangles, surface_.segments};
    merge(classes, whole);
    const Topology topology = topology_of(whole);
    mesh.closed = topology.closed;
    mesh.euler = topology.euler;
    if (mesh.closed) {
      mesh.volume = n_ == 2 ? enclosed_area(dynamics_, surface_, ends_, momenta_.has_line())
                            : enclosed_volume(dynamics_, surface_, ends_);
    }
    // In one place only what has the same image: angles may have turned once more.
    constexpr double kSamePlace = 1e-7;
    std::vector<int> same = classes;
    for (std::size_t i = 0; i < same.size(); ++i) {
      const auto& a = surface_.vertices[i].image;
      const auto& b = surface_.vertices[classes[i]].image;
      for (std::size_t k = 0; k < a.size(); ++k) {
        if (!(std::abs(a[k] - b[k]) <= kSamePlace)) same[i] = static_cast<int>(i);
      }
    }
    merge(same, surface_);
  }

  void deliver(FrontMesh& mesh) {
    if (options_.what == FrontKind::kSphere && n_ <= 3) sew_sphere(mesh);
    std::vector<int> kept;
    drop_unused(surface_, kept);
    mesh.vertices.resize(kept.size());
    for_all(0, static_cast<int>(kept.size()), [&](int k) {
      const int i = kept[k];
      FrontVertex& vertex = mesh.vertices[k];
      const auto end = ends_.begin() + static_cast<long>(i) * n_;
      vertex.q.assign(end, end + n_);
      vertex.p0 = momentum(k);
      fill_times(i, vertex);
    });
    mesh.triangles = surface_.triangles;
    mesh.segments = surface_.segments;
  }

  [[nodiscard]] FrontLabel seam_label(const CutValue& cut, const std::vector<double>& p0) const {
    if (cut.at_conjugate || cut.partner.p.empty()) return FrontLabel::kConjugate;
    return maxwell_label(Ray(dynamics_, from_, p0), cut.t, cut.partner);
  }

  void fill_times(int i, FrontVertex& vertex) const {
    constexpr std::array kLabels{
        FrontLabel::kFront, FrontLabel::kSphere, FrontLabel::kCaustic, FrontLabel::kCut};
    vertex.label = kLabels[static_cast<int>(options_.what)];
    if (needs_cuts() || adds_cuts()) {
      const CutValue& cut = needs_cuts() ? cuts_[i] : added_cuts_[i];
      vertex.cut_time = cut.t;
      vertex.conjugate_time = cut.conjugate;
    }
    if (needs_cuts()) {
      const bool on_seam =
          options_.what == FrontKind::kCut || (border_ >= 0 && i >= border_ && i < seam_end_);
      if (on_seam) vertex.label = seam_label(cuts_[i], vertex.p0);
    }
    if (options_.what == FrontKind::kCaustic) vertex.conjugate_time = times_[i];
  }

  [[nodiscard]] std::string beyond_bound() const {
    std::ostringstream text;
    text.precision(4);
    text << "left out: momenta ";
    if (!section_) {
      text << "beyond " << bound_ << " along their line";
    } else if (options_.bound > 0) {
      text << "beyond " << options_.bound << " in their plane";
    } else {
      text << "whose extremals are conjugate at the length "
           << part_of_front(options_) * options_.length;
    }
    return text.str();
  }

  [[nodiscard]] std::string left_out() const {
    Omissions omissions;
    if (options_.what == FrontKind::kSphere && open_at_bound_) {
      omissions.add() << beyond_bound() << ", of which some are still those of shortest paths: the "
                      << "sphere is open there";
    }
    if (options_.what != FrontKind::kSphere && momenta_.has_line()) {
      std::ostream& text = omissions.add();
      text << beyond_bound();
      if (!at_length() && least_part_ > 0) {
        text << ", where " << (least_part_ > kOfTimes ? "half of the " : "") << "times are below "
             << least_part_ * options_.length;
      }
    }
    if (may_have_abnormal_curves(BoundaryValueProblem(dynamics_, from_, from_, 1))) {
      omissions.add() << "abnormal curves start here: beside their ends momenta grow beyond all "
                      << "bounds, and what these lead to is left out";
    }
    const double from = options_.what == FrontKind::kSphere ? options_.length : 0;
    omissions.add_unknown_cuts(cuts_.unknown(from));
    if (const auto count = std::count(astray_.begin(), astray_.end(), 1); count > 0) {
      omissions.add() << "holes about " << count << " places that are not led to the section: it "
                      << "bends there more sharply than the mesh tells";
    }
    if (rough_ > 0) {
      omissions.add() << rough_
                      << " edges are longer or sharper than asked for: more vertices were needed";
    }
    return omissions.text();
  }

  // Times are followed to here, so that what borders on the surface has an image, too.
  static constexpr double kMargin = 1.5;
  static constexpr double kOfTimes = 0.125;  // of R: what is earlier is left out of a chosen bound
  static constexpr double kFarthest = 2;     // where images are still made

  const Dynamics& dynamics_;
  const std::vector<double>& from_;
  const FrontOptions& options_;
  int n_;
  UnitMomenta momenta_;
  ImageScale scale_;
  double horizon_;
  CutValues cuts_;
  std::optional<EndSection> section_;  // by a condition on the ends
  Surface surface_;
  std::vector<int> seeds_;  // vertices of the first mesh that may be searched; empty: all
  double bound_ = 0;
  double least_part_ = 0;                           // of R, that ends at a chosen bound; 0: unknown
  std::vector<double> ends_;                        // q of each vertex
  std::vector<double> times_;                       // of each vertex, of a caustic or a cut locus
  int border_ = -1;                                 // the first vertex of the border
  int seam_end_ = std::numeric_limits<int>::max();  // vertices from here on are inside
  bool open_at_bound_ = false;                      // some extremals are still inside there
  long rough_ = 0;
  std::vector<CutValue> added_cuts_;  // of each vertex, where the mesh itself does not need them
  std::vector<char> astray_;          // whether a vertex of a section is not on it
  std::atomic<bool> stopped_{false};
};

}  // namespace

FrontMesh make_front(const Dynamics& dynamics,
                     const std::vector<double>& from,
                     const FrontOptions& options) {
  return FrontMaker(dynamics, from, options).run();
}

}  // namespace carnot::internal
