// The ends of a geodesic as they are typed: numbers, and * where a coordinate is free.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "carnot/shooting/boundary_value_problem.h"
#include "run/run_options.h"

namespace carnot::apps {

struct Ends {
  std::vector<double> from;  // for a free coordinate: where the search begins to look
  std::vector<double> to;
  std::vector<bool> free_from;  // of length n
  std::vector<bool> free_to;
  double time = 1;
  std::vector<Limit> limits;
};

// Of --from, --to and --time. Throws std::invalid_argument where one is missing, malformed,
// singular or not on the manifold of the scene.
Ends parse_ends(const std::string& from,
                const std::string& to,
                const std::string& time,
                const Run& run);

// Of two ends as they were read, with nothing where a coordinate is free.
Ends ends_of(const std::vector<std::optional<double>>& from,
             const std::vector<std::optional<double>>& to);

// A configuration for `option` with the same free coordinates as an end that is known, whose values
// it takes there.
std::vector<double> parse_same_end(std::string_view option,
                                   const std::string& text,
                                   const Run& run,
                                   const std::vector<double>& end,
                                   const std::vector<bool>& free);

// Throws std::invalid_argument where an end is singular, not on the manifold of the scene, or free
// where the manifold ties it to others.
void check_ends(const Ends& ends, const Dynamics& dynamics);

bool has_free(const Ends& ends);

BoundaryValueProblem problem_between(const Dynamics& dynamics, const Ends& ends);

// With null, or *, for free coordinates.
Json end_json(const std::vector<double>& end, const std::vector<bool>& free);
std::string end_text(const std::vector<double>& end, const std::vector<bool>& free);

}  // namespace carnot::apps
