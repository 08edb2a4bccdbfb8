#pragma once

#include "scene/view.h"
#include "tests/synthetic/ply_mesh.h"
#include "tests/synthetic/render.h"

namespace colmap_ext::synthetic {

enum class RenderMode {
  kShaded,     // grey, facet by facet
  kWireframe,  // the same with the facets' edges
  kNormals,    // red, green, blue for x, y, z of the facets' normals
  kColor,      // the vertices' colours
  kLabels,     // a colour for each label, else for each component
};

// Picture of a mesh from a camera, 2 x 2 rays a pixel. Both sides of a facet
// are lit; those seen from behind are red, so that holes and flipped facets
// show. What has no facets is drawn as discs, one a point.
// \param point_radius of the discs, px
ColorImage RenderMesh(const PlyMesh& ply, const View& view, RenderMode mode,
                      double point_radius);

// A camera of the given size that has all of the mesh but stray vertices in
// its picture, and looks at its broad side from above.
View AutomaticView(const PlyMesh& ply, int width, int height);

// A camera at `eye` that looks at `target`, with `up` upwards in its picture.
View LookAtView(const Eigen::Vector3d& eye, const Eigen::Vector3d& target,
                const Eigen::Vector3d& up, int width, int height);

// The part of a view around (u, v), fractions of its width and height, `zoom`
// times as large, as a picture of the given size.
View CropView(const View& view, double zoom, double u, double v, int width,
              int height);

}  // namespace colmap_ext::synthetic
