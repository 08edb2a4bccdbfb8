#pragma once

#include <cstddef>
#include <vector>

#include "meshing/ray_ends.h"
#include "scene/view.h"

namespace colmap_ext {

// Drops points of walls that are there twice. Where two groups of images
// disagree, the fused points hold a wall in two layers some pixels apart, and a
// surface that is cut between them jumps from one to the other. On a flat part
// of a wall the mean heights of the points that each image sees tell the groups
// apart, and the points of the group go whose images are mostly in the
// minority, there and elsewhere. Noise and relief, which all images see alike,
// and both sides of a thin wall stay (docs/method.md, section 1.3).
//
// Does not depend on the number of threads.
//
// \param weighted  ends of rays among it stay as they are
// \pre its positions are finite
// \return how many points were dropped
size_t DropWeakerLayers(const std::vector<View>& views,
                        WeightedCloud* weighted);

}  // namespace colmap_ext
