// Cut times of many rays, from neighbour to neighbour.
//
// A few searches (cut_time.h) tell the cut time and the partner of some rays. A neighbour has a
// partner nearby, to which Newton's method leads in three or four steps, some hundred times as
// fast. It begins with a partner that is moved along the line of momenta as the ray is, towards
// zero or away from it, and with a time in proportion to conjugate times. Where that fails it
// begins with one that is carried by the derivative of the equations, and then goes in smaller
// steps. What no neighbour leads to is searched, and where a neighbour promises a partner that is
// met earlier it is taken. Beyond the horizon nothing is followed: there a ray has no cut. All goes
// in rounds that only read what the round before has left, so the result does not depend on the
// number of threads.
//
// Searches are what costs. On the vehicle's sphere of length 1 with p_theta = 0 they were 207 when
// only moved partners were tried. Carried ones leave 115; with places on an edge that lead to the
// next ones, and neighbours of each other that are followed where their branch is not found, 45 are
// left; with branches that may bend (rays/meeting.h), and what is later than the horizon or the
// conjugate time, 28. It takes a ninth of the time.
#pragma once

#include <atomic>
#include <cstdint>
#include <optional>
#include <utility>
#include <vector>

#include "carnot/dynamics.h"
#include "carnot/shooting/front/unit_momenta.h"
#include "carnot/shooting/rays/meeting.h"

namespace carnot::internal {

struct CutValue {
  bool known = false;
  // Infinite where there is none up to the horizon. Where it is not known, the conjugate time.
  double t = 0;
  double conjugate = 0;  // the first conjugate time; infinite where there is none
  bool at_conjugate = false;
  Rival partner;  // where the cut is no conjugate time
};

// A ray with its value.
struct CutRay {
  std::vector<double> p;
  CutValue value;
};

struct CutValuesOptions {
  double horizon = 0;  // for searches and conjugate times
  bool mod_angles = true;
  std::vector<double> signs{};  // as in cut_time.h
  std::uint64_t seed = 0;
  int threads = 0;
  Progress progress{};  // returns false to stop
};

class CutValues {
 public:
  CutValues(Dynamics dynamics,
            std::vector<double> from,
            UnitMomenta all_momenta,
            CutValuesOptions options)
      : dynamics_(std::move(dynamics)),
        from_(std::move(from)),
        all_momenta_(std::move(all_momenta)),
        options_(std::move(options)) {}

  [[nodiscard]] const CutValue& operator[](int i) const { return values_[i]; }
  [[nodiscard]] CutValue& operator[](int i) { return values_[i]; }
  [[nodiscard]] long searches() const { return searches_; }
  // How many rays have cut times that are not known, and conjugate times from this one on.
  [[nodiscard]] long unknown(double from) const;
  [[nodiscard]] bool stopped() const { return stopped_; }

  // Adds rays with these momenta, whose neighbours are given (also among each other), and finds
  // their cut times. Some of the `seeds` are searched first, and `checked` of them once more, until
  // these searches tell nothing new. False when stopped.
  bool add(const std::vector<std::vector<double>>& momenta,
           const std::vector<std::vector<int>>& neighbours,
           const std::vector<int>& seeds,
           int checked);
  // The same for the vertices of a mesh, any of which may be searched. What has no neighbours is
  // left out, and is unknown. Nothing when stopped.
  [[nodiscard]] std::optional<std::vector<CutValue>> of_mesh(
      const std::vector<std::vector<double>>& momenta,
      const std::vector<std::vector<int>>& neighbours,
      int checked);
  // Adds rays one of whose two neighbours, known ones, leads to each. Of some the values may be
  // known already; `found` is empty where there are none.
  bool add_between(const std::vector<std::vector<double>>& momenta,
                   const std::vector<std::pair<int, int>>& parents,
                   std::vector<CutValue> found = {});
  // Adds the partners of these rays, which are met at the same times.
  void add_partners(const std::vector<int>& of);
  [[nodiscard]] CutRay cut_ray(int i) const { return {momenta_[i], values_[i]}; }
  // The value of a ray between two others; nothing is added.
  [[nodiscard]] CutValue beside(const std::vector<double>& p, const CutRay& a, const CutRay& b);

 private:
  [[nodiscard]] Ray ray(int i) const { return {dynamics_, from_, momenta_[i]}; }
  [[nodiscard]] CutValue searched(const std::vector<double>& p);
  // A ray that leads to others.
  struct Neighbour {
    const std::vector<double>* p;
    const CutValue* value;
  };
  [[nodiscard]] Neighbour neighbour(int j) const { return {&momenta_[j], &values_[j]}; }
  [[nodiscard]] std::vector<Neighbour> those(const std::vector<int>& neighbours) const;
  // What its neighbours lead to, which is unknown where they lead to nothing.
  [[nodiscard]] CutValue led_to(const std::vector<double>& p,
                                double conjugate,
                                const std::vector<Neighbour>& neighbours) const;
  [[nodiscard]] CutValue led_to_or_searched(const std::vector<double>& p,
                                            double conjugate,
                                            const std::vector<Neighbour>& neighbours);
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
  // Where the partner of a neighbour leads: to a meeting that is earlier than the value, which it
  // becomes; to one that is later, or beyond the horizon; nowhere that is found.
  enum class Led { kEarlier, kLater, kNowhere };
  // Two paths that are neighbours of each other meet where the equations are badly conditioned, and
  // are left to another method unless they are allowed.
  enum class AtEdge { kLeft, kAllowed };
  Led lead(const Ray& ray,
           const Neighbour& neighbour,
           int halvings,
           AtEdge at_edge,
           CutValue& value) const;
  bool search_some(const std::vector<int>& of);
  bool spread(const std::vector<std::vector<int>>& neighbours);
  bool relax(const std::vector<std::vector<int>>& neighbours);
  bool improve(int i, const std::vector<int>& neighbours, CutValue& value) const;
  // Searches so many of these rays once more, spread evenly, and takes what is less. How many were.
  int check(int count, const std::vector<std::vector<int>>& neighbours, const std::vector<int>& of);
  bool go_on();

  Dynamics dynamics_;
  std::vector<double> from_;
  UnitMomenta all_momenta_;
  CutValuesOptions options_;
  std::vector<std::vector<double>> momenta_;
  std::vector<CutValue> values_;
  std::vector<char> given_up_;  // whether a search has not found the cut time
  std::atomic<long> searches_{0};
  std::atomic<bool> stopped_{false};
};

}  // namespace carnot::internal
