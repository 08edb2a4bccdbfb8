#include "raster/facet_clusters.h"

#include <algorithm>
#include <array>
#include <functional>

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

// A box in a view; infinitely near and of no pixels unless it lies before the
// camera and within the image.
FacetClusters::Seen SeenBox(const View& view, const Eigen::AlignedBox3f& box) {
  constexpr double kMargin = 2;  // px, for rounding; a choice
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  Eigen::AlignedBox2d pixels;
  double nearest = 0;
  for (int k = 0; k < 8; ++k) {
    const auto type = static_cast<Eigen::AlignedBox3f::CornerType>(k);
    const Eigen::Vector3d corner =
        view.CamFromWorld(box.corner(type).cast<double>());
    pixels.extend(view.ImageFromCam(corner));
    nearest = std::max(nearest, corner.z() > 0 ? 1 / corner.z() : kInfinity);
  }
  FacetClusters::Seen seen;
  if (nearest < kInfinity && IsWithin(view, pixels.min(), kMargin) &&
      IsWithin(view, pixels.max(), kMargin)) {
    seen.nearest = nearest;
    seen.pixels = {static_cast<int>(pixels.min().y() - kMargin),
                   static_cast<int>(pixels.max().y() + kMargin),
                   static_cast<int>(pixels.min().x() - kMargin),
                   static_cast<int>(pixels.max().x() + kMargin)};
  }
  return seen;
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

template <typename Function>
void FacetClusters::ForEachInFrustum(const View& view,
                                     const Function& function) const {
  const FrustumNormals normals = NormalsOf(view);
  const Eigen::Vector3d center = view.Center();
  for (size_t i = 0; i < boxes_.size(); ++i) {
    if (!IsOutside(normals, center, boxes_[i])) {
      function(i);
    }
  }
}

FacetRange FacetClusters::FacetsOf(size_t cluster) const {
  return {static_cast<uint32_t>(cluster * kSize),
          static_cast<uint32_t>(std::min(num_facets_, (cluster + 1) * kSize))};
}

std::vector<FacetRange> FacetClusters::InFrustum(const View& view) const {
  std::vector<FacetRange> ranges;
  ForEachInFrustum(view, [&](size_t i) {
    const FacetRange range = FacetsOf(i);
    if (!ranges.empty() && ranges.back().end == range.first) {
      ranges.back().end = range.end;
    } else {
      ranges.push_back(range);
    }
  });
  return ranges;
}

std::vector<FacetClusters::Seen> FacetClusters::NearestFirst(
    const View& view) const {
  std::vector<Seen> seen;
  ForEachInFrustum(view, [&](size_t i) {
    seen.push_back(SeenBox(view, boxes_[i]));
    seen.back().facets = FacetsOf(i);
  });
  std::ranges::stable_sort(seen, std::greater(), &Seen::nearest);
  return seen;
}

}  // namespace colmap_ext
