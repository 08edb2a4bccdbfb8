#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "mesh/triangle_mesh.h"
#include "scene/point_cloud.h"

namespace colmap_ext {

// A label of each facet, what it means and how it is drawn.
struct MeshLabels {
  std::vector<int32_t> labels;     // [F] index into names, -1: none
  std::vector<Color> colors;       // [F]
  std::vector<std::string> names;  // of the labels, one line each
};

// Writes a mesh with labelled facets: binary PLY whose faces have uchar red,
// green, blue and the int label; comments "label N: NAME" name the labels.
// \throw FileError if it can not be written.
void WriteLabeledMesh(const std::filesystem::path& path,
                      const TriangleMesh& mesh, const MeshLabels& labels);

}  // namespace colmap_ext
