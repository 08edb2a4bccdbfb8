#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include <Eigen/Core>

#include "mesh/triangle_mesh.h"
#include "scene/color_image.h"
#include "scene/point_cloud.h"
#include "scene/view.h"

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

// Returns the picture of a mesh from a camera, 2 x 2 rays a pixel. Facets seen
// from behind are red, so that holes and flipped facets show.
// \pre facet indices are in range, vertices are finite
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
