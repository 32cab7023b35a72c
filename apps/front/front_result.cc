#include "front/front_result.h"

#include <fmt/format.h>

#include <array>
#include <utility>

#include "front/mesh_file.h"
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

Json surface_json(const FrontRequest& request, const FrontMesh& mesh) {
  Json json;
  json["length"] = mesh.length;
  json["vertices"] = mesh.vertices.size();
  json["triangles"] = mesh.triangles.size();
  json["left_out"] = mesh.message;
  if (request.check) {
    json["closed"] = mesh.closed;
    json["euler_characteristic"] = mesh.closed ? Json(mesh.euler) : Json(nullptr);
    json["volume"] = mesh.closed ? Json(mesh.volume) : Json(nullptr);
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

std::string surfaces_text(const FrontRequest& request, const std::vector<FrontMesh>& meshes) {
  std::string text;
  for (const FrontMesh& mesh : meshes) {
    text += fmt::format("{}: {} of length {:g}, {} vertices, {} triangles\n",
                        request.run.entry->info.name,
                        name_of(request.front.what),
                        mesh.length,
                        mesh.vertices.size(),
                        mesh.triangles.size());
    if (!mesh.message.empty()) text += mesh.message + '\n';
    if (request.check) {
      text += mesh.closed
                  ? fmt::format(
                        "closed, Euler characteristic {}, volume {:.6g}\n", mesh.euler, mesh.volume)
                  : "not closed\n";
    }
    text += fmt::format("{} searches, {:.3g} seconds\n", mesh.searches, mesh.elapsed_seconds);
  }
  return text;
}

// Why the surfaces are no result; empty where they are.
std::string surfaces_failure(const FrontRequest& request, const std::vector<FrontMesh>& meshes) {
  for (const FrontMesh& mesh : meshes) {
    if (mesh.triangles.empty()) {
      return fmt::format("no triangles at the length {:g}: try a --bound", mesh.length);
    }
    if (request.check && !mesh.closed) {
      return fmt::format(
          "the sphere of length {:g} is not closed: try a lesser --edge, or another --seed",
          mesh.length);
    }
  }
  return "";
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
    const std::vector<int> first{0, 1, 2};
    return mesh_text(request.output,
                     request.run.dynamics.info,
                     meshes,
                     request.front.project.empty() ? first : request.front.project);
  };
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
