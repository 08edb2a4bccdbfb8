#pragma once

#include <cstddef>
#include <vector>

#include <Eigen/Core>

#include "mesh/triangle_mesh.h"
#include "scene/view.h"

namespace colmap_ext {

// Cameras for pictures of meshes. Widths and heights are px.

// Returns a camera that has nearly all of the points in its picture, without
// stray ones, and looks at their broad side from above.
// \param points  [P], world frame, scene units
// \param front  points from the broad side that is seen to the camera
View AutomaticView(const std::vector<Eigen::Vector3f>& points,
                   const Eigen::Vector3d& front, int width, int height);

// The same of a mesh, whose broad side is seen from the front of its facets.
View AutomaticView(const TriangleMesh& mesh, int width, int height);

// Returns the part of a view around (u, v), shares of its width and height,
// `zoom` times as large, as a picture of the given size.
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
