#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <vector>

#include <Eigen/Core>

#include "mesh/triangle_mesh.h"
#include "scene/images.h"
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

// Unit direction to the light, above and left of the camera, world frame.
Eigen::Vector3f SunDirection(const View& view);

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

// Drawings for reports.

// Returns the color of an error: dark violet for 0 over green to yellow for
// `scale` and beyond, the color map viridis [Smith2015], interpolated linearly.
// It is readable for the color-blind.
// \pre scale > 0
Color ErrorColor(double error, double scale);

// Returns the end of a color scale: the smallest of 1, 2 and 5 times a power of
// ten that is not below the 95th percentile of the errors; 1 if that is 0.
double ErrorScale(std::vector<double> errors);

// Draws a mesh in the colors of its vertices' errors, ErrorColor(), above a
// color scale of 70 px height. Back sides of facets are red.
// \param colors  [V]
// \param scale  error at the end of the scale, scene units
ColorImage DrawErrors(const TriangleMesh& mesh,
                      const std::vector<Color>& colors, const View& view,
                      double scale);

// Draws points as squares of `side` px, the nearest on top. Points without
// colors are gray, where there is none it is white.
// \pre side > 0
ColorImage DrawPoints(const PointCloud& cloud, const View& view, int side);

// Returns a picture at another size; where it gets smaller each pixel is the
// mean of those it covers.
// \pre all sizes are positive
ColorImage ResizePicture(const ColorImage& image, int width, int height);

// Returns a picture whose longer side has at most max_size px, in the same
// proportions; one that is not longer stays as it is.
// \pre max_size > 0
ColorImage ShrinkPicture(ColorImage image, int max_size);

// Cameras for pictures of meshes. Widths and heights are px.

// Returns the medians of the points' coordinates; 0 without points.
Eigen::Vector3d MedianPoint(const std::vector<Eigen::Vector3f>& points);

// Returns a camera that sees nearly all points, except stray ones, from above
// their broad side.
// \param points  [P], world frame, scene units
// \param front  direction from the points to the side of the camera
View AutomaticView(const std::vector<Eigen::Vector3f>& points,
                   const Eigen::Vector3d& front, int width, int height);

// The same for a mesh, whose facets are seen from the front.
View AutomaticView(const TriangleMesh& mesh, int width, int height);

// Returns the part of a view around (u, v), fractions of its width and height,
// magnified by `zoom`, as a picture of the given size.
View CropView(const View& view, double zoom, double u, double v, int width,
              int height);

// Returns up to `count` views that are spread out, of those that see much: of
// the views that see half as much as the one that sees most, that one, and then
// each time the one that is farthest from all that are chosen. Of equal ones
// the first.
// \param num_seen  [views] how much each sees; none of those that see nothing
//        is returned.
// \return indices of views, in the order of the choice
std::vector<size_t> SpreadViews(const std::vector<View>& views,
                                const std::vector<size_t>& num_seen,
                                size_t count);

}  // namespace colmap_ext
