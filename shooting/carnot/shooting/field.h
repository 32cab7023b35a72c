// The least action from one start to every point of a grid of targets: what is asked, and the
// answer.
#pragma once

#include <cstdint>
#include <functional>
#include <istream>
#include <ostream>
#include <stdexcept>
#include <string>
#include <vector>

#include "carnot/shooting/find_geodesics.h"

namespace carnot {

// The state that a field is to go on from (FieldOptions::state) is damaged, or that of another
// field.
class DamagedState : public std::invalid_argument {
 public:
  using std::invalid_argument::invalid_argument;
};

// Equidistant values of a coordinate of the target. With mod_angles, values around a whole period
// leave out the repeated end.
struct FieldAxis {
  int coordinate = 0;
  std::vector<double> values;
};

// Processes that work on one field together, say on several machines. Each of them calls
// solve_field() with the same arguments, and has the same field in the end, which is the one that a
// process alone makes. Their processors should be of one kind: those of several kinds round
// differently, and may come to different decisions.
struct FieldTeam {
  int rank = 0;  // of this process, counted from 0
  int size = 1;
  // What each of them gives, in the order of ranks. It is called by all, each from one thread, and
  // returns when all have called it.
  std::function<std::vector<std::string>(const std::string& own)> exchange;
};

struct FieldOptions {
  GeodesicOptions search;  // of the searches; `mod_angles` and `tolerance` are of the whole
  int threads = 0;         // 0: all cores
  // Extremals of least action that are kept for each point, >= 1. One is enough for most scenes.
  // Where a way is the shortest one in two places, and not between them, only a point that keeps
  // another one, too, leads from place to place. Each takes as much time and memory as the first.
  int branches = 1;
  // Points that are searched once more in the end, with another seed, and from which a neighbour is
  // searched for the triangle inequality.
  long check = 100;
  Progress progress;  // fraction of points known; returns false to stop, of a team all of it
  // To go on after an end that was not foreseen: called between sweeps and searches with a function
  // that writes the state of the work, some 300 bytes a point, for the same machine and version. Of
  // a team only rank 0 keeps it, and goes on from it.
  std::function<void(const std::function<void(std::ostream&)>& write)> keep;
  // What it has written in a call with the same arguments. The field becomes the same as if that
  // call had gone on.
  std::istream* state = nullptr;
  FieldTeam team;
};

// Of all points, the first axis slowest. What is not known of a point is NaN.
struct Field {
  bool finished = false;  // false: stopped
  // False where values still fell when the sweeps were ended, after 200 of them; most fields need
  // some ten. They may be too large then, which the checks below tell as of others.
  bool settled = true;
  int dof = 0;
  std::vector<double> action;
  std::vector<double> p0;  // n of each point
  // At the end, of an independent flow: with less tolerance, or twice as many steps, than that
  // which the point was made by. Where searches gave a point at knots only it is the defect there.
  std::vector<double> error;
  std::vector<Verification> verification;
  std::vector<Label> label;    // that of the search that a point was reached from
  std::vector<Reason> reason;  // kNone where it is known

  long searches = 0;  // cold ones, without those of the check
  long pushes = 0;    // neighbours that promised less,
  long improved = 0;  // and that kept it
  long flows = 0;     // tangent flows
  long sweeps = 0;    // of the longest spread
  // Three figures tell how far the field can be trusted. Points to which a neighbour promised less,
  // by more than 1e-6 of it, where Newton's method found nothing: all of them were searched, or
  // fewer than one in 32 of the last sample of them had less;
  long unkept = 0;
  long triangles = 0;   // pairs of neighbours with a path between them that was searched,
  long violations = 0;  // and points that are farther by more than 1e-8 than by way of the other;
  long checked = 0;     // points searched again,
  long lower = 0;       // and where that found less by more than 1e-8, relative
  double bound = 1;     // of the share of such points, with 95 per cent confidence
  long resumed = 0;     // points that the state of an earlier call knew
  double elapsed_seconds = 0;
};

}  // namespace carnot
