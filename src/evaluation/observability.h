#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include <Eigen/Core>

#include "scene/depth_map.h"
#include "scene/region.h"
#include "scene/view.h"

namespace colmap_ext {

// The part of space that DTU's scanner observed [Jensen2014]: a voxel grid, as
// in ObsMask*.mat.
struct ObservabilityMask {
  std::array<size_t, 3> size{};  // X, Y, Z
  std::vector<uint8_t> voxels;   // [X, Y, Z], z fastest; not 0: observable
  Eigen::Vector3d origin =
      Eigen::Vector3d::Zero();  // center of the first voxel
  double resolution = 1;        // side of a voxel, scene units

  // Whether the nearest voxel is observable; false outside of the grid.
  bool Contains(const Eigen::Vector3f& point) const;
};

// The part of space in which a mesh and the truth are compared.
struct Observability {
  // Samples of the mesh outside do not count.
  std::optional<ObservabilityMask> mask;

  // Samples of both outside do not count.
  std::optional<Region> region;

  // Samples of the truth with a x + b y + c z + d <= 0 do not count: the ground
  // below the object. (a, b, c, d), as in DTU's Plane*.mat.
  std::optional<Eigen::Vector4d> ground_plane;

  // Erase the samples, world frame, that do not count.
  void RestrictMesh(std::vector<Eigen::Vector3f>* samples) const;
  void RestrictTruth(std::vector<Eigen::Vector3f>* samples) const;

  // Drops the true depths of a view outside of the region.
  void RestrictDepths(const View& view, DepthMap* depths) const;
};

}  // namespace colmap_ext
