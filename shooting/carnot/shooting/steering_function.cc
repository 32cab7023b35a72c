#include "carnot/shooting/steering_function.h"

#include <stdexcept>
#include <utility>

#include "carnot/shooting/steer/steering_memory.h"
#include "carnot/shooting/steer/steering_search.h"

namespace carnot {

using namespace internal;

// The answer, and what was asked.
struct Steering::Way {
  std::shared_ptr<const SteeringSearch> search;
  std::shared_ptr<const SteeringAnswer> answer;
  std::vector<double> from;
  std::vector<double> to;
  SteeringSense sense;
};

Steering::Steering(std::shared_ptr<const Way> way) : way_(std::move(way)) {}

bool Steering::found() const { return way_->answer->geodesic.has_value(); }
Reason Steering::reason() const { return way_->answer->reason; }
const std::string& Steering::message() const { return way_->answer->message; }
double Steering::distance() const { return way_->answer->distance(way_->sense); }
const Geodesic* Steering::geodesic() const { return found() ? &*way_->answer->geodesic : nullptr; }

bool Steering::at(double t, std::span<double> q) const {
  return way_->search->point(*way_->answer, way_->sense, way_->from, way_->to, t, q);
}

// The search, and what it has found.
class SteeringFunction::Implementation {
 public:
  Implementation(Dynamics dynamics, const SteeringOptions& options)
      : search_(std::make_shared<const SteeringSearch>(std::move(dynamics), options)),
        memory_(options.memory) {}

  [[nodiscard]] const std::shared_ptr<const SteeringSearch>& search() const { return search_; }

  // Known or solved, never null. Sets the question.
  [[nodiscard]] SteeringMemory::Value answer(std::span<const double> from,
                                             std::span<const double> to,
                                             SteeringQuestion& question) const {
    std::string refusal = search_->refusal(from, to);
    if (!refusal.empty()) return refused(std::move(refusal));
    question.ask(search_->dynamics().info, search_->rules(), from, to);
    SteeringMemory::Value known = memory_.find(question.ends);
    if (known != nullptr) return known;
    SteeringMemory::Value found = search_->answers(question, 1).front();
    if (found->reason != Reason::kInterrupted) memory_.insert(question.ends, found);
    return found;
  }

  [[nodiscard]] Steering way(SteeringMemory::Value answer,
                             std::span<const double> from,
                             std::span<const double> to,
                             const SteeringSense& sense) const {
    return Steering(std::make_shared<const Steering::Way>(Steering::Way{
        search_, std::move(answer), {from.begin(), from.end()}, {to.begin(), to.end()}, sense}));
  }

  [[nodiscard]] static SteeringMemory::Value refused(std::string message) {
    auto answer = std::make_shared<SteeringAnswer>();
    answer->reason = Reason::kIrregularEnd;
    answer->message = std::move(message);
    return answer;
  }

 private:
  std::shared_ptr<const SteeringSearch> search_;
  mutable SteeringMemory memory_;
};

SteeringFunction::SteeringFunction(Dynamics dynamics, const SteeringOptions& options)
    : own_(std::make_shared<const Implementation>(std::move(dynamics), options)) {}

int SteeringFunction::dof() const { return own_->search()->dynamics().dof; }
const SteeringOptions& SteeringFunction::options() const { return own_->search()->options(); }
const SceneInfo& SteeringFunction::info() const { return own_->search()->dynamics().info; }
bool SteeringFunction::symmetric() const { return own_->search()->reversible(); }

Steering SteeringFunction::steer(std::span<const double> from, std::span<const double> to) const {
  SteeringQuestion question;
  SteeringMemory::Value answer = own_->answer(from, to, question);
  return own_->way(std::move(answer), from, to, question.sense);
}

double SteeringFunction::distance(std::span<const double> from, std::span<const double> to) const {
  thread_local SteeringQuestion question;
  return own_->answer(from, to, question)->distance(question.sense);
}

bool SteeringFunction::interpolate(std::span<const double> from,
                                   std::span<const double> to,
                                   double t,
                                   std::span<double> q) const {
  thread_local SteeringQuestion question;
  const SteeringMemory::Value answer = own_->answer(from, to, question);
  return own_->search()->point(*answer, question.sense, from, to, t, q);
}

std::vector<Steering> SteeringFunction::alternatives(std::span<const double> from,
                                                     std::span<const double> to,
                                                     int count) const {
  if (count < 1) {
    throw std::invalid_argument("count is " + std::to_string(count) + ", must be >= 1");
  }
  SteeringQuestion question;
  std::vector<SteeringMemory::Value> answers;
  std::string refusal = own_->search()->refusal(from, to);
  if (refusal.empty()) {
    question.ask(info(), own_->search()->rules(), from, to);
    answers = own_->search()->answers(question, count);
  } else {
    answers.push_back(Implementation::refused(std::move(refusal)));
  }
  std::vector<Steering> ways;
  ways.reserve(answers.size());
  for (SteeringMemory::Value& answer : answers) {
    ways.push_back(own_->way(std::move(answer), from, to, question.sense));
  }
  return ways;
}

}  // namespace carnot
