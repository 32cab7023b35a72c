// Many problems, each solved as find_geodesics() alone would solve it.
//
//   solve_many({10000, [&](long i) { return problem(i); }}, options, [&](long first, auto reports)
//   {
//     ...
//     return true;
//   });
//
// Each thread solves a chunk of problems at a time and asks for the next. What is found for problem
// i depends on the problem and the seed only: not on the threads, and not on the other problems.
#pragma once

#include <functional>
#include <span>
#include <vector>

#include "carnot/shooting/find_geodesics.h"

namespace carnot {

struct ManyProblems {
  long count = 0;
  // Problem i, 0 <= i < count. Called from many threads. Where it throws std::invalid_argument, as
  // where find_geodesics() does, the report has Reason::kIrregularEnd and the message.
  std::function<BoundaryValueProblem(long i)> at;
};

struct ManyOptions {
  GeodesicOptions each;  // but for `threads` and `progress`, which are of the whole
  int threads = 0;       // 0: all cores
  long chunk = 16;       // problems
  // The next chunk to solve, k for the problems k * chunk and on; -1: there are no more. Called by
  // many threads. Empty: all of them, in their order.
  std::function<long()> next;
  Progress progress;  // fraction of chunks done; returns false to stop
};

// Told the reports of a chunk that is done, which begins with problem `first`: in no fixed order,
// but never from two threads at once. Returns false to stop.
using ReportSink = std::function<bool(long first, std::span<const GeodesicReport> reports)>;

// False when stopped: then the chunks in hand are dropped. Throws std::invalid_argument on bad
// options; what else a function of the caller throws is thrown again when all threads have ended.
// Memory: the reports of a chunk for each thread.
bool solve_many(const ManyProblems& problems, const ManyOptions& options, const ReportSink& sink);

}  // namespace carnot
