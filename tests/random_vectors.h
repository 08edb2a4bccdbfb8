#pragma once

#include <Eigen/Core>

#include "tests/random.h"

namespace colmap_ext {

// Uniform in a cube around the origin.
// \param size  half of its side
inline Eigen::Vector3d RandomVector(Random* random, double size = 1) {
  const auto any = [&] { return size * (2 * random->Unit() - 1); };
  const double z = any();
  const double y = any();
  return {any(), y, z};
}

// Uniform on the unit sphere.
inline Eigen::Vector3d RandomNormal(Random* random) {
  for (;;) {
    const Eigen::Vector3d vector = RandomVector(random);
    if (vector.norm() > 0.1 && vector.norm() < 1) {
      return vector.normalized();
    }
  }
}

}  // namespace colmap_ext
