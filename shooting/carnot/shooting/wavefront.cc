#include "carnot/shooting/wavefront.h"

#include <chrono>
#include <cmath>
#include <set>
#include <stdexcept>

#include "carnot/shooting/cut_time.h"
#include "carnot/shooting/front/front_maker.h"
#include "carnot/shooting/front/section_mesh.h"
#include "carnot/shooting/front/unit_momenta.h"
#include "carnot/shooting/rays/ray.h"

namespace carnot {

using namespace internal;

namespace {

void refuse_unless(bool ok, const char* what) {
  if (!ok) throw std::invalid_argument(what);
}

void validate(const Dynamics& dynamics,
              const std::vector<double>& from,
              const FrontOptions& options) {
  refuse_unless(static_cast<int>(from.size()) == dynamics.dof,
                "from needs one number for each coordinate");
  refuse_unless(dynamics.dof >= 2, "a front needs two coordinates");
  refuse_unless(dynamics.holonomic == 0 || dynamics.on_leaves,
                "fronts with holonomic constraints are of scenes from text");
  refuse_unless(options.length > 0 && std::isfinite(options.length), "length must be > 0");
  refuse_unless(options.edge > 0 && options.angle > 0, "edge and angle must be > 0");
  refuse_unless(options.bound >= 0 && std::isfinite(options.bound), "bound must be >= 0");
  refuse_unless(options.project.empty() || (options.project.size() == 3 && dynamics.dof >= 3),
                "three coordinates are seen");
  refuse_unless(options.order >= 1, "order must be >= 1");
  refuse_unless(options.order == 1 || options.what == FrontKind::kCaustic,
                "an order is that of a caustic");
  refuse_unless(!options.cusps || (options.what == FrontKind::kCaustic && dynamics.dof >= 3),
                "cusps are those of a caustic in space");
  for (const int j : options.project) {
    refuse_unless(j >= 0 && j < dynamics.dof, "there is no such coordinate");
  }
  std::set<int> fixed;
  for (const auto& [j, value] : options.fixed) {
    refuse_unless(j >= 0 && j < dynamics.dof && std::isfinite(value), "there is no such momentum");
    refuse_unless(fixed.insert(j).second, "a momentum is fixed twice");
  }
  if (!options.section) return;
  const EndCondition& end = *options.section;
  refuse_unless(options.what == FrontKind::kFront || options.what == FrontKind::kSphere,
                "a condition on the ends is one of a front or of a sphere");
  refuse_unless(options.what == FrontKind::kFront || (dynamics.dof == 4 && options.fixed.empty()),
                "the sphere of a section is of a scene with four coordinates");
  refuse_unless(end.coordinate >= 0 && end.coordinate < dynamics.dof && end.equal >= -1 &&
                    end.equal < dynamics.dof && std::isfinite(end.value),
                "there is no such coordinate");
  refuse_unless(end.coordinate != end.equal, "a coordinate is always that which it is");
}

}  // namespace

void check_wavefront(const Dynamics& dynamics,
                     const std::vector<double>& from,
                     const FrontOptions& options) {
  validate(dynamics, from, options);
  const UnitMomenta momenta(dynamics, from, options.fixed, options.section.has_value());
  const std::vector<double> p = momenta.momentum({Eigen::Vector3d::UnitX()});
  (void)validated_speed(dynamics, from, p);
  check_signs(dynamics, from, options.signs);
}

FrontMesh wavefront(const Dynamics& dynamics,
                    const std::vector<double>& from,
                    const FrontOptions& options) {
  const auto began = std::chrono::steady_clock::now();
  check_wavefront(dynamics, from, options);
  const bool of_section = options.section && options.what == FrontKind::kSphere;
  FrontMesh mesh =
      of_section ? make_section_mesh(dynamics, from, options) : make_front(dynamics, from, options);
  const std::chrono::duration<double> elapsed = std::chrono::steady_clock::now() - began;
  mesh.elapsed_seconds = elapsed.count();
  return mesh;
}

}  // namespace carnot
