// The work on a field: searches, spreads from neighbour to neighbour, and checks, until neighbours
// explain what is known.
//
// Seeds are searched and spread. Then come points that neighbours promised less in vain or that
// nothing is known of, then those that are much farther than a neighbour, then a random sample;
// what these searches improve is spread, too. All partners do all of this, but for searches, slabs
// and points to verify, of which each does its part. Between any two of these steps, and between
// sweeps, the state can be written, and the work be gone on with from there.
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <istream>
#include <optional>
#include <ostream>
#include <vector>

#include "carnot/shooting/field.h"
#include "carnot/shooting/field/field_grid.h"
#include "carnot/shooting/field/field_partners.h"
#include "carnot/shooting/field/field_searches.h"
#include "carnot/shooting/field/field_sweep.h"
#include "carnot/shooting/problem/natural_scales.h"

namespace carnot::internal {

class FieldSolver {
 public:
  // In the units of the scene. Keeps references.
  FieldSolver(const BoundaryValueProblem& problem,
              const FieldGrid& grid,
              const FieldOptions& options);

  // Throws DamagedState.
  Field run();

 private:
  static constexpr std::size_t kFewestJumps = 16;
  enum class Phase : std::int8_t { kSeeds, kDoubts, kJumps, kCheck, kDone };
  // Where the work is.
  struct Course {
    Phase phase = Phase::kSeeds;
    bool spreading = false;  // before anything else
    bool settled = true;
    bool in_vain = false;                // the last sample of doubted points had hardly any less
    std::size_t at_once = kFewestJumps;  // points beyond jumps that are searched
    int round = 0;                       // of the check
    long searches = 0;
    long triangles = 0;
    long violations = 0;
    long checked = 0;
    long lower = 0;
  };
  // What came of searches of points.
  struct Searched {
    std::size_t known = 0;  // before
    std::size_t less = 0;   // of these had less
  };

  // False where it was stopped, as of all that follow.
  bool work();
  bool search_on();
  bool search_seeds();
  // A sample of the points that neighbours promised less in vain, until hardly any of a sample has
  // less; and all that nothing is known of.
  bool search_doubts();
  // Points that are much farther than a neighbour, the farthest first, and as long as enough of
  // them had less.
  bool search_jumps();
  // A random sample, searched with another seed, and the triangles between it and neighbours. What
  // is lower is spread, and another sample drawn.
  bool check();
  // From neighbour to neighbour and across the mirrors of the scene.
  bool spread();
  // Whether this process need not stop. Only what the partners agree on ends the work.
  bool go_on();

  [[nodiscard]] GeodesicOptions searching(std::uint64_t seed);
  FieldSearches::Reports search(const std::vector<long>& points, std::uint64_t seed);
  // Searches points, each of them once, and asks for a spread where that gave news; nothing where
  // it was stopped.
  std::optional<Searched> improve(const std::vector<long>& points);
  // Keeps what was found, and gives it to the sweep. Whether any of it was better than what that
  // had.
  bool take(const FieldSearches::Reports& reports);
  // What searches gave to these points, and to those that violate a triangle.
  FieldSearches::Reports check(const std::vector<long>& sample, std::uint64_t seed);

  // In the units of the scene; infinite where nothing is known.
  [[nodiscard]] double action_of(long i) const;
  // The same, verified. Without packs a sweep takes few steps: vehicles on a grid of
  // 11 x 11 x 12 x 12 points then have actions that are good to 1e-5, which is enough to tell one
  // way from another, but no answer.
  [[nodiscard]] double verified_action_of(long i);
  // At the ends, in the units of the scene.
  [[nodiscard]] double allowed_error() const;

  // Fills what is asked of all points: verifies them, and searches those that do not pass.
  bool answer(Field& field);
  void verify(Field& field);
  // The errors at the ends of all points that are known, of which each of the partners tells some.
  void verify_parts(std::vector<double>& errors);
  // Whether what a search found has less action, also if its end were exact. One of 968,256
  // vehicles had 1e-8 less than its mirror image otherwise: it needs momenta of 300, and points of
  // a field are more exact than searches.
  static bool is_less(const FieldFind& found, double action);
  // What a search says of point i, where that is better; at the start, the path that does not move.
  void settle(long i, Field& field) const;

  void keep() const;
  // Reads what is to be gone on from, if anything; the partners that of rank 0.
  void read_state();
  // What a state must be of.
  [[nodiscard]] std::vector<double> identity() const;
  void write(std::ostream& out) const;
  void read(std::istream& in);

  const BoundaryValueProblem& own_;
  const FieldOptions& options_;
  const FieldGrid& own_grid_;
  FieldPartners partners_;
  NaturalScales scales_;
  BoundaryValueProblem scaled_;
  FieldGrid grid_;
  FieldSweep sweep_;
  FieldSearches searches_;
  std::vector<Label> labels_;  // of seeds
  Course course_;
  std::atomic<double> known_{0};
};

}  // namespace carnot::internal
