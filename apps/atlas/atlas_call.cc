#include "atlas/atlas_call.h"

#include <algorithm>
#include <utility>

#include "text/version.h"

namespace carnot::apps {
namespace {

// Of which a record of the journal consists. Enough for its cost not to count, few enough for a
// kill not to cost much.
long chunk_of(long problems) {
  constexpr long kLargest = 16;
  constexpr long kChunks = 256;
  return std::clamp(problems / kChunks, 1L, kLargest);
}

}  // namespace

Json identity_of(const AtlasCall& call, const Run& run, Json problems) {
  const SearchOptions& search = call.search;
  return {{"version", kVersion},
          {"scene", run.entry->info.name},
          {"text", run.entry->text},
          {"parameters", parameters_json(run)},
          {"method", run.method.name},
          {"seed", run.seed},
          {"options",
           {{"count", search.count},
            {"all", search.all},
            {"max_length", search.max_length},
            {"starts", search.starts},
            {"tolerance", search.tolerance},
            {"minimiser", search.minimiser},
            {"time_limit", search.time_limit},
            {"mod_angles", search.mod_angles},
            {"limits", search.asked.limits},
            {"discs", search.asked.discs},
            {"trajectories", call.trajectories},
            {"field", call.field},
            {"branches", call.branches},
            {"check", call.check}}},
          {"problems", std::move(problems)}};
}

JournalCall journal_call(const AtlasCall& call, const Run& run, const ProblemList& list) {
  const auto words = [&call, &run](const Json& problems, const Json& chunk) {
    Json json = identity_of(call, run, problems);
    json["chunk"] = chunk;
    return json;
  };
  const auto chunk_in = [](const Json& there) { return there.value("chunk", Json(nullptr)); };
  JournalCall journal;
  journal.words = words(list.identity(), chunk_of(list.size()));
  journal.then = [=, &list](const Json& there) {
    return words(list.identity_then(there.value("problems", Json::object())), chunk_in(there));
  };
  journal.now = [=, &list](const Json& there) { return words(list.identity(), chunk_in(there)); };
  return journal;
}

}  // namespace carnot::apps
