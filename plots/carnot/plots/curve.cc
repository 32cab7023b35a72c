#include "carnot/plots/curve.h"

#include <algorithm>

#include "carnot/plots/script.h"

namespace carnot::plots {

std::string heading(const SceneInfo& info, const Curve& curve) {
  if (curve.name.empty()) return escaped(info.name);
  return escaped(info.name + ": " + curve.name);
}

std::string numbers_line(const SceneInfo& info, const Curve& curve) {
  constexpr int kDigits = 6;
  std::string text = "action " + number(curve.action, kDigits);
  if (curve.length) text += ", length " + number(*curve.length, kDigits);
  for (const auto& [name, value] : curve.extremes) {
    text += ", " + name + " " + number(value, 4);
    for (const Extreme& extreme : info.extremes) {
      if (extreme.name == name && !extreme.unit.empty()) text += " " + extreme.unit;
    }
  }
  std::replace(text.begin(), text.end(), '_', ' ');
  return escaped(text);
}

std::string coordinate_symbol(const SceneInfo& info, std::size_t i) {
  return i < info.configuration.size() ? symbol(info.configuration[i].name)
                                       : "q_{" + std::to_string(i + 1) + "}";
}

std::string coordinate_unit(const SceneInfo& info, std::size_t i) {
  return i < info.configuration.size() ? info.configuration[i].unit : std::string();
}

std::vector<std::size_t> spread(std::size_t rows, std::size_t count) {
  const std::size_t n = std::min(rows, std::max<std::size_t>(count, 2));
  std::vector<std::size_t> indices;
  for (std::size_t i = 0; i < n; ++i) {
    indices.push_back(n == 1 ? 0 : (i * (rows - 1) + (n - 1) / 2) / (n - 1));
  }
  return indices;
}

Trajectory thinned(const Trajectory& trajectory, std::size_t rows) {
  Trajectory thin;
  for (const std::size_t i : spread(trajectory.t.size(), rows)) {
    thin.t.push_back(trajectory.t[i]);
    thin.q.push_back(trajectory.q[i]);
    thin.p.push_back(trajectory.p[i]);
    thin.lambda.push_back(trajectory.lambda[i]);
    thin.hamiltonian.push_back(trajectory.hamiltonian[i]);
    if (!trajectory.work.empty()) thin.work.push_back(trajectory.work[i]);
  }
  return thin;
}

}  // namespace carnot::plots
