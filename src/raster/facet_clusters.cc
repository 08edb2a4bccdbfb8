#include "raster/facet_clusters.h"

#include <algorithm>
#include <array>

#include <tbb/parallel_for.h>

namespace colmap_ext {
namespace {

// A plane through the camera's centre: a point is outside where
// normal . (point - center) < 0. World frame.
using FrustumNormals = std::array<Eigen::Vector3d, 5>;

// Of the image's four sides, farther by a margin, and of the plane through the
// camera's centre.
FrustumNormals NormalsOf(const View& view) {
  const double left = (-1.0 * kImageMargin - view.cx) / view.fx;
  const double right = (view.width + kImageMargin - view.cx) / view.fx;
  const double top = (-1.0 * kImageMargin - view.cy) / view.fy;
  const double bottom = (view.height + kImageMargin - view.cy) / view.fy;
  FrustumNormals normals = {
      Eigen::Vector3d(1, 0, -left), Eigen::Vector3d(-1, 0, right),
      Eigen::Vector3d(0, 1, -top), Eigen::Vector3d(0, -1, bottom),
      Eigen::Vector3d(0, 0, 1)};
  for (Eigen::Vector3d& normal : normals) {
    normal = view.cam_from_world_rotation.transpose() * normal;
  }
  return normals;
}

// Whether a box lies outside one of the planes.
bool IsOutside(const FrustumNormals& normals, const Eigen::Vector3d& center,
               const Eigen::AlignedBox3f& box) {
  const Eigen::Vector3d low = box.min().cast<double>() - center;
  const Eigen::Vector3d high = box.max().cast<double>() - center;
  return std::ranges::any_of(normals, [&](const Eigen::Vector3d& normal) {
    // The corner farthest along the normal.
    const auto farthest = (normal.array() > 0).select(high, low);
    return normal.dot(farthest.matrix()) < 0;
  });
}

}  // namespace

FacetClusters::FacetClusters(const TriangleMesh& mesh)
    : num_facets_(mesh.facets.size()),
      boxes_((num_facets_ + kSize - 1) / kSize) {
  tbb::parallel_for(size_t{0}, boxes_.size(), [&](size_t i) {
    const size_t end = std::min(num_facets_, (i + 1) * kSize);
    for (size_t facet = i * kSize; facet < end; ++facet) {
      for (const uint32_t vertex : mesh.facets[facet]) {
        boxes_[i].extend(mesh.vertices[vertex]);
      }
    }
  });
}

std::vector<FacetRange> FacetClusters::InFrustum(const View& view) const {
  const FrustumNormals normals = NormalsOf(view);
  const Eigen::Vector3d center = view.Center();
  std::vector<FacetRange> ranges;
  for (size_t i = 0; i < boxes_.size(); ++i) {
    if (IsOutside(normals, center, boxes_[i])) {
      continue;
    }
    const auto first = static_cast<uint32_t>(i * kSize);
    const auto end =
        static_cast<uint32_t>(std::min(num_facets_, (i + 1) * kSize));
    if (!ranges.empty() && ranges.back().end == first) {
      ranges.back().end = end;
    } else {
      ranges.push_back({first, end});
    }
  }
  return ranges;
}

}  // namespace colmap_ext
