#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "viewer/draw_settings.h"
#include "viewer/shown_scene.h"

namespace colmap_ext {

// What colours of a mesh belong to; as viewer_mesh.frag has them.
enum class ColorsOf : int { kPlain, kVertices, kFacets, kNormals };

struct MeshColors {
  ColorsOf of = ColorsOf::kPlain;
  std::vector<uint32_t> colors;  // [V] or [F] or empty; red in the lowest byte
  float shading = 1;             // 0: none, 1: full
};

// The colours of a mesh by a mode; plain ones if it does not have the data.
MeshColors ColorsByMode(const ShownMesh& mesh, MeshMode mode);

// What a mode misses of a mesh, and where it comes from, in one line; empty if
// nothing is missing.
std::string MissingData(const ShownMesh& mesh, MeshMode mode);

}  // namespace colmap_ext
