#pragma once

#include <cstdint>
#include <vector>

#include <Eigen/Core>

#include "mesh/triangle_mesh.h"
#include "scene/color_image.h"
#include "scene/point_cloud.h"
#include "scene/view.h"

namespace colmap_ext {

// A mesh and what belongs to its parts; a point cloud is one without facets.
struct DrawnMesh {
  TriangleMesh mesh;
  std::vector<Eigen::Vector3f> normals;  // [V] or empty
  std::vector<Color> colors;             // [V] or empty
  std::vector<int32_t> labels;           // [F] or empty
};

enum class RenderMode {
  kShaded,     // grey, facet by facet
  kWireframe,  // the same with the facets' edges
  kNormals,    // red, green, blue for x, y, z of the facets' normals
  kColor,      // the vertices' colours
  kLabels,     // a colour for each label, else for each component
};

// The colour of a label in pictures, far from those of the labels beside it; a
// negative one stands for none and is plain.
Color LabelColor(int32_t label);

// Picture of a mesh from a camera, 2 x 2 rays a pixel. Both sides of a facet
// are lit; those seen from behind are red, so that holes and flipped facets
// show. What has no facets is drawn as discs, one a point.
// \param point_radius of the discs, px
ColorImage RenderMesh(const DrawnMesh& drawn, const View& view, RenderMode mode,
                      double point_radius);

// A camera of the given size that has all of the mesh but stray vertices in
// its picture, and looks at its broad side from above.
View AutomaticView(const DrawnMesh& drawn, int width, int height);

// A camera at `eye` that looks at `target`, with `up` upwards in its picture.
View LookAtView(const Eigen::Vector3d& eye, const Eigen::Vector3d& target,
                const Eigen::Vector3d& up, int width, int height);

// The part of a view around (u, v), fractions of its width and height, `zoom`
// times as large, as a picture of the given size.
View CropView(const View& view, double zoom, double u, double v, int width,
              int height);

}  // namespace colmap_ext
