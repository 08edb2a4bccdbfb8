#pragma once

#include <vector>

#include <Eigen/Geometry>

#include "mesh/triangle_mesh.h"
#include "scene/view.h"

namespace colmap_ext {

// Clips a facet, of which any part may lie behind the camera, to what a view
// shows in a box of its image's plane [Sutherland1974]. Each side of the box is
// a plane through the camera's centre. No near plane is needed: between two
// opposite sides z is positive, but for the centre itself.
//
// An edge is cut at the same point in both of its facets.
//
// \param box  px; it may be larger than the image.
// \return the corners of a convex polygon in the camera's frame, all before the
//         camera; empty if the view shows no part of the facet in the box, or
//         the camera's centre lies on the facet.
std::vector<Eigen::Vector3d> ClipToImage(const View& view,
                                         const TriangleMesh& mesh,
                                         const Facet& facet,
                                         const Eigen::AlignedBox2d& box);

// The image less a border, px; more than the image where it is negative.
Eigen::AlignedBox2d ImageBox(const View& view, double border = 0);

}  // namespace colmap_ext
