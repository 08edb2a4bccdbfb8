#pragma once

#include "tests/workspace/sphere_workspace.h"

namespace colmap_ext {

// A workspace of three images, two sparse points and two frames, so that its
// files are small.
inline SphereWorkspace SmallSphere() {
  SphereWorkspace sphere;
  sphere.images.resize(3);
  sphere.vis_order.resize(3);
  sphere.points.resize(20);
  sphere.point_images.assign(20, {0, 2});
  sphere.frames = {{2, 4}, {9}};
  return sphere;
}

}  // namespace colmap_ext
