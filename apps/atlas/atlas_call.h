// What a call of `carnot atlas` asks, and how its journal tells it from others.
#pragma once

#include <string>

#include "atlas/journal.h"
#include "atlas/problem_list.h"
#include "run/search_options.h"
#include "run/subcommands.h"
#include "text/json_text.h"

namespace carnot::apps {

struct AtlasCall {
  RunOptions run;
  ListOptions list;
  SearchOptions search;
  std::string output;
  std::string trajectories = "0";
  bool resume = false;
  bool no_times = false;
  bool field = false;
  std::string branches = "1";
  std::string check = "100";
};

// What a result says of its call, with the list as `problems` says.
Json identity_of(const AtlasCall& call, const Run& run, Json problems);

// What the journal says of it: this, and how many problems are a chunk. One that was begun with a
// shorter list keeps its chunks.
JournalCall journal_call(const AtlasCall& call, const Run& run, const ProblemList& list);

}  // namespace carnot::apps
