#pragma once

#include <cstddef>
#include <vector>

#include <Eigen/Core>

#include "mesh/triangle_mesh.h"
#include "scene/view.h"

namespace colmap_ext {

// Cameras for pictures of meshes. Widths and heights are px.

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
