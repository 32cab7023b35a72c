// What the midpoint transcription asks of a scene, as functions on plain numbers.
#pragma once

namespace carnot {

// What the numbers of a gauge are in; see TranscriptionFunctions.
struct GaugeUnits {
  const double* q = nullptr;  // n units, of velocities and multipliers; null: one
  double weight = 1;          // kappa
};

// How many points stand side by side in the calls that take packs of them. Number i of point l is
// at i * kTranscriptionLanes + l there.
inline constexpr int kTranscriptionLanes = 8;

// All arrays belong to the caller. q and v have n entries, lambda has k.
struct TranscriptionFunctions {
  int dof = 0;          // n
  int constraints = 0;  // k
  // Rows of G depend on each other: G is an orthogonal projector, and P = kappa (I - G) is the
  // gauge. In which units of the coordinates it is orthogonal may be chosen; velocities and
  // multipliers are then in these units, too. What is no gauge has no such units.
  bool gauge = false;

  // The entries of M at or below its diagonal, row by row, then those of G, row by row, then V: all
  // at q. With slopes each of them is the first number of a row of row_length(n), its n derivatives
  // by q are the next ones, and zeros fill the row.
  void (*entries)(const void* system,
                  const double* q,
                  const GaugeUnits& units,
                  bool slopes,
                  double* out) = nullptr;
  // The second derivatives by q, n x n, of l = v'M v/2 - V - lambda'G v - lambda'P lambda/2, where
  // P is zero without a gauge.
  void (*hessian)(const void* system,
                  const double* q,
                  const double* v,
                  const double* lambda,
                  const GaugeUnits& units,
                  double* l_qq) = nullptr;

  // The entries of kTranscriptionLanes points side by side. With slopes each of them is followed by
  // its n derivatives, and nothing fills the rows. Null where the formulas do not run on packs.
  void (*packed_entries)(const void* system,
                         const double* q,
                         const GaugeUnits& units,
                         bool slopes,
                         double* out) = nullptr;
  // The second derivatives of kTranscriptionLanes points side by side; null where packed_entries
  // is.
  void (*packed_hessian)(const void* system,
                         const double* q,
                         const double* v,
                         const double* lambda,
                         const GaugeUnits& units,
                         double* l_qq) = nullptr;
};

// How many entries there are.
inline int entry_count(const TranscriptionFunctions& f) {
  return f.dof * (f.dof + 1) / 2 + f.constraints * f.dof + 1;
}

// The length of a row that holds a value and its n derivatives: one of a few, whole packs all, that
// the compiler knows.
inline constexpr int kLongestRow = 64;
constexpr int row_length(int n) { return n < 8 ? 8 : n < 16 ? 16 : kLongestRow; }

}  // namespace carnot
