// The distinct extremals of a search, with how often each was hit.
//
// Mirror partners are extremals of their own, but they are hit together: a start that leads to one
// would lead, mirrored, to the other. So hits are counted for the first of the partners, which
// stands for all of them.
#pragma once

#include <functional>
#include <vector>

#include "carnot/shooting/extremal/verification.h"
#include "carnot/shooting/search/hits.h"

namespace carnot::internal {

// How sure it is that nothing has less action than the best extremal.
struct Competition {
  Hits hits;          // of the least action; mirror partners count together
  int rivals = 0;     // extremals whose action is near the least, the best among them
  double missed = 0;  // how many extremals more there are, by Chao's estimate
};

class ExtremalList {
 public:
  // What is above the least action by no more than this, relative, is a rival of the best.
  static constexpr double kRival = 0.03;

  // The verified mirror partners of an extremal, which may be the same path.
  using Partners = std::function<std::vector<Extremal>(const Extremal&)>;

  // Without `partners` nothing is added but what is given.
  explicit ExtremalList(Partners partners = {}) : partners_(std::move(partners)) {}

  // Adds the extremal, and its partners, where it is new. Where it is known by knots only and the
  // new one needs none, that takes its place. Returns the index in the list.
  std::size_t add(const Extremal& extremal);
  // Counts hits of the extremal, or of the one that stands for it.
  void hit(std::size_t index, const Hits& hits) { hits_[root(index)] += hits; }

  [[nodiscard]] bool empty() const { return list_.empty(); }
  [[nodiscard]] std::size_t size() const { return list_.size(); }
  [[nodiscard]] const Extremal& operator[](std::size_t index) const { return list_[index]; }
  [[nodiscard]] Extremal& operator[](std::size_t index) { return list_[index]; }
  [[nodiscard]] auto begin() const { return list_.begin(); }
  [[nodiscard]] auto end() const { return list_.end(); }

  // The first of least action. The list is not empty.
  [[nodiscard]] std::size_t best() const;
  [[nodiscard]] double least_action() const { return list_[best()].geodesic.action; }
  [[nodiscard]] Competition competition() const;
  // How often each was hit, together with its partners; without those that nothing led to.
  [[nodiscard]] std::vector<Hits> hits() const;
  // Those not longer than `max_length`, with their hits.
  [[nodiscard]] std::vector<Extremal> up_to(double max_length) const;

 private:
  static constexpr std::size_t kNone = -1;

  std::size_t add(const Extremal& extremal, std::size_t partner_of);
  // The one that stands for an extremal and its mirror partners.
  [[nodiscard]] std::size_t root(std::size_t index) const {
    while (partner_of_[index] != kNone) index = partner_of_[index];
    return index;
  }

  Partners partners_;
  std::vector<Extremal> list_;
  std::vector<Hits> hits_;
  std::vector<std::size_t> partner_of_;  // the extremal whose mirror image it is, or kNone
};

}  // namespace carnot::internal
