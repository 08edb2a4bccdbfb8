#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>

namespace colmap_ext {

// What colours a mesh.
enum class MeshMode {
  kShaded,
  kColor,       // of the vertices
  kNormals,     // red, green, blue for x, y, z of the facets' normals
  kLabels,      // of the pair of views that refines each facet
  kErrors,      // colours of the vertices' errors
  kConfidence,  // dark violet for 0 to yellow for 1
};

// The name on the command line: "shaded", "color", "normals", "labels",
// "error", "confidence".
const char* NameOf(MeshMode mode);

// What is drawn of a scene, and how.
struct DrawSettings {
  size_t mesh = 0;  // of the scene's meshes
  MeshMode mode = MeshMode::kShaded;
  bool wireframe = false;
  bool backfaces = false;  // marks them red
  bool points = false;
  bool cameras = false;
  std::optional<size_t> image;  // of this view lies over it
  double image_opacity = 0.5;
  std::optional<uint32_t> picked;  // facet, whose edges are drawn
  bool stand_in = false;      // draws a coarse mesh in place of a large one
  double point_radius = 1.2;  // px
  int samples = 2;            // a pixel is the mean of their square
};

}  // namespace colmap_ext
