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
      out += vertex.label;
      out += '\n';
    }
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

void put_triangles(const std::vector<FrontMesh>& meshes, const char* format, std::string& out) {
  std::size_t first = 0;
  for (const FrontMesh& mesh : meshes) {
    for (const auto& [a, b, c] : mesh.triangles) {
      fmt::format_to(Buffer(out), fmt::runtime(format), first + a, first + b, first + c);
    }
    first += mesh.vertices.size();
  }
}

// The polygon file format of Stanford, as text.
std::string ply(const SceneInfo& info,
                const std::vector<FrontMesh>& meshes,
                const std::vector<int>& seen) {
  const std::vector<Column> columns = columns_of(info);
  std::string out = "ply\nformat ascii 1.0\n";
  fmt::format_to(Buffer(out), "element vertex {}\n", vertices_of(meshes));
  for (const char* name : {"x", "y", "z"}) {
    fmt::format_to(Buffer(out), "property double {}\n", name);
  }
  for (const Column& column : columns) {
    fmt::format_to(Buffer(out), "property double {}\n", column.name);
  }
  fmt::format_to(Buffer(out), "element face {}\n", triangles_of(meshes));
  out += "property list uchar int vertex_indices\nend_header\n";
  for (const FrontMesh& mesh : meshes) {
    for (const FrontVertex& vertex : mesh.vertices) {
      for (const int j : seen) fmt::format_to(Buffer(out), "{:.17g} ", vertex.q[j]);
      for (const Column& column : columns) {
        fmt::format_to(Buffer(out), "{:.17g} ", column.value(mesh, vertex));
      }
      out.back() = '\n';
    }
  }
  put_triangles(meshes, "3 {} {} {}\n", out);
  return out;
}

// The polygonal data of VTK, in XML.
std::string vtp(const SceneInfo& info,
                const std::vector<FrontMesh>& meshes,
                const std::vector<int>& seen) {
  std::string out =
      "<?xml version=\"1.0\"?>\n<VTKFile type=\"PolyData\" version=\"1.0\" "
      "byte_order=\"LittleEndian\">\n<PolyData>\n";
  fmt::format_to(Buffer(out),
                 "<Piece NumberOfPoints=\"{}\" NumberOfPolys=\"{}\">\n<Points>\n"
                 "<DataArray type=\"Float64\" NumberOfComponents=\"3\" format=\"ascii\">\n",
                 vertices_of(meshes),
                 triangles_of(meshes));
  for (const FrontMesh& mesh : meshes) {
    for (const FrontVertex& vertex : mesh.vertices) {
      for (const int j : seen) fmt::format_to(Buffer(out), "{:.17g} ", vertex.q[j]);
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
  out +=
      "</PointData>\n<Polys>\n<DataArray type=\"Int32\" Name=\"connectivity\" "
      "format=\"ascii\">\n";
  put_triangles(meshes, "{} {} {}\n", out);
  out += "</DataArray>\n<DataArray type=\"Int32\" Name=\"offsets\" format=\"ascii\">\n";
  for (std::size_t i = 1; i <= triangles_of(meshes); ++i) {
    fmt::format_to(Buffer(out), "{}\n", 3 * i);
  }
  return out + "</DataArray>\n</Polys>\n</Piece>\n</PolyData>\n</VTKFile>\n";
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
