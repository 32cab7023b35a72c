#include "front/front_result.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

#include "carnot/plots/plot_file.h"
#include "carnot/plots/script.h"
#include "carnot/plots/surface_plot.h"
#include "front/mesh_file.h"
#include "run/ends.h"
#include "text/text_table.h"

namespace carnot::apps {
namespace {

Json cut_time_json(const FrontRequest& request,
                   const CutTime& cut,
                   const std::vector<std::string>& arguments) {
  Json json = result_head(arguments);
  json["scene"] = request.run.entry->info.name;
  json["parameters"] = parameters_json(request.run);
  json["from"] = request.from;
  json["momentum"] = request.momentum;
  json["method"] = request.run.method.name;
  json["status"] = cut.status == CutStatus::kConverged ? "converged" : "not_converged";
  json["message"] = cut.message;
  json["cut_time"] = or_null(cut.cut_time);
  json["conjugate_time"] = or_null(cut.conjugate_time);
  json["partner_p0"] = or_null(cut.partner_p0);
  json["label"] = cut.label;
  json["max_time"] = cut.max_time;
  json["searches"] = cut.searches;
  json["elapsed_seconds"] = cut.elapsed_seconds;
  return json;
}

std::string cut_time_text(const FrontRequest& request, const CutTime& cut) {
  constexpr int kDigits = 15;
  const std::string none = fmt::format("none up to {:g}", cut.max_time);
  const auto time = [&](const std::optional<double>& t) {
    return t ? text_number(*t, kDigits) : none;
  };
  std::vector<std::vector<std::string>> rows{{"cut time", time(cut.cut_time)},
                                             {"conjugate time", time(cut.conjugate_time)}};
  if (cut.partner_p0) rows.push_back({"partner's p0", text_vector(*cut.partner_p0, kDigits)});
  rows.push_back({"label", cut.label});
  rows.push_back({"seconds", text_number(cut.elapsed_seconds, 3)});
  return fmt::format("{}: how long p0 = {} is the shortest way\n\n",
                     request.run.entry->info.name,
                     text_vector(request.momentum, kDigits)) +
         text_table(rows);
}

const char* name_of(FrontKind what) {
  constexpr std::array kNames{"front", "sphere", "caustic", "cut"};
  return kNames[static_cast<int>(what)];
}

// What is inside of a sphere.
const char* inside_of(const FrontRequest& request) {
  return request.from.size() == 2 ? "area" : "volume";
}

// A singular point of a caustic.
Json singular_json(const FrontVertex& point) {
  Json json;
  json["q"] = point.q;
  json["p0"] = point.p0;
  json["conjugate_time"] = point.conjugate_time;
  json["label"] = name_of(point.label);
  return json;
}

Json surface_json(const FrontRequest& request, const FrontMesh& mesh) {
  Json json;
  json["length"] = mesh.length;
  json["vertices"] = mesh.vertices.size();
  if (mesh.segments.empty()) {
    json["triangles"] = mesh.triangles.size();
  } else {
    json["segments"] = mesh.segments.size();
  }
  json["left_out"] = mesh.message;
  if (request.check) {
    json["closed"] = mesh.closed;
    json["euler_characteristic"] = mesh.closed ? Json(mesh.euler) : Json(nullptr);
    json[inside_of(request)] = mesh.closed ? Json(mesh.volume) : Json(nullptr);
  }
  if (request.front.cusps) {
    json["cusps"] = Json::array();
    for (const CuspEdge& edge : mesh.cusps) {
      Json line;
      const auto umbilic = [](int i) { return i < 0 ? Json(nullptr) : Json(i); };
      line["closed"] = edge.closed;
      line["umbilics"] = {umbilic(edge.first_umbilic), umbilic(edge.last_umbilic)};
      line["points"] = Json::array();
      for (const FrontVertex& point : edge.points) line["points"].push_back(singular_json(point));
      json["cusps"].push_back(std::move(line));
    }
    json["umbilics"] = Json::array();
    for (const FrontVertex& point : mesh.umbilics) json["umbilics"].push_back(singular_json(point));
    json["swallowtails"] = Json::array();
    for (const FrontVertex& point : mesh.swallowtails) {
      json["swallowtails"].push_back(singular_json(point));
    }
  }
  json["searches"] = mesh.searches;
  json["elapsed_seconds"] = mesh.elapsed_seconds;
  return json;
}

Json surfaces_json(const FrontRequest& request,
                   const std::vector<FrontMesh>& meshes,
                   const std::string& message,
                   const std::vector<std::string>& arguments) {
  Json json = result_head(arguments);
  json["scene"] = request.run.entry->info.name;
  json["parameters"] = parameters_json(request.run);
  json["from"] = request.from;
  json["method"] = request.run.method.name;
  json["what"] = name_of(request.front.what);
  json["status"] = message.empty() ? "completed" : "failed";
  json["message"] = message;
  json["surfaces"] = Json::array();
  for (const FrontMesh& mesh : meshes) json["surfaces"].push_back(surface_json(request, mesh));
  return json;
}

std::string cusps_text(const FrontMesh& mesh) {
  constexpr int kDigits = 12;
  constexpr int kDigitsOfDifferences = 6;
  const auto count = [&](const auto& which) {
    return std::count_if(mesh.cusps.begin(), mesh.cusps.end(), which);
  };
  const auto closed = count([](const CuspEdge& edge) { return edge.closed; });
  const auto between =
      count([](const CuspEdge& edge) { return edge.first_umbilic >= 0 && edge.last_umbilic >= 0; });
  std::string text = fmt::format("cusp lines: {} closed, {} from umbilic to umbilic, {} other\n",
                                 closed,
                                 between,
                                 static_cast<long>(mesh.cusps.size()) - closed - between);
  const auto tell = [&](const std::vector<FrontVertex>& points, int digits) {
    for (const FrontVertex& point : points) {
      text += fmt::format("{} at {}, time {}\n",
                          name_of(point.label),
                          text_vector(point.q, digits),
                          text_number(point.conjugate_time, digits));
    }
  };
  tell(mesh.umbilics, kDigits);
  tell(mesh.swallowtails, kDigitsOfDifferences);
  return text;
}

std::string surfaces_text(const FrontRequest& request, const std::vector<FrontMesh>& meshes) {
  std::string text;
  for (const FrontMesh& mesh : meshes) {
    text += fmt::format("{}: {} of length {:g}, {} vertices, {}\n",
                        request.run.entry->info.name,
                        name_of(request.front.what),
                        mesh.length,
                        mesh.vertices.size(),
                        mesh.segments.empty() ? fmt::format("{} triangles", mesh.triangles.size())
                                              : fmt::format("{} segments", mesh.segments.size()));
    if (!mesh.message.empty()) text += mesh.message + '\n';
    if (request.check) {
      text += mesh.closed ? fmt::format("closed, Euler characteristic {}, {} {:.6g}\n",
                                        mesh.euler,
                                        inside_of(request),
                                        mesh.volume)
                          : "not closed\n";
    }
    if (request.front.cusps) text += cusps_text(mesh);
    text += fmt::format("{} searches, {:.3g} seconds\n", mesh.searches, mesh.elapsed_seconds);
  }
  return text;
}

// Why the surfaces are no result; empty where they are.
std::string surfaces_failure(const FrontRequest& request, const std::vector<FrontMesh>& meshes) {
  for (const FrontMesh& mesh : meshes) {
    if (!mesh.finished) return "the time limit was up before the surface was made";
    if (mesh.triangles.empty() && mesh.segments.empty()) {
      return fmt::format("nothing at the length {:g}: try a --bound", mesh.length);
    }
    if (request.check && !mesh.closed) {
      return fmt::format(
          "the sphere of length {:g} is not closed: {}",
          mesh.length,
          mesh.message.empty() ? "try a lesser --edge, or another --seed" : mesh.message);
    }
  }
  return "";
}

// The momentum that differs most on the surfaces: that along their line.
int widest_momentum(const std::vector<FrontMesh>& meshes, int dof) {
  int widest = 0;
  double most = -1;
  for (int j = 0; j < dof; ++j) {
    double largest = 0;
    for (const FrontMesh& mesh : meshes) {
      for (const FrontVertex& v : mesh.vertices) largest = std::max(largest, std::abs(v.p0[j]));
    }
    if (largest > most) widest = j;
    most = std::max(most, largest);
  }
  return widest;
}

// Where the sheets are on an axis: from the first value to the second.
std::pair<double, double> range_of(const plots::SurfacePage& page, int axis) {
  double low = std::numeric_limits<double>::infinity();
  double high = -low;
  for (const auto& sheet : page.sheets) {
    for (const auto& point : sheet.points) {
      if (!std::isfinite(point[axis])) continue;
      low = std::min(low, point[axis]);
      high = std::max(high, point[axis]);
    }
  }
  return {low, high};
}

// Through the start, across the axis where most is to be seen; or through the middle where sheets
// are elsewhere. Sheets that lie in a plane but for round-off, such as Martinet's cut locus, are
// not cut along it.
void choose_section(const FrontRequest& request,
                    const std::vector<int>& seen,
                    plots::SurfacePage& page) {
  constexpr double kFlat = 1e-7;
  const auto extent = [&](int axis) {
    const auto [low, high] = range_of(page, axis);
    return high - low;
  };
  const double widest = std::max({extent(0), extent(1), extent(2)});
  std::size_t most = 0;
  for (const int across : {1, 2, 0}) {
    std::size_t pieces = 0;
    const double at = request.from[seen[across]];
    for (const auto& sheet : page.sheets) pieces += plots::section_of(sheet, across, at).size();
    if (pieces <= 2 * most || extent(across) <= kFlat * widest) continue;
    most = pieces;
    page.across = across;
    page.at = at;
  }
  if (most > 0) return;
  const auto [low, high] = range_of(page, page.across);
  page.at = 0.5 * (low + high);
}

// The colour tells times where they differ, and else the momentum along the line.
std::string draw_surfaces(const FrontRequest& request,
                          const std::vector<FrontMesh>& meshes,
                          const std::string& file) {
  const SceneInfo& info = request.run.dynamics.info;
  const std::vector<int> seen = seen_coordinates(request.run.dynamics, request.front);
  const FrontKind what = request.front.what;
  const bool times = what == FrontKind::kCaustic || what == FrontKind::kCut;
  const int momentum = widest_momentum(meshes, request.run.dynamics.dof);
  plots::SurfacePage page;
  page.title = plots::escaped(fmt::format("{}: {}", info.name, name_of(what)));
  page.subtitle = "extremals of unit speed from " +
                  plots::escaped(end_text(request.from, std::vector<bool>(request.from.size())));
  page.color = times ? "length" : "p_{" + plots::symbol(info.configuration[momentum].name) + "}(0)";
  page.plane = seen.size() == 2;
  for (std::size_t k = 0; k < seen.size(); ++k) page.axes[k] = info.configuration[seen[k]];
  page.growing = plots::is_gif(file) && meshes.size() > 1;
  page.halved = what == FrontKind::kFront || (meshes.size() > 1 && !page.growing);
  for (const FrontMesh& mesh : meshes) {
    plots::SurfaceSheet sheet;
    sheet.title = fmt::format("{} {:g}", times ? "up to" : "length", mesh.length);
    sheet.triangles = mesh.triangles;
    sheet.segments = mesh.segments;
    for (const FrontVertex& v : mesh.vertices) {
      sheet.points.push_back({v.q[seen[0]], v.q[seen[1]], page.plane ? 0 : v.q[seen[2]]});
      const double time = what == FrontKind::kCut ? v.cut_time : v.conjugate_time;
      sheet.values.push_back(times ? time : v.p0[momentum]);
    }
    page.sheets.push_back(std::move(sheet));
  }
  if (page.plane) return plots::write_surfaces(file, page);
  for (const FrontMesh& mesh : meshes) {
    const auto seen_part = [&](const FrontVertex& v) {
      return std::array{v.q[seen[0]], v.q[seen[1]], v.q[seen[2]]};
    };
    for (const CuspEdge& edge : mesh.cusps) {
      auto& line = page.lines.emplace_back();
      for (const FrontVertex& v : edge.points) line.push_back(seen_part(v));
      if (edge.closed) line.push_back(line.front());
    }
    for (const FrontVertex& v : mesh.umbilics) page.points.push_back(seen_part(v));
    for (const FrontVertex& v : mesh.swallowtails) page.points.push_back(seen_part(v));
  }
  choose_section(request, seen, page);
  return plots::write_surfaces(file, page);
}

}  // namespace

Result surfaces_result(const FrontRequest& request,
                       const std::vector<FrontMesh>& meshes,
                       const std::vector<std::string>& arguments) {
  Result result;
  result.message = surfaces_failure(request, meshes);
  result.delivered = result.message.empty();
  result.json = surfaces_json(request, meshes, result.message, arguments);
  result.text = [&] { return surfaces_text(request, meshes); };
  result.csv = [&] {
    return mesh_text(request.output,
                     request.run.dynamics.info,
                     meshes,
                     seen_coordinates(request.run.dynamics, request.front));
  };
  result.draw = [&](const std::string& file) { return draw_surfaces(request, meshes, file); };
  return result;
}

Result cut_time_result(const FrontRequest& request,
                       const CutTime& cut,
                       const std::vector<std::string>& arguments) {
  Result result;
  result.delivered = cut.status == CutStatus::kConverged;
  result.message = "the cut time is not known: " + cut.message;
  result.json = cut_time_json(request, cut, arguments);
  result.text = [&] { return cut_time_text(request, cut); };
  return result;
}

}  // namespace carnot::apps
