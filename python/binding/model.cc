#include "model.h"

#include <utility>

#include "carnot/load_scene.h"
#include "catalogue/scene_choice.h"
#include "catalogue/text_entry.h"

namespace carnot::python {
namespace {

using namespace apps;

std::shared_ptr<const SceneEntry> entry_of(const ModelSource& source) {
  if (source.text.empty()) return {std::shared_ptr<const void>(), &find_scene(source.name)};
  const TextScene scene = scene_from_text(source.text, source.name, source.name);
  return std::make_shared<const SceneEntry>(text_entry(scene));
}

Run run_of(const ModelSource& source, const SceneEntry& entry, bool searches) {
  RunOptions options;
  options.set = source.set;
  options.method = source.method;
  options.searches = searches;
  return check(options, entry);
}

Run with_effort(Run run, const Texts& options) {
  RunOptions effort;
  take(options, "samples", effort.samples);
  take(options, "seed", effort.seed);
  take(options, "threads", effort.threads);
  set_effort(effort, run);
  return run;
}

}  // namespace

void take(const Texts& options, const std::string& name, std::string& value) {
  const auto found = options.find(name);
  if (found != options.end()) value = found->second;
}

void take(const Texts& options, const std::string& name, bool& value) {
  const auto found = options.find(name);
  if (found != options.end()) value = found->second == "1";
}

Model::Model(ModelSource source)
    : source_(std::move(source)),
      entry_(entry_of(source_)),
      searching_(run_of(source_, *entry_, true)),
      flowing_(run_of(source_, *entry_, false)),
      limits_(limits_of(search_options({}).asked, searching_)) {}

Run Model::searching(const Texts& options) const { return with_effort(searching_, options); }
Run Model::flowing(const Texts& options) const { return with_effort(flowing_, options); }

SearchOptions Model::search_options(const Texts& options) const {
  SearchOptions search;
  take(options, "count", search.count);
  take(options, "all", search.all);
  take(options, "max-length", search.max_length);
  take(options, "starts", search.starts);
  take(options, "tolerance", search.tolerance);
  take(options, "minimiser", search.minimiser);
  take(options, "time-limit", search.time_limit);
  take(options, "mod-angles", search.mod_angles);
  search.asked = asked();
  return search;
}

}  // namespace carnot::python
