#include "carnot/shooting/shoot/bound_arcs.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <span>
#include <stdexcept>
#include <utility>

#include "carnot/shooting/linear/dense.h"
#include "carnot/shooting/linear/round_off.h"
#include "carnot/shooting/problem/ends.h"
#include "carnot/shooting/problem/hamiltonian_terms.h"

namespace carnot::internal {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

// A wall at a point.
struct WallAt {
  double s = 0;
  VectorXd gradient;
  MatrixXd hessian;
};

WallAt wall_at(const Walls& walls, int n, int wall, const double* q) {
  std::vector<double> s(walls.size());
  std::vector<double> gradients(s.size() * n);
  std::vector<double> hessians(gradients.size() * n);
  walls.evaluate(q, s.data(), gradients.data(), hessians.data());
  const Eigen::Index size = n;
  return {
      s[wall],
      Eigen::Map<const VectorXd>(&gradients[static_cast<std::size_t>(wall) * n], size),
      Eigen::Map<const MatrixXd>(&hessians[static_cast<std::size_t>(wall) * n * n], size, size)};
}

// ds.H_p of the scene without bounds, and its derivatives by q and p.
struct Approach {
  double rate = 0;
  VectorXd by_q;
  VectorXd by_p;
};

Approach approach(HamiltonianTerms& terms, const WallAt& wall, const double* z) {
  const auto n = wall.gradient.size();
  terms.set(0, 0, z, z + n);
  Approach result;
  result.by_q.setZero(n);
  result.by_p.setZero(n);
  if (!terms.evaluate(1, HamiltonianTerms::Order::kSecond)) {
    result.rate = std::numeric_limits<double>::quiet_NaN();
    return result;
  }
  for (int a = 0; a < n; ++a) {
    result.rate += wall.gradient[a] * terms.by_p(0, a);
    for (int b = 0; b < n; ++b) {
      result.by_q[a] +=
          wall.hessian(a, b) * terms.by_p(0, b) + terms.qp(0, a, b) * wall.gradient[b];
      result.by_p[a] += terms.pp(0, a, b) * wall.gradient[b];
    }
  }
  return result;
}

// The scene on each wall.
class Held {
 public:
  Held(const BoundaryValueProblem& problem, const Walls& walls, const BoundExtremal& extremal)
      : problem_(problem) {
    for (const Piece& piece : extremal.pieces) {
      if (piece.wall < 0 || scenes_.count(piece.wall) > 0) continue;
      const Limit& limit = problem.limits[walls[piece.wall].limit];
      if (!limit.held) {
        exists_ = false;
        return;
      }
      try {
        scenes_.emplace(piece.wall, limit.held());
      } catch (const std::invalid_argument&) {  // the rows are dependent there
        exists_ = false;
      }
    }
  }
  [[nodiscard]] bool exists() const { return exists_; }
  [[nodiscard]] const Dynamics& of(const Piece& piece) const {
    return piece.wall < 0 ? problem_.dynamics : scenes_.at(piece.wall);
  }

 private:
  const BoundaryValueProblem& problem_;
  std::map<int, Dynamics> scenes_;
  bool exists_ = true;
};

// How many steps each segment of a piece takes.
long steps_of(const BoundaryValueProblem& problem, const Piece& piece, double start, long steps) {
  const double share = (piece.end - start) / problem.time;
  const double each = std::ceil(share * static_cast<double>(steps) / piece.segments);
  return std::max(2L, static_cast<long>(each));
}

// Unknowns: those of the start, the other segments' starts, the times between pieces, then eta at
// the end of each arc.
class Equations {
 public:
  Equations(const BoundaryValueProblem& problem,
            const Walls& walls,
            const Held& held,
            long steps,
            const BoundExtremal& extremal)
      : problem_(problem),
        walls_(walls),
        held_(held),
        n_(problem.dynamics.dof),
        terms_(problem.dynamics) {
    double start = 0;
    double q_size = distance_between_ends(problem);
    double p_size = 0;
    for (const Piece& piece : extremal.pieces) {
      steps_.push_back(steps_of(problem, piece, start, steps));
      start = piece.end;
      segments_ += piece.segments;
      if (piece.leaves() >= 0) ++arcs_;
      for (std::size_t i = 0; i < piece.z.size(); ++i) {
        const bool momentum = static_cast<int>(i) % (2 * n_) >= n_;
        const double origin = extremal.pieces[0].z[i % (2 * n_)];
        double& size = momentum ? p_size : q_size;
        size = std::max(size, std::abs(piece.z[i] - (momentum ? 0 : origin)));
      }
    }
    pieces_ = static_cast<int>(extremal.pieces.size());
    q_size_ = q_size > 0 ? q_size : 1;
    p_size_ = p_size > 0 ? p_size : 1;
  }

  [[nodiscard]] int size() const { return times_at() + pieces_ - 1 + arcs_; }

  // False when a flow fails.
  bool evaluate(const BoundExtremal& extremal, VectorXd& residual, MatrixXd& jacobian) {
    residual.setZero(size());
    jacobian.setZero(size(), size());
    int row = 0;
    int segment = 0;
    int arc = 0;
    double start = 0;
    for (int k = 0; k < pieces_; ++k) {
      const Piece& piece = extremal.pieces[k];
      if (k > 0 && !add_junction(extremal, k, segment, row, residual, jacobian)) return false;
      for (int i = 0; i < piece.segments; ++i, ++segment) {
        if (!add_segment(extremal, k, i, start, segment, arc, row, residual, jacobian))
          return false;
      }
      if (piece.leaves() >= 0) ++arc;
      start = piece.end;
    }
    return residual.allFinite() && jacobian.allFinite();
  }

  // extremal - share * step.
  void move(const BoundExtremal& from,
            const VectorXd& step,
            double share,
            BoundExtremal& to) const {
    to = from;
    int segment = 0;
    int arc = 0;
    for (int k = 0; k < pieces_; ++k) {
      Piece& piece = to.pieces[k];
      for (int i = 0; i < piece.segments; ++i, ++segment) {
        for (int j = 0; j < 2 * n_; ++j) {
          const int c = column(segment, j);
          if (c >= 0) piece.z[i * 2 * n_ + j] -= share * step[c];
        }
      }
      if (k + 1 < pieces_) piece.end -= share * step[times_at() + k];
      if (piece.leaves() >= 0) piece.release -= share * step[times_at() + pieces_ - 1 + arc++];
    }
  }

 private:
  [[nodiscard]] int times_at() const { return n_ + (segments_ - 1) * 2 * n_; }
  // The unknown that entry j of the start of a segment is; -1: none.
  [[nodiscard]] int column(int segment, int j) const {
    if (segment > 0) return n_ + (segment - 1) * 2 * n_ + j;
    const int coordinate = j % n_;
    return start_index(problem_, coordinate) == j ? coordinate : -1;
  }
  [[nodiscard]] double unit(int j) const { return j % (2 * n_) < n_ ? q_size_ : p_size_; }

  bool add_segment(const BoundExtremal& extremal,
                   int k,
                   int i,
                   double start,
                   int segment,
                   int arc,
                   int& row,
                   VectorXd& residual,
                   MatrixXd& jacobian) {
    const Piece& piece = extremal.pieces[k];
    const Dynamics& dynamics = held_.of(piece);
    const double duration = (piece.end - start) / piece.segments;
    std::vector<double> end(piece.z.begin() + i * 2 * n_, piece.z.begin() + (i + 1) * 2 * n_);
    Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor> m(2 * n_, 2 * n_);
    const StepPlan plan = StepPlan::equal(0, duration, steps_[k]);
    if (!dynamics.tangent_flow(plan, end, span_of(m)).completed()) return false;
    HamiltonianTerms at_end(dynamics);
    at_end.set(0, 0, end.data(), end.data() + n_);
    if (!at_end.evaluate(1, HamiltonianTerms::Order::kFirst)) return false;
    const bool last = segment + 1 == segments_;
    const bool leaves = piece.leaves() >= 0 && i + 1 == piece.segments;
    const double* next = nullptr;
    if (!last) {
      next = i + 1 < piece.segments ? &piece.z[(i + 1) * 2 * n_] : extremal.pieces[k + 1].z.data();
    }
    const WallAt wall = leaves && !last ? wall_at(walls_, n_, piece.leaves(), next) : WallAt{};
    for (int r = 0; r < (last ? n_ : 2 * n_); ++r, ++row) {
      const int at = last ? target_index(problem_, r) : r;
      const double scale = unit(at);
      residual[row] = (end[at] - (last ? target_value(problem_, r) : next[r])) / scale;
      for (int j = 0; j < 2 * n_; ++j) {
        const int c = column(segment, j);
        if (c >= 0) jacobian(row, c) += m(at, j) / scale;
      }
      if (!last) jacobian(row, column(segment + 1, r)) -= 1 / scale;
      const double rate =
          (at < n_ ? at_end.by_p(0, at) : -at_end.by_q(0, at - n_)) / (scale * piece.segments);
      if (k + 1 < pieces_) jacobian(row, times_at() + k) += rate;
      if (k > 0) jacobian(row, times_at() + k - 1) -= rate;
      if (!leaves || last || at < n_) continue;
      const int a = at - n_;
      residual[row] -= piece.release * wall.gradient[a] / scale;
      jacobian(row, times_at() + pieces_ - 1 + arc) -= wall.gradient[a] / scale;
      for (int j = 0; j < n_; ++j) {
        jacobian(row, column(segment + 1, j)) -= piece.release * wall.hessian(a, j) / scale;
      }
    }
    return true;
  }

  // At the start of piece k, which is that of `segment`.
  bool add_junction(const BoundExtremal& extremal,
                    int k,
                    int segment,
                    int& row,
                    VectorXd& residual,
                    MatrixXd& jacobian) {
    const Piece& piece = extremal.pieces[k];
    const Piece& before = extremal.pieces[k - 1];
    const bool meets = piece.wall >= 0 || before.touches >= 0;
    const int number = piece.wall >= 0 ? piece.wall : before.leaves();
    const WallAt wall = wall_at(walls_, n_, number, piece.z.data());
    const Approach to = approach(terms_, wall, piece.z.data());
    const double size = wall.gradient.norm() * q_size_;
    const double speed = size / problem_.time;
    for (int j = 0; j < n_; ++j) {
      jacobian(row, column(segment, j)) = to.by_q[j] / speed;
      jacobian(row, column(segment, n_ + j)) = to.by_p[j] / speed;
    }
    residual[row++] = to.rate / speed;
    if (!meets) return true;
    for (int j = 0; j < n_; ++j) jacobian(row, column(segment, j)) = wall.gradient[j] / size;
    residual[row++] = wall.s / size;
    return true;
  }

  const BoundaryValueProblem& problem_;
  const Walls& walls_;
  const Held& held_;
  int n_;
  HamiltonianTerms terms_;
  std::vector<long> steps_;
  int pieces_ = 0;
  int segments_ = 0;
  int arcs_ = 0;
  double q_size_ = 1;
  double p_size_ = 1;
};

// eta on an arc: what makes the velocity without the bound keep to it.
double eta_at(const Walls& walls, HamiltonianTerms& terms, int wall, const double* z, int n) {
  const WallAt at = wall_at(walls, n, wall, z);
  const Approach to = approach(terms, at, z);
  return to.rate / to.by_p.dot(at.gradient);
}

// nu = eta' along a segment on a wall, by differences of eta.
struct MultiplierRange {
  double least = std::numeric_limits<double>::infinity();
  double largest = 0;
};

MultiplierRange multipliers(const Walls& walls,
                            HamiltonianTerms& terms,
                            const Dynamics& dynamics,
                            const Piece& piece,
                            const StepPlan& plan,
                            std::vector<double> z) {
  constexpr long kSamples = 33;
  MonitorOptions options;
  options.samples = kSamples;
  const Trajectory path = dynamics.monitored_flow(plan, z, options).trajectory;
  MultiplierRange range;
  double before = 0;
  for (std::size_t i = 0; i < path.t.size(); ++i) {
    std::vector<double> at = path.q[i];
    at.insert(at.end(), path.p[i].begin(), path.p[i].end());
    const double eta = eta_at(walls, terms, piece.wall, at.data(), dynamics.dof);
    if (i > 0) {
      const double nu = (eta - before) / (path.t[i] - path.t[i - 1]);
      range.least = std::min(range.least, nu);
      range.largest = std::max(range.largest, nu);
    }
    before = eta;
  }
  return range;
}

double energy_at(const Dynamics& dynamics, const std::vector<double>& z) {
  std::vector<double> velocity(dynamics.dof);
  std::vector<double> lambda(dynamics.multipliers);
  const std::span<const double> at(z);
  return dynamics.evaluate(0, at.first(dynamics.dof), at.subspan(dynamics.dof), velocity, lambda)
      .hamiltonian;
}

// Appends samples of a segment, with the momenta of the problem without bounds.
void record(const BoundaryValueProblem& problem,
            const Walls& walls,
            HamiltonianTerms& terms,
            int wall,
            const Trajectory& samples,
            Trajectory& to) {
  const int n = problem.dynamics.dof;
  std::vector<double> lambda(problem.dynamics.multipliers);
  std::vector<double> velocity(n);
  for (std::size_t i = 0; i < samples.t.size(); ++i) {
    std::vector<double> z = samples.q[i];
    z.insert(z.end(), samples.p[i].begin(), samples.p[i].end());
    if (wall >= 0) {
      const double eta = eta_at(walls, terms, wall, z.data(), n);
      const WallAt at = wall_at(walls, n, wall, z.data());
      for (int j = 0; j < n; ++j) z[n + j] -= eta * at.gradient[j];
    }
    const std::span<const double> at(z);
    const auto values =
        problem.dynamics.evaluate(samples.t[i], at.first(n), at.subspan(n), velocity, lambda);
    to.t.push_back(samples.t[i]);
    to.q.emplace_back(z.begin(), z.begin() + n);
    to.p.emplace_back(z.begin() + n, z.end());
    to.lambda.push_back(lambda);
    to.hamiltonian.push_back(values.hamiltonian);
  }
}

// Nodes in a row where the multiplier of a wall exceeds its slack.
struct Contact {
  int wall = 0;
  int first = 0;
  int last = 0;
  int strongest = 0;   // where the multiplier is largest
  int first_peak = 0;  // where it is larger than at both neighbours, first and last
  int last_peak = 0;
  double impulse = 0;  // the integral of the multiplier
};

// Whether velocities change the value of the wall there, so that an arc may keep to it.
bool is_of_first_order(const Walls& walls,
                       HamiltonianTerms& terms,
                       const Path& path,
                       const Contact& contact) {
  // ds.H_pp ds over its largest possible value. It vanishes where a wheel passes an obstacle, and
  // is one for the steering angle of a vehicle.
  constexpr double kNone = 1e-2;
  if (contact.first == contact.last) return false;
  const int n = path.dof;
  std::vector<double> z(path.configuration(contact.strongest),
                        path.configuration(contact.strongest) + n);
  z.insert(z.end(), path.momentum(contact.strongest), path.momentum(contact.strongest) + n);
  const WallAt wall = wall_at(walls, n, contact.wall, z.data());
  const VectorXd moved = approach(terms, wall, z.data()).by_p;
  double largest = 0;
  for (int a = 0; a < n; ++a) largest = std::max(largest, std::abs(terms.pp(0, a, a)));
  return moved.dot(wall.gradient) > kNone * largest * wall.gradient.squaredNorm();
}

// In order of time. Nothing where two walls are met at once, or one at an end.
std::optional<std::vector<Contact>> contacts_of(const Walls& walls,
                                                const InteriorPointOptions& options,
                                                const LimitedPath& limited,
                                                double h) {
  const int last = limited.path.intervals;
  const int m = walls.size();
  std::vector<Contact> contacts;
  for (int node = 0; node <= last; ++node) {
    int met = -1;
    for (int w = 0; w < m; ++w) {
      const std::size_t i = static_cast<std::size_t>(node) * m + w;
      const double size = options.sizes[w];
      if (!(limited.nu[i] * size / options.rate > limited.sigma[i] / size)) continue;
      if (met >= 0 || node == 0 || node == last) return std::nullopt;
      met = w;
    }
    if (met < 0) continue;
    const auto nu = [&](int at) { return limited.nu[static_cast<std::size_t>(at) * m + met]; };
    if (contacts.empty() || contacts.back().last + 1 < node) {
      contacts.push_back({met, node, node, node, -1, -1, 0});
    } else if (contacts.back().wall != met) {
      return std::nullopt;
    }
    Contact& contact = contacts.back();
    contact.last = node;
    contact.impulse += h * nu(node);
    if (nu(node) > nu(contact.strongest)) contact.strongest = node;
    if (nu(node) >= nu(node - 1) && nu(node) >= nu(node + 1)) {
      if (contact.first_peak < 0) contact.first_peak = node;
      contact.last_peak = node;
    }
  }
  for (Contact& contact : contacts) {
    if (contact.first_peak < 0) contact.first_peak = contact.last_peak = contact.strongest;
  }
  return contacts;
}

// The segments of a piece from node `begin` to `end`; on an arc eta grows to that value.
void fill_piece(
    const Walls& walls, const LimitedPath& limited, int begin, int end, double eta, Piece& piece) {
  constexpr int kSegments = 8;  // of the whole time
  const Path& path = limited.path;
  const double share = static_cast<double>(end - begin) / path.intervals;
  piece.segments = std::max(1, static_cast<int>(std::ceil(kSegments * share)));
  piece.segments = std::min(piece.segments, std::max(1, end - begin));
  for (int i = 0; i < piece.segments; ++i) {
    const int node = begin + (end - begin) * i / piece.segments;
    std::vector<double> z(path.configuration(node), path.configuration(node) + path.dof);
    z.insert(z.end(), path.momentum(node), path.momentum(node) + path.dof);
    if (piece.wall >= 0) {
      const double reached = eta * (node - begin) / (end - begin);
      const WallAt at = wall_at(walls, path.dof, piece.wall, z.data());
      for (int j = 0; j < path.dof; ++j) z[path.dof + j] += reached * at.gradient[j];
    }
    piece.z.insert(piece.z.end(), z.begin(), z.end());
  }
}

bool in_order(const BoundExtremal& extremal, const BoundExtremal& before) {
  constexpr double kShrink = 0.2;  // a piece may lose so much at once
  double start = 0;
  double start_before = 0;
  for (std::size_t k = 0; k < extremal.pieces.size(); ++k) {
    const double length = before.pieces[k].end - start_before;
    if (!(extremal.pieces[k].end - start > kShrink * length)) return false;
    start = extremal.pieces[k].end;
    start_before = before.pieces[k].end;
  }
  return true;
}

}  // namespace

std::optional<BoundExtremal> pieces_of(const BoundaryValueProblem& problem,
                                       const Walls& walls,
                                       const InteriorPointOptions& options,
                                       const LimitedPath& limited,
                                       Contacts as) {
  const Path& path = limited.path;
  const double h = problem.time / path.intervals;
  const auto contacts = contacts_of(walls, options, limited, h);
  if (!contacts) return std::nullopt;
  BoundExtremal extremal;
  HamiltonianTerms terms(problem.dynamics);
  int begin = 0;
  const auto add = [&](Piece piece, int end, double eta) {
    fill_piece(walls, limited, begin, end, eta, piece);
    piece.end = end * h;
    extremal.pieces.push_back(std::move(piece));
    begin = end;
  };
  for (const Contact& contact : *contacts) {
    Piece free;
    if (as == Contacts::kPairs) {
      if (contact.first_peak == contact.last_peak) return std::nullopt;
      free.touches = contact.wall;
      free.release = 0.5 * contact.impulse;
      add(free, contact.first_peak, 0);
      add(free, contact.last_peak, 0);
    } else if (as == Contacts::kTouches ||
               (as == Contacts::kByOrder && !is_of_first_order(walls, terms, path, contact))) {
      free.touches = contact.wall;
      free.release = contact.impulse;
      add(free, contact.strongest, 0);
    } else {
      if (contact.last == contact.first || contact.first <= begin) return std::nullopt;
      add(free, contact.first, 0);
      Piece arc;
      arc.wall = contact.wall;
      arc.release = contact.impulse;
      add(arc, contact.last, contact.impulse);
    }
  }
  add(Piece{}, path.intervals, 0);
  return extremal;
}

bool join_pieces(const BoundaryValueProblem& problem,
                 const Walls& walls,
                 long steps,
                 BoundExtremal& extremal) {
  constexpr int kMostIterations = 20;
  constexpr double kShortest = 1.0 / 32;
  constexpr double kSolved = 1e-12;
  // Pieces begin at times that are not known yet.
  if (!problem.dynamics.autonomous) return false;
  const Held held(problem, walls, extremal);
  if (!held.exists()) return false;
  Equations equations(problem, walls, held, steps, extremal);
  VectorXd residual;
  MatrixXd jacobian;
  if (!equations.evaluate(extremal, residual, jacobian)) return false;
  extremal.residual = residual.norm();
  BoundExtremal trial;
  for (int iteration = 0; iteration < kMostIterations; ++iteration) {
    const VectorXd step = lu_solve(jacobian, residual);
    if (!step.allFinite()) return false;
    bool better = false;
    for (double share = 1; share >= kShortest && !better; share *= 0.5) {
      equations.move(extremal, step, share, trial);
      if (!in_order(trial, extremal) || !equations.evaluate(trial, residual, jacobian)) continue;
      trial.residual = residual.norm();
      better = trial.residual < (1 - 0.1 * share) * extremal.residual;
    }
    if (!better) break;
    extremal = trial;
    if (extremal.residual <= kRestRoundOff) break;
  }
  return extremal.residual <= kSolved;
}

BoundSurvey survey_pieces(const BoundaryValueProblem& problem,
                          const Walls& walls,
                          const BoundExtremal& extremal,
                          long steps,
                          const std::vector<double>& times) {
  const int n = problem.dynamics.dof;
  const double slack = kTimeRoundOff * problem.time;
  const Held held(problem, walls, extremal);
  HamiltonianTerms terms(problem.dynamics);
  BoundSurvey result;
  FlowSummary& total = result.summary;
  double initial = std::numeric_limits<double>::quiet_NaN();
  double start = 0;
  for (std::size_t k = 0; k < extremal.pieces.size(); ++k) {
    const Piece& piece = extremal.pieces[k];
    const Dynamics& dynamics = held.of(piece);
    const double duration = (piece.end - start) / piece.segments;
    const long count = steps_of(problem, piece, start, steps);
    double largest = 0;
    for (int i = 0; i < piece.segments; ++i) {
      const bool ends = i + 1 == piece.segments;
      const bool last = ends && k + 1 == extremal.pieces.size();
      const double from = start + i * duration;
      const double to = ends ? piece.end : from + duration;
      std::vector<double> z(piece.z.begin() + i * 2 * n, piece.z.begin() + (i + 1) * 2 * n);
      if (piece.wall >= 0) {
        const MultiplierRange range =
            multipliers(walls, terms, dynamics, piece, StepPlan::equal(from, to - from, count), z);
        largest = std::max(largest, range.largest);
        result.least_multiplier = std::min(result.least_multiplier, range.least);
      }
      MonitorOptions options;
      for (const double t : times) {
        if (t >= from - slack && (last || t < to - slack)) {
          options.times.push_back(std::clamp(t, from, to));
        }
      }
      const double energy = energy_at(dynamics, z);
      if (std::isnan(initial)) initial = energy;
      const FlowSummary part =
          dynamics.monitored_flow(StepPlan::equal(from, to - from, count), z, options);
      if (!part.completed()) return result;
      total.action += part.action;
      total.length += part.length;
      total.energy_drift =
          std::max(total.energy_drift, part.energy_drift + std::abs(energy - initial));
      total.constraint_error = std::max(total.constraint_error, part.constraint_error);
      record(problem, walls, terms, piece.wall, part.trajectory, total.trajectory);
      if (last) {
        result.end = z;
        const double unit = length_per_momentum(problem, &extremal.pieces[0].z[n]);
        result.defect = std::max(result.defect, miss(problem, z.data(), unit));
        continue;
      }
      const double* next = ends ? extremal.pieces[k + 1].z.data() : &piece.z[(i + 1) * 2 * n];
      if (piece.leaves() >= 0 && ends) {
        const WallAt wall = wall_at(walls, n, piece.leaves(), next);
        for (int j = 0; j < n; ++j) z[n + j] -= piece.release * wall.gradient[j];
      }
      for (int j = 0; j < 2 * n; ++j) {
        const double gap = std::abs(z[j] - next[j]);
        result.defect = gap <= result.defect ? result.defect : gap;
      }
    }
    result.largest_multiplier.push_back(largest);
    start = piece.end;
  }
  result.completed = true;
  return result;
}

}  // namespace carnot::internal
