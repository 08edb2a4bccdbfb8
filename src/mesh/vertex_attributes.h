#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "base/rows.h"
#include "mesh/triangle_mesh.h"
#include "scene/point_cloud.h"

namespace colmap_ext {

// Colours, views and confidences of the vertices of a mesh.
struct VertexAttributes {
  std::vector<Color> colors;  // [V] or empty
  Rows<uint32_t> views;       // [V] indices of the views that see each vertex,
                              // ascending
  std::vector<float> confidences{};  // [V] in [0, 1] or empty: how well the
                                     // surface there is known; 0 is unseen
};

// Returns the attributes of new vertices, each the midpoint of two old ones or
// twice the same old one: mean colours, rounded up, the views of either, and
// mean confidences.
// \param sources [V] two old vertices each
// \pre sources are in range of the attributes
VertexAttributes InterpolateAttributes(
    const VertexAttributes& attributes,
    const std::vector<std::array<uint32_t, 2>>& sources);

// Returns colours and views for a mesh without .vis that was made from the
// points: the colour of the nearest point, however far, and the views of the
// four nearest within three mean edge lengths of the vertex. A vertex far from
// all points gets no views. No colours if the points have none.
//
// \pre there are points, all finite; facet indices are in range, vertices are
//      finite
VertexAttributes NearestAttributes(const TriangleMesh& mesh,
                                   const PointCloud& points);

}  // namespace colmap_ext
