#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

namespace colmap_ext {

// A coarse voxel mask of a part of space, to exclude rays that cannot pass
// through it: voxels of a box are marked if the part reaches into them.
class RayMask {
 public:
  static constexpr int kSize = 128;  // voxels an axis

  // \param bounds  of all that is to be marked
  explicit RayMask(const Eigen::AlignedBox3d& bounds);

  // Marks what a tetrahedron or a triangle may reach into. Safe from several
  // threads.
  // \param corners  four or three
  void Mark(std::span<const Eigen::Vector3d> corners);

  // To be called after the last mark.
  void Finish();

  // Whether a ray may pass through marked voxels.
  // \param direction  unit
  // \param length  scene units, or infinity
  bool MayPass(const Eigen::Vector3d& from, const Eigen::Vector3d& direction,
               double length) const;

  // Whether anything may be marked within a box.
  bool MayTouch(const Eigen::AlignedBox3d& box) const;

 private:
  static constexpr int kRatio = 4;
  static constexpr int kCoarseSize = kSize / kRatio;

  struct Plane {
    Eigen::Vector3d normal;
    double offset;  // what is to be marked lies at normal.dot(x) <= offset
  };
  using Voxel = std::array<int, 3>;

  Eigen::Vector3d ToVoxels(const Eigen::Vector3d& place) const {
    return (place - origin_).cwiseProduct(voxels_per_unit_);
  }
  static std::vector<Plane> PlanesAround(
      std::span<const Eigen::Vector3d> corners);
  void MarkWithin(const std::vector<Plane>& planes,
                  const Eigen::AlignedBox3d& box, const Voxel& first, int size);
  template <int kGridSize>
  static double FirstMark(const std::vector<uint8_t>& is_marked,
                          const Eigen::Vector3d& from,
                          const Eigen::Vector3d& way, double begin, double end);

  Eigen::Vector3d origin_;
  Eigen::Vector3d voxels_per_unit_;
  std::vector<uint8_t> is_marked_;  // [kSize^3]
  // [kCoarseSize^3] where any of kRatio^3 voxels is
  std::vector<uint8_t> is_coarse_marked_;
  // [(kSize + 1)^3] how many are marked before a voxel in all three axes.
  std::vector<uint32_t> sums_;
};

}  // namespace colmap_ext
