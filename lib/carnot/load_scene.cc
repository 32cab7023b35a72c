#include "carnot/load_scene.h"

#include <filesystem>
#include <fstream>
#include <iterator>
#include <optional>
#include <stdexcept>
#include <utility>

#include "carnot/flow/make_kernel.h"
#include "carnot/language/describe_text.h"
#include "carnot/language/examine_text.h"
#include "carnot/language/text_system.h"
#include "carnot/tableau/methods.h"
#include "carnot/tableau/own_method.h"

namespace carnot {

struct TextScene::Impl {
  std::string text;
  std::string name;
  std::string file;
  SceneInfo info;
  std::vector<TextParameter> parameters;
  std::shared_ptr<const language::TextSystem> system;

  // With `held`, velocities keep the value of that limit.
  static std::shared_ptr<const Impl> read(const std::string& text,
                                          const std::string& name,
                                          const std::string& file,
                                          const std::map<std::string, double>& values,
                                          std::optional<std::size_t> held = {});
  // All but the method.
  [[nodiscard]] Dynamics bind() const;
};

Dynamics TextScene::Impl::bind() const {
  auto bound = std::make_shared<language::TextBound>();
  bound->system = system;
  bound->branch.assign(static_cast<std::size_t>(system->algebraic), 0.0);
  Dynamics dynamics;
  dynamics.dof = system->dof;
  dynamics.multipliers = system->multipliers;
  dynamics.autonomous = system->autonomous;
  dynamics.info = info;
  dynamics.system = bound;
  dynamics.functions = &system->functions;
  dynamics.calls = system->calls;
  dynamics.holonomic = system->holonomic_count;
  dynamics.forced = system->holonomic_count;
  dynamics.on_leaves = dynamics.forced > 0;
  if (system->has_transcription) {
    dynamics.transcription = &system->transcription;
    dynamics.transcribed = system->transcribed;
  }
  return dynamics;
}

std::shared_ptr<const TextScene::Impl> TextScene::Impl::read(
    const std::string& text,
    const std::string& name,
    const std::string& file,
    const std::map<std::string, double>& values,
    std::optional<std::size_t> held) {
  language::SceneSource source = language::read_scene(text, name, file, values);
  if (held) language::hold(source, *held);
  auto impl = std::make_shared<Impl>();
  impl->text = text;
  impl->name = name;
  impl->file = file;
  for (const language::ParameterSource& p : source.parameters) {
    impl->parameters.push_back({p.name, p.default_value, p.value, p.unit, p.range, p.meaning});
  }
  try {
    language::Formulation formulation = language::formulate(source, text, file);
    const bool generalized =
        formulation.kind == language::Formulation::Kind::kGeneralizedHamiltonian;
    if (generalized && !source.limits.empty()) {
      language::refuse_text(text,
                            file,
                            source.limits.front().place,
                            "a limit on z: with 'hamiltonian' only a part of z is a configuration");
    }
    impl->info = language::describe_text(source, formulation);
    impl->system = std::make_shared<const language::TextSystem>(formulation, *source.graph);
    if (formulation.may_be_indefinite && language::is_indefinite(impl->bind())) {
      formulation = language::formulate(source, text, file, language::QuadraticBy::kNewton);
      impl->system = std::make_shared<const language::TextSystem>(formulation, *source.graph);
    }
    const Dynamics dynamics = impl->bind();
    language::check_text(source, formulation, dynamics, text, file);
    impl->info.symmetries = language::find_symmetries(dynamics);
    const bool takes_rows = source.kinetic || source.mass || !source.controls.empty();
    for (std::size_t i = 0; i < impl->info.limits.size() && takes_rows && !held; ++i) {
      impl->info.limits[i].held = [=] {
        TextScene scene;
        scene.impl_ = read(text, name, file, values, i);
        return make_dynamics(scene);
      };
    }
  } catch (const language::TooLarge&) {
    language::refuse_text(text, file, {1, 1}, "the formulas are too large");
  } catch (const language::NotFinite&) {
    language::refuse_text(text, file, {1, 1}, "a constant is infinite or not a number");
  }
  return impl;
}

const SceneInfo& TextScene::info() const { return impl_->info; }
const std::vector<TextParameter>& TextScene::parameters() const { return impl_->parameters; }
int TextScene::dof() const { return impl_->system->dof; }
int TextScene::multipliers() const { return impl_->system->multipliers; }
int TextScene::holonomic() const { return impl_->system->holonomic_count; }
const std::string& TextScene::text() const { return impl_->text; }

TextScene TextScene::with(const std::map<std::string, double>& values) const {
  std::map<std::string, double> all;
  for (const TextParameter& p : impl_->parameters) {
    if (p.value != p.default_value) all[p.name] = p.value;
  }
  for (const auto& [name, value] : values) all[name] = value;
  TextScene scene;
  scene.impl_ = Impl::read(impl_->text, impl_->name, impl_->file, all);
  return scene;
}

TextScene scene_from_text(const std::string& text,
                          const std::string& name,
                          const std::string& file) {
  TextScene scene;
  scene.impl_ = TextScene::Impl::read(text, name, file, {});
  return scene;
}

TextScene load_scene(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  if (!file || !std::filesystem::is_regular_file(path))
    throw std::invalid_argument(path + ": the file can't be read");
  const std::string text{std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
  if (file.bad()) throw std::invalid_argument(path + ": the file can't be read");
  std::string name = path.substr(path.find_last_of('/') + 1);
  const std::size_t ending = name.rfind(".scene");
  if (ending != std::string::npos && ending > 0) name.resize(ending);
  return scene_from_text(text, name, path);
}

namespace {

// `coefficients` are the method again, or its tableau.
template <class Coefficients>
Dynamics with_kernel(Dynamics dynamics, const Method& method, const Coefficients& coefficients) {
  dynamics.method = method.name;
  dynamics.order = method.order;
  dynamics.symplectic = method.symplectic;
  std::vector<double> periods;
  for (const Coordinate& c : dynamics.info.configuration) periods.push_back(c.period);
  dynamics.kernel = make_kernel(coefficients, periods, *dynamics.functions);
  return dynamics;
}

}  // namespace

Dynamics make_dynamics(const TextScene& scene, std::string_view name) {
  const Method& method = method_of_name(name);
  if (scene.holonomic() > 0 && method.family == kRattleFamily) {
    throw std::invalid_argument("method " + std::string(name) +
                                ": holonomic constraints from text are kept as Dh q' = 0, by the "
                                "other methods");
  }
  return with_kernel(scene.impl_->bind(), method, method);
}

Dynamics make_dynamics(const TextScene& scene, const OwnMethod& own) {
  return with_kernel(scene.impl_->bind(), own.method, own.tableau);
}

}  // namespace carnot
