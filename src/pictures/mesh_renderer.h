#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include <Eigen/Core>

#include "mesh/triangle_mesh.h"
#include "scene/color_image.h"
#include "scene/point_cloud.h"
#include "scene/view.h"
#include "spatial/bvh.h"

namespace colmap_ext {

// The point where a ray of a picture meets the front of a facet.
struct FrontHit {
  uint32_t facet;
  Eigen::Vector3f areas;  // [3] twice the area of the triangle of the point and
                          // the side opposite to each corner, scene units^2
  float light;            // reflected by a white surface, 0 ... 1
};

// Red, green and blue of a hit, 0 ... 1. Called by several threads at a time.
using FrontColor = std::function<Eigen::Vector3f(const FrontHit& hit)>;

// Draws a mesh from any number of cameras with 2 x 2 rays per pixel. Back sides
// of facets are red, so that holes and flipped facets are visible.
class MeshRenderer {
 public:
  // \param mesh  outlives the renderer.
  // \pre facet indices are in range, vertices are finite
  explicit MeshRenderer(const TriangleMesh& mesh) : mesh_(mesh), bvh_(mesh) {}

  // Returns one picture for each coloring; they share the rays.
  std::vector<ColorImage> Draw(const View& view,
                               const std::vector<FrontColor>& colors) const;

 private:
  const TriangleMesh& mesh_;
  Bvh bvh_;
};

// The colors of the vertices, interpolated.
// \param mesh, colors  [V]; outlive the result.
// \param shade  strength of the shading, 0 ... 1
FrontColor VertexColors(const TriangleMesh& mesh,
                        const std::vector<Color>& colors, float shade);

// The colors of the facets' labels, shaded.
// \param labels  [F], as for LabelColor; outlive the result.
FrontColor LabelColors(const std::vector<int32_t>& labels);

// One color for all facets, shaded.
FrontColor PlainColor();

// The picture of a mesh from one camera, as MeshRenderer draws it.
ColorImage RenderMesh(const TriangleMesh& mesh, const View& view,
                      const FrontColor& front_color);

// The color of a label in pictures, which differs much from those of the next
// labels: the R3 sequence of [Roberts2018]. Negative (no label): plain.
Color LabelColor(int32_t label);

}  // namespace colmap_ext
