#pragma once

#include <optional>
#include <vector>

#include <Eigen/Core>

#include "scene/region.h"
#include "scene/view.h"

namespace colmap_ext {

// The box of what most views look at. A view looks at the points in its image
// that are at most twice as far as the median of them. Of the points that at
// least half as many views look at as at the best seen ones, the principal axes
// are the box's; it holds all of them but 1 % at each side, and a tenth of its
// size more on each side. The method and its numbers are choices.
//
// \param points  of the scene, e.g. the sparse ones, world frame
// \return nothing where too few points are seen to span a box.
std::optional<Region> FocusRegion(const std::vector<View>& views,
                                  const std::vector<Eigen::Vector3f>& points);

}  // namespace colmap_ext
