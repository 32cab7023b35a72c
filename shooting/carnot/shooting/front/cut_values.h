// Cut times of many rays, from neighbour to neighbour.
//
// A few searches (cut_time.h) tell the cut time and the partner of some rays. A neighbour has a
// partner nearby, to which Newton's method leads in three or four steps, some hundred times as
// fast. It begins with a partner that is moved along the line of momenta as the ray is, towards
// zero or away from it, and with a time in proportion to conjugate times. What no neighbour leads
// to is searched, and where a neighbour promises a partner that is met earlier it is taken. All
// goes in rounds that only read what the round before has left, so the result does not depend on
// the number of threads.
#pragma once

#include <atomic>
#include <cstdint>
#include <utility>
#include <vector>

#include "carnot/dynamics.h"
#include "carnot/shooting/front/unit_momenta.h"
#include "carnot/shooting/rays/meeting.h"

namespace carnot::internal {

struct CutValue {
  bool known = false;
  double t = 0;          // infinite where there is none up to the horizon
  double conjugate = 0;  // the first conjugate time; infinite where there is none
  bool at_conjugate = false;
  Rival partner;  // where the cut is no conjugate time
};

struct CutValuesOptions {
  double horizon = 0;  // for searches and conjugate times
  bool mod_angles = true;
  std::vector<double> signs{};  // as in cut_time.h
  std::uint64_t seed = 0;
  int threads = 0;
  Progress progress;  // returns false to stop
};

class CutValues {
 public:
  CutValues(const Dynamics& dynamics,
            std::vector<double> from,
            UnitMomenta all_momenta,
            CutValuesOptions options)
      : dynamics_(dynamics),
        from_(std::move(from)),
        all_momenta_(std::move(all_momenta)),
        options_(std::move(options)) {}

  [[nodiscard]] const CutValue& operator[](int i) const { return values_[i]; }
  [[nodiscard]] CutValue& operator[](int i) { return values_[i]; }
  [[nodiscard]] long searches() const { return searches_; }
  [[nodiscard]] bool stopped() const { return stopped_; }

  // Adds rays with these momenta, whose neighbours are given (also among each other), and finds
  // their cut times. Some of the `seeds` are searched first. False when stopped.
  bool add(const std::vector<std::vector<double>>& momenta,
           const std::vector<std::vector<int>>& neighbours,
           const std::vector<int>& seeds);
  // Adds rays one of whose two neighbours, known ones, leads to each.
  bool add_between(const std::vector<std::vector<double>>& momenta,
                   const std::vector<std::pair<int, int>>& parents);
  // Adds the partners of these rays, which are met at the same times.
  void add_partners(const std::vector<int>& of);
  // The value of a ray beside number i; nothing is added.
  [[nodiscard]] CutValue beside(const std::vector<double>& p, int i);
  // Searches so many of these rays once more, spread evenly, and takes what is less. How many were.
  int check(int count, const std::vector<std::vector<int>>& neighbours, const std::vector<int>& of);

 private:
  [[nodiscard]] Ray ray(int i) const { return {dynamics_, from_, momenta_[i]}; }
  [[nodiscard]] CutValue searched(const std::vector<double>& p);
  // What its neighbours lead to, which is unknown where they lead to nothing.
  [[nodiscard]] CutValue led_to(const std::vector<double>& p,
                                double conjugate,
                                const std::vector<int>& neighbours) const;
  [[nodiscard]] CutValue led_to_or_searched(const std::vector<double>& p,
                                            double conjugate,
                                            const std::vector<int>& neighbours);
  [[nodiscard]] double turned(const std::vector<double>& a, const std::vector<double>& b) const;
  // Whether a ray and its partner, which meet at t, are neighbours.
  [[nodiscard]] bool is_at_edge(const std::vector<double>& p,
                                const std::vector<double>& partner,
                                double t,
                                double conjugate) const;
  // A ray between two others, and its conjugate time.
  struct Way {
    std::vector<double> p;
    double conjugate = 0;
  };
  [[nodiscard]] Rival moved(const Way& from, const Way& to, const Rival& rival) const;
  bool follow(const Way& from, const Way& to, int halvings, Rival& rival) const;
  bool meets(const Ray& ray, int j, int halvings, CutValue& value) const;
  bool search_some(const std::vector<int>& of);
  bool spread(const std::vector<std::vector<int>>& neighbours);
  bool relax(const std::vector<std::vector<int>>& neighbours);
  bool improve(int i, const std::vector<int>& neighbours, CutValue& value) const;
  bool go_on();

  Dynamics dynamics_;
  std::vector<double> from_;
  UnitMomenta all_momenta_;
  CutValuesOptions options_;
  std::vector<std::vector<double>> momenta_;
  std::vector<CutValue> values_;
  std::atomic<long> searches_{0};
  std::atomic<bool> stopped_{false};
};

}  // namespace carnot::internal
