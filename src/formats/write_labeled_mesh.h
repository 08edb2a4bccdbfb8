#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "formats/atomic_file.h"
#include "mesh/triangle_mesh.h"
#include "scene/point_cloud.h"

namespace colmap_ext {

// A label of each facet, what it means and how it is drawn.
struct MeshLabels {
  std::vector<int32_t> labels;     // [F] index into names, -1: none
  std::vector<Color> colors;       // [F]
  std::vector<std::string> names;  // of the labels, one line each
};

// Writes a mesh with labelled facets: binary PLY whose vertices have uchar red,
// green, blue and the int label of the facets around them, and are there once
// for each of these labels; comments "label N: NAME" name the labels. Faces
// have no properties of their own, which COLMAP 4 does not read. Facets keep
// their order; vertices of no facet are left out.
// \param together  as WriteText()
// \throw FileError if it can not be written.
void WriteLabeledMesh(const std::filesystem::path& path,
                      const TriangleMesh& mesh, const MeshLabels& labels,
                      AtomicFiles* together = nullptr);

}  // namespace colmap_ext
