#include "carnot/shooting/front/section_mesh.h"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "carnot/numerics/parallel.h"
#include "carnot/shooting/front/cut_values.h"
#include "carnot/shooting/front/maxwell_label.h"
#include "carnot/shooting/front/omissions.h"
#include "carnot/shooting/front/seam.h"
#include "carnot/shooting/front/section_sphere.h"
#include "carnot/shooting/front/surface.h"
#include "carnot/shooting/front/unit_momenta.h"
#include "carnot/shooting/problem/turn_rates.h"
#include "carnot/shooting/rays/conjugate_time.h"
#include "carnot/shooting/rays/ray.h"

namespace carnot::internal {
namespace {

constexpr double kHorizon = 1.5;  // lengths, that times are followed to

// Whether places may be as near whose angles agree but for whole turns.
bool may_turn(const Dynamics& dynamics,
              const std::vector<double>& from,
              const EndCondition& condition,
              double length) {
  const double period = dynamics.info.configuration[condition.coordinate].period;
  if (period == 0) return false;
  const std::vector<double> rates = turn_rates({dynamics, from, from, length});
  double rate = rates[condition.coordinate];
  if (condition.equal >= 0) rate += rates[condition.equal];
  return !(rate * length < period - std::abs(condition.value));
}

// The cut times of all vertices whose momenta are known, from neighbour to neighbour. Those on the
// seam are known already. Adds to `searches`, and to `omissions` what is not found. False when
// stopped.
bool find_cut_times(const Dynamics& dynamics,
                    const std::vector<double>& from,
                    const FrontOptions& options,
                    FrontMesh& mesh,
                    Omissions& omissions) {
  constexpr int kChecked = 16;  // rays, that are searched once more
  std::vector<std::vector<double>> momenta;
  for (const FrontVertex& vertex : mesh.vertices) momenta.push_back(vertex.p0);
  const auto is_known = [&](int i) { return !std::isnan(momenta[i][0]); };
  Surface surface;
  surface.vertices.resize(momenta.size());
  for (const auto& t : mesh.triangles) {
    if (std::all_of(t.begin(), t.end(), is_known)) surface.triangles.push_back(t);
  }
  CutValues cuts(dynamics,
                 from,
                 UnitMomenta(dynamics, from, options.fixed, true),
                 {kHorizon * options.length,
                  false,  // nor do angles agree by whole turns on the section
                  options.signs,
                  options.seed,
                  options.threads,
                  options.progress});
  const auto values = cuts.of_mesh(momenta, surface.neighbours(), kChecked);
  mesh.searches += cuts.searches();
  if (!values) return false;
  for (std::size_t i = 0; i < values->size(); ++i) {
    FrontVertex& vertex = mesh.vertices[i];
    if (std::isnan(vertex.cut_time)) vertex.cut_time = (*values)[i].t;
  }
  omissions.add_unknown_cuts(cuts.unknown(0));
  return true;
}

}  // namespace

FrontMesh make_section_mesh(const Dynamics& dynamics,
                            const std::vector<double>& from,
                            const FrontOptions& options) {
  const SectionOptions how{*options.section,
                           options.length,
                           options.edge,
                           options.seed,
                           options.threads,
                           options.progress};
  SectionSphere sphere = section_sphere(dynamics, from, how);
  FrontMesh mesh;
  mesh.finished = sphere.finished;
  mesh.length = options.length;
  mesh.searches = sphere.searches;
  if (!mesh.finished) return mesh;
  mesh.vertices.resize(sphere.vertices.size());
  parallel_for(static_cast<int>(mesh.vertices.size()), thread_count(options.threads), [&](int i) {
    SphereVertex& one = sphere.vertices[i];
    FrontVertex& vertex = mesh.vertices[i];
    vertex.q = std::move(one.q);
    vertex.p0 = std::move(one.p0);
    vertex.label = FrontLabel::kUnknown;
    if (std::isnan(vertex.p0[0])) return;
    const Ray ray(dynamics, from, vertex.p0);
    vertex.label = FrontLabel::kSphere;
    vertex.conjugate_time = conjugate_time(ray, kHorizon * options.length);
    if (one.other.empty()) return;
    vertex.cut_time = options.length;
    const Rival rival{std::move(one.other), std::vector<double>(vertex.q.size()), options.length};
    vertex.label = maxwell_label(ray, options.length, rival);
  });
  mesh.triangles = std::move(sphere.triangles);
  const Topology topology = topology_of({{}, mesh.triangles, {}});
  mesh.closed = topology.closed && !mesh.triangles.empty();
  mesh.euler = topology.euler;
  if (mesh.closed) mesh.volume = sphere.volume;
  Omissions omissions;
  if (options.times && !find_cut_times(dynamics, from, options, mesh, omissions)) {
    mesh.finished = false;
    return mesh;
  }
  if (mesh.triangles.empty()) {
    omissions.add() << "no place of the section is as near as the length";
  }
  if (sphere.unknown > 0) {
    omissions.add() << "the distances of " << sphere.unknown
                    << " places of the grid are not known, and taken for farther than the length";
  }
  if (sphere.rough > 0) {
    omissions.add() << "no extremals were found to " << sphere.rough
                    << " vertices, which are between two places of the grid";
  }
  if (may_turn(dynamics, from, *options.section, options.length)) {
    omissions.add() << "places whose angles agree but for whole turns are left out";
  }
  mesh.message = omissions.text();
  return mesh;
}

}  // namespace carnot::internal
