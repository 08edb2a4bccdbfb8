#pragma once

#include <array>
#include <vector>

#include <Eigen/Core>

#include "scene/view.h"

namespace colmap_ext {

// Corners of an image on its plane before its camera: upper left, upper right,
// lower left, lower right; world frame, scene units.
// \param depth  of the plane, scene units
std::array<Eigen::Vector3d, 4> ImageCorners(const View& view, double depth);

// Ends of the lines that cameras are drawn by, [2 L], world frame.
std::vector<Eigen::Vector3f> FrustumLines(const std::vector<View>& views,
                                          double depth);

// How far before their cameras images are drawn so that they are seen but do
// not hide each other: scene units.
double FrustumDepth(const std::vector<View>& views);

}  // namespace colmap_ext
