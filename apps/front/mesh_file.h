// Surfaces of triangles as files: .vtp for ParaView, .ply, .csv with the vertices alone.
#pragma once

#include <string>
#include <vector>

#include "carnot/shooting/wavefront.h"

namespace carnot::apps {

// The text of a file with that ending. The place of a vertex is that of the coordinates `seen`.
std::string mesh_text(const std::string& path,
                      const SceneInfo& info,
                      const std::vector<FrontMesh>& meshes,
                      const std::vector<int>& seen);

}  // namespace carnot::apps
