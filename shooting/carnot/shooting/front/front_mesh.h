// What is asked of a front, and the mesh that is the answer (wavefront.h).
#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "carnot/dynamics.h"
#include "carnot/shooting/front/end_condition.h"

namespace carnot {

// What is drawn of the extremals from one place: their ends, those of the shortest paths, their
// first conjugate points, or where they stop being shortest paths.
enum class FrontKind { kFront, kSphere, kCaustic, kCut };

// What a vertex is: one of what was asked for, or more than that.
enum class FrontLabel {
  kFront,
  kSphere,
  kCaustic,
  kCut,
  // On the seam of a sphere and on a cut locus: neighbours arrive, or another extremal does, which
  // no symmetry of the scene makes of this one, or which one makes.
  kConjugate,
  kMaxwell,
  kMaxwellByMirror,
  kMaxwellByReversal,
  kMaxwellByMirrorAndReversal,
  // Singular points of a caustic.
  kCusp,
  kSwallowtail,
  kHyperbolicUmbilic,
  kEllipticUmbilic,
  kUnknown,  // on the section of a sphere: no extremal was found
};
inline constexpr int kFrontLabels = 14;
const char* name_of(FrontLabel label);
// Whether two extremals meet there.
bool is_maxwell(FrontLabel label);

struct FrontOptions {
  FrontKind what = FrontKind::kFront;
  double length = 1;                            // R
  std::vector<std::pair<int, double>> fixed{};  // momenta p_j(0)
  // What holds at all ends: of a front whose momenta are a circle times a plane, or of a sphere in
  // four coordinates, which is then the places of the section at the distance R. Angles that differ
  // by whole turns agree on a front, and do not on a sphere.
  std::optional<EndCondition> section{};
  int order = 1;       // of a caustic: the k-th conjugate points, with multiplicity
  bool cusps = false;  // cusp lines and umbilics of a caustic
  // The three coordinates that are seen. Empty: the first ones, but for the one that a section
  // tells.
  std::vector<int> project{};
  // The longest edge and, in radians, the largest angle between neighbouring triangles, in
  // coordinates that are 1 wide; of curves a quarter of both. Edges are not cut for an angle below
  // an eighth of the longest.
  double edge = 0.1;
  double angle = 0.35;
  int most = 100000;  // vertices
  double bound = 0;   // of the coordinates along the line or in the plane; 0: chosen
  // Cut and conjugate times at all vertices. Without it a front has none, a caustic has the
  // conjugate times, the section of a sphere has the cut times of its seam only.
  bool times = false;
  bool mod_angles = true;
  std::vector<double> signs{};  // under which places are one, as in cut_time.h
  std::uint64_t seed = 0;
  int threads = 0;    // 0: all cores
  Progress progress;  // returns false to stop
};

// NaN where a time was not asked for, infinite where there is none up to 1.5 R.
struct FrontVertex {
  std::vector<double> q;
  std::vector<double> p0;  // of unit speed
  double cut_time = std::numeric_limits<double>::quiet_NaN();
  double conjugate_time = std::numeric_limits<double>::quiet_NaN();
  FrontLabel label = FrontLabel::kFront;
};

// Where a caustic has a sharp edge, point after point. It may end at umbilics, where it goes over
// to the next sheet, that of another order: these are the ends of `points`, and here are their
// places in FrontMesh::umbilics; -1 where it ends elsewhere.
struct CuspEdge {
  std::vector<FrontVertex> points;
  bool closed = false;
  int first_umbilic = -1;
  int last_umbilic = -1;
};

struct FrontMesh {
  bool finished = false;  // false: stopped
  std::string message;    // what the mesh leaves out
  double length = 0;
  std::vector<FrontVertex> vertices;
  std::vector<std::array<int, 3>> triangles;
  std::vector<std::array<int, 2>> segments;  // with two coordinates, instead of triangles
  std::vector<CuspEdge> cusps;               // where they are asked for
  std::vector<FrontVertex> umbilics;         // where two sheets of a caustic meet
  std::vector<FrontVertex> swallowtails;     // where a cusp line has a cusp; good to 1e-6
  // Whether each edge is in two triangles (each vertex in two segments), and then the Euler
  // characteristic and the area or the volume inside: with two or three coordinates, and of the
  // section of a sphere in those that are left.
  bool closed = false;
  int euler = 0;
  double volume = std::numeric_limits<double>::quiet_NaN();
  long searches = 0;
  double elapsed_seconds = 0;
};

// The coordinates that are seen of a mesh: two or three.
std::vector<int> seen_coordinates(const Dynamics& dynamics, const FrontOptions& options);

}  // namespace carnot
