// Dynamics of a scene: the templates of the core behind the function pointers of dynamics.h.
#pragma once

#include <limits>
#include <memory>
#include <stdexcept>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

#include "carnot/dynamics.h"
#include "carnot/flow/make_kernel.h"
#include "carnot/scene/describe_scene.h"
#include "carnot/system/system_calls.h"
#include "carnot/system/system_of.h"
#include "carnot/tableau/methods.h"
#include "carnot/tableau/own_method.h"
#include "carnot/transcription/transcription_calls.h"

namespace carnot {

// Whether holonomic constraints of the scene need RATTLE.
template <class Scene>
inline constexpr bool kNeedsRattle = HasHolonomic<Scene> && !IsProduct<Scene>;

// Whether `method` can integrate the scene.
template <class Scene>
bool suits(const Method& method) {
  if (!HasHolonomic<Scene> || method.family == kRattleFamily) return true;
  return IsProduct<Scene> && keeps_quadratic_invariants(method);
}

// gauss16, or rattle where it is needed.
template <class Scene>
constexpr std::string_view default_method() {
  return kNeedsRattle<Scene> ? "rattle" : "gauss16";
}

namespace dynamics_calls {

// At the point where the rate is evaluated, or where that has failed.
template <class B>
Regularity regularity(const void* opaque, double t, const double* q_in, const double* p_in) {
  const B& bound = B::from(opaque);
  const Vector<double, B::n> q = vector_at<B::n>(q_in);
  const Vector<double, B::n> p = vector_at<B::n>(p_in);
  Vector<double, B::m> y = bound.branch;
  Rate<double, B::n> rate;
  (void)bound.system.rate(t, q, p, y, rate);
  return bound.system.regularity(t, q, p, y);
}

template <class B>
double momentum(const void* opaque,
                double t,
                const double* q_in,
                double* q_dot,
                const double* lambda_in,
                double* p_out) {
  const Vector<double, B::n> q = vector_at<B::n>(q_in);
  Vector<double, B::n> v = vector_at<B::n>(q_dot);
  Vector<double, B::n> p;
  const Vector<double, B::k> lambda = vector_at<B::k>(lambda_in);
  const double violated = B::from(opaque).system.admissible_momentum(t, q, v, lambda, p);
  store(v, q_dot);
  store(p, p_out);
  return violated;
}

template <class B>
void holonomic(
    const void* opaque, double t, const double* z, double* h, double* dh, double* q_dot) {
  const auto& system = B::from(opaque).system;
  const auto& scene = system.scene();
  constexpr int l = std::decay_t<decltype(scene)>::kHolonomic;
  const Vector<double, B::n> q = vector_at<B::n>(z);
  store(Vector<double, l>(scene.holonomic(q)), h);
  const Matrix<double, l, B::n> rows = holonomic_jacobian(scene, q);
  for (int i = 0; i < l; ++i) {
    for (int j = 0; j < B::n; ++j) dh[i * B::n + j] = rows(i, j);
  }
  Vector<double, B::m> y = B::from(opaque).branch;
  Vector<double, 2 * B::n> rate;
  const Vector<double, 2 * B::n> at = vector_at<2 * B::n>(z);
  if (phase_rate(system, t, at, y, rate) != RateStatus::kOk) {
    rate = filled<2 * B::n>(std::numeric_limits<double>::quiet_NaN());
  }
  store(part<0, B::n>(rate), q_dot);
}

template <class B>
bool project_on_manifold(const void* opaque, double t, double* z) {
  const auto& system = B::from(opaque).system;
  Vector<double, B::n> q = vector_at<B::n>(z);
  Vector<double, B::n> p = vector_at<B::n>(z + B::n);
  if (!project_configuration(system.scene(), q)) return false;
  if (project_momentum(system, t, q, p) != RateStatus::kOk) return false;
  store(q, z);
  store(p, z + B::n);
  return true;
}

template <class B>
bool tangent_projector(const void* opaque, double t, const double* z, double* projector) {
  Matrix<double, 2 * B::n, 2 * B::n> p;
  const Vector<double, 2 * B::n> at = vector_at<2 * B::n>(z);
  if (!manifold_projector(B::from(opaque).system, t, at, p)) return false;
  store(p, projector);
  return true;
}

template <class B>
double chart(const void* opaque, const double* q) {
  return B::from(opaque).system.scene().chart(vector_at<B::n>(q));
}

template <class B>
std::shared_ptr<const void> branch(
    const void* opaque, double t, const double* q, const double* p, const double* lambda) {
  const B& bound = B::from(opaque);
  auto other = std::make_shared<B>(bound);
  const RateStatus status = bound.system.branch(
      t, vector_at<B::n>(q), vector_at<B::n>(p), vector_at<B::k>(lambda), other->branch);
  if (status != RateStatus::kOk) return nullptr;
  return other;
}

// All but the kernel. B is SystemOnBranch; `functions` are those of its system.
template <class Scene, class B>
Dynamics bind(const Scene& scene,
              const Method& method,
              B bound,
              const SystemFunctions& functions = pointwise_functions_of<typename B::System>()) {
  using System = typename B::System;
  Dynamics dynamics;
  dynamics.dof = B::n;
  dynamics.multipliers = B::k;
  dynamics.autonomous = System::kAutonomous;
  dynamics.method = method.name;
  dynamics.order = method.order;
  dynamics.symplectic = method.symplectic;
  dynamics.info = describe_scene(scene);
  dynamics.system = std::make_shared<const B>(std::move(bound));
  dynamics.functions = &functions;
  dynamics.calls.momentum = momentum<B>;
  if constexpr (HasChart<Scene>) dynamics.calls.chart = chart<B>;
  if constexpr (HasRegularity<System>) dynamics.calls.regularity = regularity<B>;
  if constexpr (HasBranches<System>) dynamics.calls.branch = branch<B>;
  if constexpr (HasHolonomic<Scene>) {
    dynamics.holonomic = Scene::kHolonomic;
    dynamics.forced = method.family == kRattleFamily ? Scene::kHolonomic : 0;
    dynamics.calls.holonomic = holonomic<B>;
    dynamics.calls.project_on_manifold = project_on_manifold<B>;
    dynamics.calls.tangent_projector = tangent_projector<B>;
  }
  if constexpr (IsTranscribed<System>::value) {
    if (dynamics.forced > 0) return dynamics;
    dynamics.transcription = &transcription_of<B>();
    dynamics.transcribed = dynamics.transcription->constraints;
  }
  return dynamics;
}

inline std::vector<double> periods_of(const SceneInfo& info) {
  std::vector<double> periods;
  for (const Coordinate& coordinate : info.configuration) periods.push_back(coordinate.period);
  return periods;
}

// Throws std::invalid_argument where a parameter of the scene is out of its range, or the method
// does not suit the scene.
template <class Scene>
void check_method(const Scene& scene, const Method& method) {
  validate(scene);
  if (suits<Scene>(method)) return;
  throw std::invalid_argument("method " + method.name +
                              ": it does not keep the holonomic constraints of this scene");
}

// A method of methods() that suits the scene. Throws std::invalid_argument.
template <class Scene>
const Method& method_for(const Scene& scene, std::string_view name) {
  const Method& method = method_of_name(name);
  check_method(scene, method);
  return method;
}

// A Dynamics whose method runs in a kernel of the library. `coefficients` are the method again, or
// its tableau.
template <class Scene, class Coefficients>
Dynamics with_compiled_kernel(const Scene& scene,
                              const Method& method,
                              const Coefficients& coefficients) {
  using System = decltype(make_system(scene));
  const SystemFunctions& functions = functions_of<System>();
  Dynamics dynamics = bind(scene, method, SystemOnBranch<System>{make_system(scene)}, functions);
  dynamics.kernel = make_kernel(coefficients, periods_of(dynamics.info), functions);
  return dynamics;
}

}  // namespace dynamics_calls

// Whether a kernel of the library serves the scene.
template <class Scene>
inline constexpr bool kHasCompiledKernel = [] {
  using System = decltype(make_system(std::declval<const Scene&>()));
  return System::kDof <= kMostCompiled && kFitsKernel<System>;
}();

namespace dynamics_calls {

template <class Scene>
constexpr void require_compiled_kernel() {
  static_assert(!HasHolonomic<Scene>,
                "holonomic constraints: make_rattle_dynamics() of <carnot/make_rattle_dynamics.h>");
  static_assert(kHasCompiledKernel<Scene>,
                "more coordinates than kMostCompiled: make_inlined_dynamics() of "
                "<carnot/make_inlined_dynamics.h>");
}

}  // namespace dynamics_calls

// A Dynamics of the scene with a method of methods.h. Throws std::invalid_argument when a parameter
// of the scene is out of its range, or there is no such method for it.
//
// The method runs in a kernel that was compiled with the library, and reaches the scene through
// function pointers; so a scene compiles in seconds. Where there is no such kernel, two headers
// beside this one make a kernel for the scene.
template <class Scene>
Dynamics make_dynamics(const Scene& scene, std::string_view name = default_method<Scene>()) {
  using namespace dynamics_calls;
  require_compiled_kernel<Scene>();
  const Method& method = method_for(scene, name);
  return with_compiled_kernel(scene, method, method);
}

// The same with a method of one's own (own_method.h).
template <class Scene>
Dynamics make_dynamics(const Scene& scene, const OwnMethod& own) {
  using namespace dynamics_calls;
  require_compiled_kernel<Scene>();
  check_method(scene, own.method);
  return with_compiled_kernel(scene, own.method, own.tableau);
}

}  // namespace carnot
