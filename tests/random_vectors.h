#pragma once

#include <cstdint>
#include <vector>

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

// Integer coordinates in -range ... range.
inline std::vector<Eigen::Vector3f> RandomPoints(uint32_t num_points, int range,
                                                 Random* random) {
  std::vector<Eigen::Vector3f> points;
  for (uint32_t i = 0; i < num_points; ++i) {
    const int x = random->Integer(-range, range);
    const int y = random->Integer(-range, range);
    const int z = random->Integer(-range, range);
    points.emplace_back(x, y, z);
  }
  return points;
}

}  // namespace colmap_ext
