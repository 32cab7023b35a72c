#include "carnot/shooting/front/caustic_form.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "carnot/shooting/linear/dense.h"
#include "carnot/shooting/rays/ray.h"

namespace carnot::internal {
namespace {

using Eigen::Matrix2d;
using Eigen::MatrixXd;
using Eigen::Vector2d;
using Eigen::Vector3d;

// The place that is u away from a momentum, in units of its ways.
UnitMomentum moved(const std::array<UnitMomentum, 2>& ways,
                   const UnitMomentum& at,
                   const Vector2d& u) {
  UnitMomentum place = at;
  for (int k = 0; k < 2; ++k) {
    place.c += u[k] * ways[k].c;
    place.w += u[k] * ways[k].w;
  }
  place.c.normalize();
  return place;
}

// E beside a momentum, u from it, at any time.
class FormBeside {
 public:
  FormBeside(const Dynamics& dynamics,
             const std::vector<double>& from,
             const UnitMomenta& momenta,
             const UnitMomentum& at,
             double t)
      : dynamics_(dynamics), from_(from), momenta_(momenta), at_(at), ways_(momenta.ways(at)) {
    steps_ = Ray(dynamics, from, momenta.momentum(at)).enough_steps(t);
  }

  [[nodiscard]] UnitMomentum moved(const Vector2d& u) const {
    return internal::moved(ways_, at_, u);
  }
  [[nodiscard]] MatrixXd tangents(const UnitMomentum& place) const {
    MatrixXd t(dynamics_.dof, 2);
    for (int k = 0; k < 2; ++k) t.col(k) = momenta_.tangent(place, ways_[k]);
    return t;
  }
  // False where the flow fails. E is relative to the sizes of the first call.
  bool evaluate(const Vector2d& u, double t, Matrix2d& e) {
    const UnitMomentum place = moved(u);
    const auto end = Ray(dynamics_, from_, momenta_.momentum(place)).end(t, steps_);
    if (!end) return false;
    const int n = dynamics_.dof;
    const MatrixXd along = tangents(place);
    const MatrixXd x = product(end->tangent.topRows(n), along);
    moves_ = x / (end->tangent.topRows(n).norm() * along.norm());
    const MatrixXd p = product(end->tangent.bottomRows(n), along);
    if (size_ == 0) {
      size_ = p.norm() * end->tangent.topRows(n).norm() * along.norm();
    }
    const Matrix2d form = transposed_product(p, x) / size_;
    e = 0.5 * (form + form.transpose());
    return e.allFinite();
  }
  // X T of the last call, relative to |X| |T|.
  [[nodiscard]] const MatrixXd& moves() const { return moves_; }

 private:
  const Dynamics& dynamics_;
  const std::vector<double>& from_;
  const UnitMomenta& momenta_;
  UnitMomentum at_;
  std::array<UnitMomentum, 2> ways_;
  long steps_ = 1;
  double size_ = 0;
  MatrixXd moves_;
};

// Of central differences in u, where a turn is 2 pi, and in t: their errors, h^2 and 1e-15 / h, are
// alike here.
constexpr double kStep = 1e-5;

// Whether a^3 + ... has one real line of zeros only, by the sign of its discriminant.
bool has_one_line(const std::array<Matrix2d, 2>& slope) {
  const double a = slope[0](0, 0);
  const double b = 2 * slope[0](0, 1) + slope[1](0, 0);
  const double c = 2 * slope[1](0, 1) + slope[0](1, 1);
  const double d = slope[1](1, 1);
  return 18 * a * b * c * d - 4 * b * b * b * d + b * b * c * c - 4 * a * c * c * c -
             27 * a * a * d * d <
         0;
}

}  // namespace

std::optional<CausticForm> caustic_form(const Dynamics& dynamics,
                                        const std::vector<double>& from,
                                        const UnitMomenta& momenta,
                                        const UnitMomentum& at,
                                        double t) {
  FormBeside beside(dynamics, from, momenta, at, t);
  CausticForm form{at, t, {}, 0, 0, {}};
  Matrix2d e;
  if (!beside.evaluate(Vector2d::Zero(), t, e)) return std::nullopt;
  const RightSingular singular = right_singular(beside.moves());
  form.kernel = singular.vectors.col(1);
  form.other = singular.values[0];
  Matrix2d ahead;
  Matrix2d behind;
  if (!beside.evaluate(kStep * form.kernel, t, ahead) ||
      !beside.evaluate(-kStep * form.kernel, t, behind)) {
    return std::nullopt;
  }
  form.cubic = form.kernel.dot((ahead - behind) * form.kernel) / (2 * kStep);
  const Eigen::VectorXd dp = beside.tangents(at) * form.kernel;
  form.kernel_momenta.assign(dp.data(), dp.data() + dp.size());
  return form;
}

namespace {

// C of a form for the kernel on the side of another one.
double cubic_beside(const CausticForm& form, const std::vector<double>& kernel) {
  double along = 0;
  for (std::size_t j = 0; j < kernel.size(); ++j) along += form.kernel_momenta[j] * kernel[j];
  return along > 0 ? form.cubic : -form.cubic;
}

}  // namespace

double along_kernel(const Dynamics& dynamics,
                    const std::vector<double>& from,
                    const UnitMomenta& momenta,
                    const CausticForm& form) {
  constexpr double kWide = 3e-4;  // C is good to 1e-10, and the difference to the square of this
  const auto beside = [&](double part) {
    const UnitMomentum at = moved(momenta.ways(form.at), form.at, part * form.kernel);
    const auto other = caustic_form(dynamics, from, momenta, at, form.t);
    return other ? cubic_beside(*other, form.kernel_momenta) : std::nan("");
  };
  return (beside(kWide) - beside(-kWide)) / (2 * kWide);
}

std::optional<Swallowtail> find_swallowtail(const Dynamics& dynamics,
                                            const std::vector<double>& from,
                                            const UnitMomenta& momenta,
                                            UnitMomentum at,
                                            const ConjugateTime& conjugate_time) {
  constexpr int kIterations = 15;
  constexpr double kWide = 1e-3;  // of differences of D
  constexpr double kLongest = 0.1;
  constexpr double kConverged = 1e-6;
  for (int i = 0; i < kIterations; ++i) {
    std::vector<double> kernel;  // of the first form, at u = 0
    const auto equations = [&](const Vector2d& u) -> Vector2d {
      const UnitMomentum place = moved(momenta.ways(at), at, u);
      const auto form = caustic_form(dynamics, from, momenta, place, conjugate_time(place));
      if (!form) return Vector2d::Constant(std::nan(""));
      if (kernel.empty()) kernel = form->kernel_momenta;
      return {cubic_beside(*form, kernel), along_kernel(dynamics, from, momenta, *form)};
    };
    const Vector2d here = equations(Vector2d::Zero());
    Matrix2d jacobian;
    for (int k = 0; k < 2; ++k) {
      const Vector2d u = kWide * Vector2d::Unit(k);
      jacobian.col(k) = (equations(u) - equations(-u)) / (2 * kWide);
    }
    Vector2d step = small_lu_solve(jacobian, here);
    if (!step.allFinite()) return std::nullopt;
    const double longest = step.cwiseAbs().maxCoeff();
    if (longest > kLongest) step *= kLongest / longest;
    at = moved(momenta.ways(at), at, -step);
    if (longest < kConverged) return Swallowtail{at, conjugate_time(at)};
  }
  return std::nullopt;
}

std::optional<Umbilic> find_umbilic(const Dynamics& dynamics,
                                    const std::vector<double>& from,
                                    const UnitMomenta& momenta,
                                    UnitMomentum at,
                                    double t) {
  constexpr int kIterations = 25;
  constexpr double kConverged = 1e-10;  // of X T; the last steps gain what is left
  constexpr double kLongest = 0.3;      // step, of u and of log t
  std::optional<Umbilic> best;
  for (int i = 0; i < kIterations; ++i) {
    FormBeside beside(dynamics, from, momenta, at, t);
    const auto entries = [](const Matrix2d& e) { return Vector3d(e(0, 0), e(0, 1), e(1, 1)); };
    Matrix2d e;
    if (!beside.evaluate(Vector2d::Zero(), t, e)) break;
    const double error = beside.moves().norm();
    Eigen::Matrix3d jacobian;
    std::array<Matrix2d, 2> slope;
    for (int k = 0; k < 3; ++k) {
      const Vector2d u = k < 2 ? Vector2d(kStep * Vector2d::Unit(k)) : Vector2d::Zero();
      const double dt = k < 2 ? 0 : kStep * t;
      Matrix2d ahead;
      Matrix2d behind;
      if (!beside.evaluate(u, t + dt, ahead) || !beside.evaluate(-u, t - dt, behind)) return best;
      jacobian.col(k) = entries(ahead - behind) / (2 * kStep);
      if (k < 2) slope[k] = ahead - behind;
    }
    if (best && !(error < best->residual)) return best;
    if (error < kConverged) best = Umbilic{at, t, has_one_line(slope), error};
    Vector3d step = small_lu_solve(jacobian, entries(e));
    if (!step.allFinite()) break;
    const double longest = step.cwiseAbs().maxCoeff();
    if (longest > kLongest) step *= kLongest / longest;
    at = beside.moved(-step.head<2>());
    t *= 1 - step[2];
  }
  return best;
}

}  // namespace carnot::internal
