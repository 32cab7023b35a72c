#include "front/mesh_file.h"

#include <fmt/format.h>

#include <cmath>
#include <functional>
#include <iterator>

#include "text/output_file.h"

namespace carnot::apps {
namespace {

using Buffer = std::back_insert_iterator<std::string>;

// What is said of a vertex besides its place: a name, and its number.
struct Column {
  std::string name;
  std::function<double(const FrontMesh&, const FrontVertex&)> value;
};

std::vector<Column> columns_of(const SceneInfo& info) {
  std::vector<Column> columns;
  for (std::size_t j = 0; j < info.configuration.size(); ++j) {
    columns.push_back({"q_" + info.configuration[j].name,
                       [j](const FrontMesh&, const FrontVertex& v) { return v.q[j]; }});
  }
  for (std::size_t j = 0; j < info.configuration.size(); ++j) {
    columns.push_back({"p0_" + info.configuration[j].name,
                       [j](const FrontMesh&, const FrontVertex& v) { return v.p0[j]; }});
  }
  columns.push_back({"t_cut", [](const FrontMesh&, const FrontVertex& v) { return v.cut_time; }});
  columns.push_back(
      {"t_conj", [](const FrontMesh&, const FrontVertex& v) { return v.conjugate_time; }});
  columns.push_back({"length", [](const FrontMesh& m, const FrontVertex&) { return m.length; }});
  return columns;
}

std::string csv(const SceneInfo& info, const std::vector<FrontMesh>& meshes) {
  const std::vector<Column> columns = columns_of(info);
  std::string out;
  for (const Column& column : columns) out += column.name + ",";
  out += "label\n";
  for (const FrontMesh& mesh : meshes) {
    for (const FrontVertex& vertex : mesh.vertices) {
      for (const Column& column : columns) {
        const double x = column.value(mesh, vertex);
        if (!std::isnan(x)) fmt::format_to(Buffer(out), "{:.17g}", x);
        out += ',';
      }
      out += name_of(vertex.label);
      out += '\n';
    }
  }
  return out;
}

// In formats without words labels are numbers, which a line tells: those of vertices come first.
std::string legend() {
  std::string out = "label:";
  for (int i = 0; i < kFrontLabels; ++i) {
    fmt::format_to(
        Buffer(out), "{} {} {}", i == 0 ? "" : ",", i, name_of(static_cast<FrontLabel>(i)));
  }
  return out;
}

std::size_t vertices_of(const std::vector<FrontMesh>& meshes) {
  std::size_t count = 0;
  for (const FrontMesh& mesh : meshes) count += mesh.vertices.size();
  return count;
}

std::size_t triangles_of(const std::vector<FrontMesh>& meshes) {
  std::size_t count = 0;
  for (const FrontMesh& mesh : meshes) count += mesh.triangles.size();
  return count;
}

std::size_t segments_of(const std::vector<FrontMesh>& meshes) {
  std::size_t count = 0;
  for (const FrontMesh& mesh : meshes) count += mesh.segments.size();
  return count;
}

void put_triangles(const std::vector<FrontMesh>& meshes, const char* format, std::string& out) {
  std::size_t first = 0;
  for (const FrontMesh& mesh : meshes) {
    for (const auto& [a, b, c] : mesh.triangles) {
      fmt::format_to(Buffer(out), fmt::runtime(format), first + a, first + b, first + c);
    }
    first += mesh.vertices.size();
  }
}

void put_segments(const std::vector<FrontMesh>& meshes, std::string& out) {
  std::size_t first = 0;
  for (const FrontMesh& mesh : meshes) {
    for (const auto& [a, b] : mesh.segments) {
      fmt::format_to(Buffer(out), "{} {}\n", first + a, first + b);
    }
    first += mesh.vertices.size();
  }
}

// x, y and z of a vertex; a curve in the plane has z = 0.
void put_place(const FrontVertex& vertex, const std::vector<int>& seen, std::string& out) {
  for (const int j : seen) fmt::format_to(Buffer(out), "{:.17g} ", vertex.q[j]);
  for (std::size_t k = seen.size(); k < 3; ++k) out += "0 ";
}

// The polygon file format of Stanford, as text.
std::string ply(const SceneInfo& info,
                const std::vector<FrontMesh>& meshes,
                const std::vector<int>& seen) {
  const std::vector<Column> columns = columns_of(info);
  std::string out = "ply\nformat ascii 1.0\ncomment " + legend() + "\n";
  fmt::format_to(Buffer(out), "element vertex {}\n", vertices_of(meshes));
  for (const char* name : {"x", "y", "z"}) {
    fmt::format_to(Buffer(out), "property double {}\n", name);
  }
  for (const Column& column : columns) {
    fmt::format_to(Buffer(out), "property double {}\n", column.name);
  }
  out += "property int label\n";
  const bool curves = segments_of(meshes) > 0;
  if (curves) {
    fmt::format_to(Buffer(out), "element edge {}\n", segments_of(meshes));
    out += "property int vertex1\nproperty int vertex2\nend_header\n";
  } else {
    fmt::format_to(Buffer(out), "element face {}\n", triangles_of(meshes));
    out += "property list uchar int vertex_indices\nend_header\n";
  }
  for (const FrontMesh& mesh : meshes) {
    for (const FrontVertex& vertex : mesh.vertices) {
      put_place(vertex, seen, out);
      for (const Column& column : columns) {
        fmt::format_to(Buffer(out), "{:.17g} ", column.value(mesh, vertex));
      }
      fmt::format_to(Buffer(out), "{}\n", static_cast<int>(vertex.label));
    }
  }
  put_triangles(meshes, "3 {} {} {}\n", out);
  put_segments(meshes, out);
  return out;
}

// The polygonal data of VTK, in XML.
std::string vtp(const SceneInfo& info,
                const std::vector<FrontMesh>& meshes,
                const std::vector<int>& seen) {
  std::string out =
      "<?xml version=\"1.0\"?>\n<VTKFile type=\"PolyData\" version=\"1.0\" "
      "byte_order=\"LittleEndian\">\n<PolyData>\n";
  fmt::format_to(
      Buffer(out),
      "<Piece NumberOfPoints=\"{}\" NumberOfLines=\"{}\" NumberOfPolys=\"{}\">\n<Points>\n"
      "<DataArray type=\"Float64\" NumberOfComponents=\"3\" format=\"ascii\">\n",
      vertices_of(meshes),
      segments_of(meshes),
      triangles_of(meshes));
  for (const FrontMesh& mesh : meshes) {
    for (const FrontVertex& vertex : mesh.vertices) {
      put_place(vertex, seen, out);
      out.back() = '\n';
    }
  }
  out += "</DataArray>\n</Points>\n<PointData>\n";
  for (const Column& column : columns_of(info)) {
    fmt::format_to(
        Buffer(out), "<DataArray type=\"Float64\" Name=\"{}\" format=\"ascii\">\n", column.name);
    for (const FrontMesh& mesh : meshes) {
      for (const FrontVertex& vertex : mesh.vertices) {
        fmt::format_to(Buffer(out), "{:.17g}\n", column.value(mesh, vertex));
      }
    }
    out += "</DataArray>\n";
  }
  out += "<!-- " + legend() + " -->\n<DataArray type=\"Int32\" Name=\"label\" format=\"ascii\">\n";
  for (const FrontMesh& mesh : meshes) {
    for (const FrontVertex& vertex : mesh.vertices) {
      fmt::format_to(Buffer(out), "{}\n", static_cast<int>(vertex.label));
    }
  }
  out += "</DataArray>\n";
  // Cells are lines or triangles: their corners, and where the corners of each end.
  const bool curves = segments_of(meshes) > 0;
  const char* cells = curves ? "Lines" : "Polys";
  const std::size_t corners = curves ? 2 : 3;
  const std::size_t count = curves ? segments_of(meshes) : triangles_of(meshes);
  fmt::format_to(Buffer(out),
                 "</PointData>\n<{}>\n<DataArray type=\"Int32\" Name=\"connectivity\" "
                 "format=\"ascii\">\n",
                 cells);
  put_triangles(meshes, "{} {} {}\n", out);
  put_segments(meshes, out);
  out += "</DataArray>\n<DataArray type=\"Int32\" Name=\"offsets\" format=\"ascii\">\n";
  for (std::size_t i = 1; i <= count; ++i) fmt::format_to(Buffer(out), "{}\n", corners * i);
  fmt::format_to(Buffer(out), "</DataArray>\n</{}>\n", cells);
  return out + "</Piece>\n</PolyData>\n</VTKFile>\n";
}

}  // namespace

std::string mesh_text(const std::string& path,
                      const SceneInfo& info,
                      const std::vector<FrontMesh>& meshes,
                      const std::vector<int>& seen) {
  if (has_ending(path, ".vtp")) return vtp(info, meshes, seen);
  if (has_ending(path, ".ply")) return ply(info, meshes, seen);
  return csv(info, meshes);
}

}  // namespace carnot::apps
