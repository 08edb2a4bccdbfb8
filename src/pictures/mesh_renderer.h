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

// Where a ray of a picture meets the front of a facet.
struct FrontHit {
  uint32_t facet;
  float depth;             // scene units
  Eigen::Vector3f normal;  // unit, of the facet
  Eigen::Vector3f areas;   // [3] of the triangles that the point spans with the
                           // side opposite of each corner, times two: scene
                           // units squared
  float light;             // that a white surface reflects there, 0 ... 1
};

// Red, green and blue of a hit, 0 ... 1. Called by several threads at a time.
using FrontColor = std::function<Eigen::Vector3f(const FrontHit& hit)>;

// Draws a mesh from any number of cameras, 2 x 2 rays a pixel. Facets seen from
// behind are red, so that holes and flipped facets show.
class MeshRenderer {
 public:
  // \param mesh  outlives the renderer.
  // \pre facet indices are in range, vertices are finite
  explicit MeshRenderer(const TriangleMesh& mesh) : mesh_(mesh), bvh_(mesh) {}

  // Returns a picture in each of the colours; the rays are shared.
  std::vector<ColorImage> Draw(const View& view,
                               const std::vector<FrontColor>& colors) const;

 private:
  const TriangleMesh& mesh_;
  Bvh bvh_;
};

// The colours of the vertices, interpolated.
// \param mesh, colors  [V]; outlive what is returned.
// \param shade  share of the light in them: 0 is none, 1 is a shaded surface.
FrontColor VertexColors(const TriangleMesh& mesh,
                        const std::vector<Color>& colors, float shade);

// The colours of the facets' labels, shaded.
// \param labels  [F], as for LabelColor; outlive what is returned.
FrontColor LabelColors(const std::vector<int32_t>& labels);

// One colour for all, shaded.
FrontColor PlainColor();

// The picture of a mesh from one camera, as MeshRenderer draws it.
ColorImage RenderMesh(const TriangleMesh& mesh, const View& view,
                      const FrontColor& front_color);

// The same in the colours of the vertices, without shades.
// \param colors  [V]
ColorImage RenderVertexColors(const TriangleMesh& mesh,
                              const std::vector<Color>& colors,
                              const View& view);

// The same in the colours of the facets' labels.
// \param labels  [F], as for LabelColor
ColorImage RenderLabels(const TriangleMesh& mesh,
                        const std::vector<int32_t>& labels, const View& view);

// The colour of a label in pictures, far from those of the next labels: the R3
// sequence of [Roberts2018]. A negative label stands for none and is plain.
Color LabelColor(int32_t label);

}  // namespace colmap_ext
