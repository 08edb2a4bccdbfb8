#pragma once

#include <vector>

#include <Eigen/Core>

#include "scene/view.h"
#include "viewer/orbit_camera.h"
#include "viewer/shown_scene.h"

namespace colmap_ext {

// The middle of a mesh or cloud, whatever strays: medians, world frame.
Eigen::Vector3d Middle(const ShownMesh& mesh);

// A camera that has all of it in its picture; see pictures/picture_views.h.
OrbitCamera FirstCamera(const ShownMesh& mesh, int width, int height);

// What is upwards: in the mean of the cameras; without any, in the view.
Eigen::Vector3d Upwards(const std::vector<View>& cameras, const View& view);

}  // namespace colmap_ext
