#pragma once

#include "scene/color_image.h"
#include "scene/view.h"
#include "tests/synthetic/ply_mesh.h"

namespace colmap_ext::synthetic {

enum class DrawMode {
  kShaded,     // grey, facet by facet
  kWireframe,  // the same with the facets' edges
  kNormals,    // red, green, blue for x, y, z of the facets' normals
  kColor,      // the vertices' colours, if there are any
  kLabels,     // a colour for each label, else for each component
};

// Draws a mesh, or the points of a cloud as discs in their colours, whatever
// the mode.
// \param point_radius  of the discs, px
ColorImage DrawPlyMesh(const PlyMesh& ply, const View& view, DrawMode mode,
                       double point_radius);

}  // namespace colmap_ext::synthetic
