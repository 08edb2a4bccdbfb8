#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <vector>

#include "base/indices.h"
#include "mesh/mesh_in_image.h"
#include "mesh/triangle_mesh.h"
#include "raster/facet_clusters.h"
#include "scene/images.h"
#include "scene/view.h"

namespace colmap_ext {

// Indices of facets, or kNone, in three bytes each if these are enough.
class FacetIds {
 public:
  FacetIds() : FacetIds(0, 0) {}

  // All kNone.
  // \param num_facets  above all indices
  FacetIds(size_t size, size_t num_facets)
      : none_(BytesOfOne(num_facets) == 3 ? 0xFFFFFF : kNone),
        bytes_(BytesOfOne() * size + 1, 0xFF) {}  // [] reads four bytes

  static size_t BytesOfOne(size_t num_facets) {
    return num_facets < 0xFFFFFF ? 3 : 4;
  }

  size_t size() const { return bytes_.size() / BytesOfOne(); }
  size_t BytesOfOne() const { return none_ == kNone ? 4 : 3; }

  uint32_t operator[](size_t i) const {
    uint32_t facet = 0;
    std::memcpy(&facet, &bytes_[BytesOfOne() * i], sizeof(facet));
    facet &= none_;
    return facet == none_ ? kNone : facet;
  }

  void Set(size_t i, uint32_t facet) {
    std::memcpy(&bytes_[BytesOfOne() * i], &facet, 3);
    if (none_ == kNone) {
      bytes_[4 * i + 3] = static_cast<uint8_t>(facet >> 24);
    }
  }

  bool operator==(const FacetIds&) const = default;

 private:
  uint32_t none_;  // also the bits that an index may have
  std::vector<uint8_t> bytes_;
};

// Which facet each pixel of a view shows at its centre.
struct FacetIdBuffer {
  int width = 0;                   // px
  int height = 0;                  // px
  double min_cosine = 0;           // see IsFacing()
  FacetIds facets;                 // [height * width] or kNone
  std::vector<bool> is_masked;     // [height * width], see EraseMasked(), or
                                   // empty: none is
  std::vector<uint32_t> clipped;   // see FindClippedFacets()
  std::vector<FacetRange> ranges;  // the facets that were drawn, ascending:
                                   // of the others IsNearest() is false

  size_t Index(int row, int col) const {
    return static_cast<size_t>(row) * width + col;
  }
};

// A drawing with its depths. Views that are kept drop them, since DepthOf()
// computes them again.
struct DrawnFacets : FacetIdBuffer {
  std::vector<float> inverse_depths;  // [height * width], 1 / scene unit; 0
                                      // where there is no facet
};

// Draws a mesh into a view, both sides of the facets; the nearest one wins, of
// equally near ones the first. As graphics cards do, vertices are moved to the
// nearest 1/256 of a pixel, so that no pixel falls between neighbors. Of facets
// that reach behind the camera the part before it is drawn. Runs of facets that
// the view cannot show, outside its frustum or behind others, are passed over.
// \param clusters  of the mesh.
// \param min_cosine  see IsFacing(); in [0, 1).
DrawnFacets DrawFacets(const View& view, const TriangleMesh& mesh,
                       const FacetClusters& clusters, double min_cosine);

DrawnFacets DrawFacets(const View& view, const TriangleMesh& mesh,
                       double min_cosine);

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

// The inverse depth of a facet at the centres of pixels, as it is drawn, 1 /
// scene unit: linear, and within that of its corners.
struct DrawnDepth {
  double At(int row, int col) const {
    return std::clamp(value + row * row_step + col * col_step, min, max);
  }

  double value, row_step, col_step;  // at the first pixel, and to the next
  double min, max;
};

// \pre the view shows a part of the facet
DrawnDepth DepthOf(const View& view, const TriangleMesh& mesh,
                   const Facet& facet);

// Whether a drawn facet is nearer than an inverse depth at a pixel's centre.
// \pre as above
bool IsNearer(const View& view, const TriangleMesh& mesh, const Facet& facet,
              int row, int col, double inverse_depth);

// Whether the cosine between a drawn facet's normal and the ray to the camera
// is above min_cosine, or 0 for those of `clipped`.
inline bool IsFacing(const View& view, const TriangleMesh& mesh,
                     const FacetIdBuffer& drawn, uint32_t facet) {
  const bool is_clipped = std::ranges::binary_search(drawn.clipped, facet);
  return IsFacing(mesh, mesh.facets[facet], view.Center(),
                  is_clipped ? 0 : drawn.min_cosine);
}

// Pixels: one for the way from a point to its pixel's centre, and one more as a
// neighbor that is drawn there may be steeper.
inline constexpr double kNearestTolerance = 2;

// Whether a view sees a point of a facet: the pixel shows the facet, or what it
// shows is not nearer than the facet's plane by more than the plane's slope
// over two pixels plus two footprints (docs/method.md, section 4.2).
// \param mesh  that was drawn
// \param slope  PlaneSlope() of the facet.
// \param u, v  the point in the view, px, inside the image.
// \param inverse_depth  of the point, 1 / scene unit.
inline bool IsNearest(const View& view, const TriangleMesh& mesh,
                      const FacetIdBuffer& drawn, uint32_t facet, double slope,
                      double u, double v, double inverse_depth) {
  const auto row = static_cast<int>(v);
  const auto col = static_cast<int>(u);
  const size_t pixel = drawn.Index(row, col);
  const uint32_t shown = drawn.facets[pixel];
  if (shown == facet) {
    return true;
  }
  if (shown == kNone) {
    return drawn.is_masked.empty() || !drawn.is_masked[pixel];
  }
  const double footprint = inverse_depth / std::min(view.fx, view.fy);
  return !IsNearer(view, mesh, mesh.facets[shown], row, col,
                   inverse_depth + kNearestTolerance * (slope + footprint));
}

}  // namespace colmap_ext
