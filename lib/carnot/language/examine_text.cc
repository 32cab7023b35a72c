#include "carnot/language/examine_text.h"

#include <algorithm>
#include <cmath>
#include <random>
#include <utility>
#include <vector>

#include "carnot/system/system_functions.h"

namespace carnot::language {
namespace {

// Random phase points at which H exists, the same for the same system, and H there.
class Samples {
 public:
  static constexpr int kTries = 40;

  // As many as are wanted, of kTries that are tried.
  explicit Samples(const Dynamics& dynamics, std::size_t wanted = kPoints)
      : dynamics_(dynamics), z_dot_(2 * dynamics.dof) {
    std::mt19937_64 bits(1);
    std::uniform_real_distribution<double> number(-1, 1);
    for (int i = 0; i < kTries && points_.size() < wanted; ++i) {
      std::vector<double> z(2 * dynamics.dof);
      for (double& x : z) x = number(bits);
      double h = 0;
      const RateStatus status = hamiltonian(z, h);
      if (status == RateStatus::kOk && std::isfinite(h)) {
        points_.push_back(z);
        values_.push_back(h);
        rates_.push_back(z_dot_);
      } else if (failure_ == RateStatus::kOk || failure_ == RateStatus::kNotFinite) {
        failure_ = status == RateStatus::kOk ? RateStatus::kNotFinite : status;
      }
    }
  }

  [[nodiscard]] const std::vector<std::vector<double>>& points() const { return points_; }
  [[nodiscard]] RateStatus failure() const { return failure_; }

  // Whether H(moved z) = H(z) at all of them, to round-off.
  template <class Move>
  [[nodiscard]] bool invariant(const Move& move) {
    constexpr double kRoundOff = 1e-10;  // functions of large arguments lose digits
    for (std::size_t i = 0; i < points_.size(); ++i) {
      std::vector<double> z = points_[i];
      move(z);
      double h = 0;
      if (hamiltonian(z, h) != RateStatus::kOk) return false;
      if (!(std::abs(h - values_[i]) <= kRoundOff * (1 + std::abs(values_[i])))) return false;
    }
    return true;
  }

  // Whether H does not depend on coordinate i.
  [[nodiscard]] bool cyclic(int i) {
    const bool still = std::all_of(rates_.begin(), rates_.end(), [&](const auto& rate) {
      return rate[dynamics_.dof + i] == 0;
    });
    return still && invariant([&](std::vector<double>& z) { z[i] += 0.7; });
  }

 private:
  static constexpr std::size_t kPoints = 4;

  RateStatus hamiltonian(const std::vector<double>& z, double& h) {
    const SystemFunctions& functions = *dynamics_.functions;
    const void* const system = dynamics_.system.get();
    std::vector<double> y(static_cast<std::size_t>(functions.algebraic));
    functions.branch(system, y.data());
    const RateStatus status = functions.rate(system, 0.3, z.data(), y.data(), z_dot_.data());
    if (status != RateStatus::kOk) return status;
    h = functions.hamiltonian(system, 0.3, z.data(), z.data() + dynamics_.dof, y.data());
    return status;
  }

  const Dynamics& dynamics_;
  std::vector<std::vector<double>> points_;
  std::vector<double> values_;
  std::vector<std::vector<double>> rates_;
  std::vector<double> z_dot_;
  RateStatus failure_ = RateStatus::kOk;
};

// All changes of signs that leave H as it is. They are a group: what is found makes others of those
// that are known.
std::vector<std::vector<double>> find_mirrors(int n, Samples& samples) {
  constexpr std::size_t kMost = 64;  // more are of no use to a search
  std::vector<bool> known(1u << n, false);
  std::vector<unsigned> group{0};
  known[0] = true;
  for (unsigned mask = 1; mask < (1u << n) && group.size() <= kMost; ++mask) {
    if (known[mask]) continue;
    const bool holds = samples.invariant([&](std::vector<double>& z) {
      for (int i = 0; i < n; ++i) {
        if ((mask >> i & 1u) == 0) continue;
        z[i] = -z[i];
        z[n + i] = -z[n + i];
      }
    });
    if (!holds) continue;
    const std::vector<unsigned> before = group;
    for (const unsigned other : before) {
      group.push_back(other ^ mask);
      known[other ^ mask] = true;
    }
  }
  std::vector<std::vector<double>> mirrors;
  for (std::size_t g = 1; g < group.size(); ++g) {
    std::vector<double> signs(n);
    for (int i = 0; i < n; ++i) signs[i] = (group[g] >> i & 1u) != 0 ? -1.0 : 1.0;
    mirrors.push_back(std::move(signs));
  }
  return mirrors;
}

// Turning (x, y) and these angles by the same angle leaves H as it is.
bool turns(int n, int x, int y, const std::vector<int>& angles, Samples& samples) {
  constexpr double kAngle = 0.7;
  const double c = std::cos(kAngle);
  const double s = std::sin(kAngle);
  return samples.invariant([&](std::vector<double>& z) {
    for (const int first : {0, n}) {
      const double a = z[first + x];
      const double b = z[first + y];
      z[first + x] = c * a - s * b;
      z[first + y] = s * a + c * b;
    }
    for (const int i : angles) z[i] += kAngle;
  });
}

// Rigid motions of a plane of two coordinates of one unit, with as many angles as turn with it.
bool find_plane(const std::vector<Coordinate>& coordinates,
                const std::vector<int>& cyclic,
                Samples& samples,
                Symmetries& symmetries) {
  const int n = static_cast<int>(coordinates.size());
  std::vector<int> angles;
  for (int i = 0; i < n; ++i) {
    if (is_angle(coordinates[i])) angles.push_back(i);
  }
  const unsigned all = 1u << angles.size();
  for (const int x : cyclic) {
    for (const int y : cyclic) {
      if (y <= x || is_angle(coordinates[x]) || is_angle(coordinates[y]) ||
          coordinates[x].unit != coordinates[y].unit) {
        continue;
      }
      for (unsigned left_out = 0; left_out < all; ++left_out) {
        std::vector<int> turning;
        for (std::size_t i = 0; i < angles.size(); ++i) {
          if ((left_out >> i & 1u) == 0) turning.push_back(angles[i]);
        }
        if (!turns(n, x, y, turning, samples)) continue;
        symmetries.x = x;
        symmetries.y = y;
        symmetries.angles = turning;
        return true;
      }
    }
  }
  return false;
}

}  // namespace

Symmetries find_symmetries(const Dynamics& dynamics) {
  Samples samples(dynamics);
  Symmetries symmetries;
  if (samples.points().empty()) return symmetries;
  symmetries.mirrors = find_mirrors(dynamics.dof, samples);
  std::vector<int> cyclic;
  for (int i = 0; i < dynamics.dof; ++i) {
    if (samples.cyclic(i)) cyclic.push_back(i);
  }
  find_plane(dynamics.info.configuration, cyclic, samples, symmetries);
  for (const int i : cyclic) {
    if (i != symmetries.x && i != symmetries.y) symmetries.cyclic.push_back(i);
  }
  return symmetries;
}

bool is_indefinite(const Dynamics& dynamics) {
  return Samples(dynamics, Samples::kTries).failure() == RateStatus::kMassNotPositive;
}

void check_text(const SceneSource& scene,
                const Formulation& formulation,
                const Dynamics& dynamics,
                std::string_view text,
                const std::string& file) {
  Samples samples(dynamics);
  Place place{1, 1};
  for (const auto& formula : {scene.kinetic, scene.lagrangian, scene.cost, scene.hamiltonian}) {
    if (formula) place = formula->place;
  }
  if (scene.mass) place = scene.mass->place;
  if (samples.points().empty()) {
    if (samples.failure() == RateStatus::kConstraintRank && !scene.rows.empty()) {
      place = scene.rows.front().place;
    }
    refuse_text(text,
                file,
                place,
                "at none of 40 random points the motion is defined: " +
                    std::string(describe(samples.failure())));
  }
  if (formulation.kind == Formulation::Kind::kGeneralizedHamiltonian) return;
  const int n = dynamics.dof;
  for (const SymmetrySource& symmetry : scene.symmetries) {
    std::vector<double> signs(static_cast<std::size_t>(n), 1.0);
    for (std::size_t i = 0; i < symmetry.coordinates.size(); ++i) {
      const int c = symmetry.coordinates[i];
      const Expression q = scene.graph->variable(kConfiguration.first + c);
      const Expression& image = symmetry.images[i];
      if (image.node != q.node || std::abs(image.coefficient) != 1) {
        refuse_text(text,
                    file,
                    symmetry.place,
                    "a symmetry is a change of signs; accepted: " + scene.coordinates[c].name +
                        " or -" + scene.coordinates[c].name);
      }
      signs[c] = image.coefficient;
    }
    const bool holds = samples.invariant([&](std::vector<double>& z) {
      for (int i = 0; i < n; ++i) {
        z[i] *= signs[i];
        z[n + i] *= signs[i];
      }
    });
    if (!holds) refuse_text(text, file, symmetry.place, "the scene does not have this symmetry");
  }
}

}  // namespace carnot::language
