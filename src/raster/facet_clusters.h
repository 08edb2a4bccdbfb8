#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include <Eigen/Geometry>

#include "mesh/triangle_mesh.h"
#include "scene/view.h"

namespace colmap_ext {

// Facets first, first + 1, ... end - 1.
struct FacetRange {
  uint32_t first = 0;
  uint32_t end = 0;

  bool operator==(const FacetRange&) const = default;
};

// Calls function(facet) for the facets of ranges, in turn.
template <typename Function>
void ForEachFacet(std::span<const FacetRange> ranges,
                  const Function& function) {
  for (const auto& [first, end] : ranges) {
    for (uint32_t facet = first; facet < end; ++facet) {
      function(facet);
    }
  }
}

// A rectangle of pixels, both ends included.
struct PixelBox {
  int first_row = 0, last_row = -1;
  int first_col = 0, last_col = -1;

  bool IsEmpty() const { return first_row > last_row || first_col > last_col; }
};

// How far outside the image facets are still drawn and may face the camera, px.
// They may move into the image before the mesh is drawn again; a choice.
inline constexpr int kImageMargin = 16;

// The bounding boxes of a mesh's facets in runs of kSize. A view passes over
// the runs that lie outside its frustum, so that what it costs grows with what
// it sees, if facets that follow each other lie near each other
// (SortAlongCurve() of mesh/space_filling_curve.h).
class FacetClusters {
 public:
  // A choice: one box for so many facets costs nothing beside them.
  static constexpr size_t kSize = 128;

  explicit FacetClusters(const TriangleMesh& mesh);

  // Runs, joined where they adjoin, that hold all facets of which any part may
  // lie within a view's image and kImageMargin around it; ascending.
  std::vector<FacetRange> InFrustum(const View& view) const;

  // A run of facets in a view.
  struct Seen {
    FacetRange facets;
    // The largest inverse depth of its box, 1 / scene unit; infinity if that
    // reaches behind the camera or out of the image.
    double nearest = std::numeric_limits<double>::infinity();
    PixelBox pixels;  // all that may show its facets, if nearest is finite
  };

  // The runs of InFrustum(), those with the nearest boxes first.
  std::vector<Seen> NearestFirst(const View& view) const;

 private:
  // Calls function(cluster) for those of InFrustum(), in turn.
  template <typename Function>
  void ForEachInFrustum(const View& view, const Function& function) const;

  FacetRange FacetsOf(size_t cluster) const;

  size_t num_facets_;
  std::vector<Eigen::AlignedBox3f> boxes_;  // [F / kSize, rounded up]
};

}  // namespace colmap_ext
