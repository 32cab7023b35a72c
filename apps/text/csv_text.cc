#include "text/csv_text.h"

#include <fmt/format.h>

namespace carnot::apps {
namespace {

std::string header(const SceneInfo& info, int multipliers) {
  std::string line = "t";
  for (const char* prefix : {",q_", ",p_"}) {
    for (const Coordinate& coordinate : info.configuration) line += prefix + coordinate.name;
  }
  for (int i = 1; i <= multipliers; ++i) line += ",lambda_" + std::to_string(i);
  return line + ",hamiltonian\n";
}

void append(std::string& out, const std::vector<double>& values) {
  for (const double x : values) out += fmt::format(",{:.17g}", x);
}

}  // namespace

std::string csv_text(const SceneInfo& info,
                     int multipliers,
                     const std::vector<const Trajectory*>& trajectories) {
  const bool several = trajectories.size() > 1;
  std::string out = (several ? "geodesic," : "") + header(info, multipliers);
  for (std::size_t g = 0; g < trajectories.size(); ++g) {
    const Trajectory& trajectory = *trajectories[g];
    for (std::size_t i = 0; i < trajectory.t.size(); ++i) {
      if (several) out += std::to_string(g + 1) + ",";
      out += fmt::format("{:.17g}", trajectory.t[i]);
      append(out, trajectory.q[i]);
      append(out, trajectory.p[i]);
      append(out, trajectory.lambda[i]);
      append(out, {trajectory.hamiltonian[i]});
      out += '\n';
    }
  }
  return out;
}

}  // namespace carnot::apps
