#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include <Eigen/Geometry>

#include "mesh/triangle_mesh.h"
#include "raster/facet_clusters.h"
#include "scene/images.h"
#include "scene/view.h"

namespace colmap_ext {

// Which facet each pixel of a view shows at its centre, and how near.
struct FacetIdBuffer {
  int width = 0;                      // px
  int height = 0;                     // px
  std::vector<uint32_t> facets;       // [height * width] or kNone
  std::vector<float> inverse_depths;  // [height * width], 1 / scene unit; 0
                                      // where there is no facet, infinity
                                      // where the pixel is masked
  std::vector<bool> is_facing;        // [F] of those drawn, whether the cosine
                                      // between the normal and the ray to the
                                      // camera is above min_cosine, or 0 for
                                      // those of `clipped`; false outside the
                                      // image and kImageMargin around it
  std::vector<uint32_t> clipped;      // see FindClippedFacets()
  std::vector<FacetRange> ranges;     // the facets that were drawn, ascending:
                                      // of the others IsNearest() is false

  size_t Index(int row, int col) const {
    return static_cast<size_t>(row) * width + col;
  }
};

// Draws a mesh into a view, both sides of the facets; the nearest one wins, of
// equally near ones the first. As graphics cards do, vertices are moved to the
// nearest 1/256 of a pixel, so that no pixel falls between neighbors. Of facets
// that reach behind the camera the part before it is drawn. Runs of facets that
// the view cannot show, outside its frustum or behind others, are passed over.
// \param clusters  of the mesh.
// \param min_cosine  see FacetIdBuffer::is_facing; in [0, 1).
FacetIdBuffer DrawFacets(const View& view, const TriangleMesh& mesh,
                         const FacetClusters& clusters, double min_cosine);

FacetIdBuffer DrawFacets(const View& view, const TriangleMesh& mesh,
                         double min_cosine);

// Whether the cosine between a facet's normal and the ray from its centroid to
// the camera's centre is above min_cosine.
bool IsFacing(const TriangleMesh& mesh, const Facet& facet,
              const Eigen::Vector3d& camera, double min_cosine);

// The facets that are drawn by a part: those that reach the image, with a
// vertex behind the camera, or so close to its plane that it is seen 2^20 px or
// more away. Ascending.
// \param ranges  as of DrawFacets()
std::vector<uint32_t> FindClippedFacets(const View& view,
                                        const TriangleMesh& mesh,
                                        std::span<const FacetRange> ranges);

// Erases the masked pixels of a view, those of 0: they show no facet, and
// IsNearest() is false there.
// \pre the mask is of the buffer's size
void EraseMasked(const GrayImage& mask, FacetIdBuffer* buffer);

// A facet's plane, in the world frame.
struct FacetPlane {
  Eigen::Vector3d normal;  // towards free space; 0: degenerate
  Eigen::Vector3d corner;  // the first, scene units
};

// \return its normal is not of unit length
inline FacetPlane PlaneOfFacet(const TriangleMesh& mesh, const Facet& facet) {
  const auto [a, b, c] = CornersOf<double>(mesh, facet);
  return {(b - a).cross(c - a), a};
}

// A facet's plane, its normal of unit length, and the barycentric coordinates
// on it.
struct FacetFrame : FacetPlane {
  Eigen::Vector3d gradient_1;  // of the second corner's barycentric coordinate,
                               // 1 / scene unit
  Eigen::Vector3d gradient_2;  // of the third's
};

inline FacetFrame ComputeFacetFrame(const TriangleMesh& mesh,
                                    const Facet& facet) {
  const auto [a, b, c] = CornersOf<double>(mesh, facet);
  const Eigen::Vector3d edge_1 = b - a;
  const Eigen::Vector3d edge_2 = c - a;
  const Eigen::Vector3d cross = edge_1.cross(edge_2);
  const double area = cross.norm();  // twice
  if (!(area > 0)) {
    const Eigen::Vector3d zero = Eigen::Vector3d::Zero();
    return {{zero, a}, zero, zero};
  }
  const Eigen::Vector3d normal = cross / area;
  return {
      {normal, a}, edge_2.cross(normal) / area, normal.cross(edge_1) / area};
}

// By how much the inverse depth of a facet's plane changes in a view, at most,
// from a pixel to one of the eight around it, 1 / scene unit.
double PlaneSlope(const View& view, const FacetPlane& plane);

// Pixels: one for the way from a point to its pixel's centre, and one more as a
// neighbor that is drawn there may be steeper.
inline constexpr double kNearestTolerance = 2;

// Whether a view sees a point of a facet: the pixel shows the facet, or what it
// shows is not nearer than the facet's plane by more than the plane's slope
// over two pixels plus two footprints (docs/method.md, section 4.2).
// \param slope  PlaneSlope() of the facet.
// \param u, v  the point in the view, px, inside the image.
// \param inverse_depth  of the point, 1 / scene unit.
inline bool IsNearest(const View& view, const FacetIdBuffer& drawn,
                      uint32_t facet, double slope, double u, double v,
                      double inverse_depth) {
  const size_t pixel = drawn.Index(static_cast<int>(v), static_cast<int>(u));
  if (drawn.facets[pixel] == facet) {
    return true;
  }
  const double footprint = inverse_depth / std::min(view.fx, view.fy);
  return drawn.inverse_depths[pixel] <=
         inverse_depth + kNearestTolerance * (slope + footprint);
}

}  // namespace colmap_ext
