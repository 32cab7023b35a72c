#include "atlas/models.h"

#include <utility>

namespace carnot::apps {

Models::Models(const SearchOptions& search, const Run& run) : search_(search), run_(run) {
  (void)of(run.parameters);
}

std::shared_ptr<const Model> Models::of(const ParameterValues& parameters) {
  constexpr std::size_t kMost = 64;
  const std::lock_guard lock(mutex_);
  const auto found = models_.find(parameters);
  if (found != models_.end()) return found->second;
  auto model = std::make_shared<Model>();
  Run run = run_;
  run.parameters = parameters;
  if (parameters != run_.parameters) run.dynamics = run_.make(parameters);
  model->limits = limits_of(search_.asked, run);
  model->dynamics = std::move(run.dynamics);
  models_.emplace(parameters, model);
  order_.push_back(parameters);
  if (order_.size() > kMost) {
    models_.erase(order_.front());
    order_.pop_front();
  }
  return model;
}

}  // namespace carnot::apps
