#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "labeling/facet_labels.h"
#include "mesh/triangle_mesh.h"
#include "scene/gray_image.h"
#include "scene/view.h"

namespace colmap_ext {

struct ShownMesh;

// What two images show of a facet.
struct FacetMatch {
  GrayImage first;             // around the facet, as the first view shows it
  GrayImage warped;            // the second image, seen from the first view by
                               // way of the surface; 0 where that is not seen
  std::optional<double> zncc;  // of the windows of the facet, by their weights;
                               // nothing if none can be compared
};

// The scene's views that see a facet, by its corners: ascending.
std::vector<uint32_t> ViewsOfFacet(const ShownMesh& mesh, uint32_t facet);

// The pair that refines a facet, by its label; without one, of the views that
// see it the two in which it is largest.
std::optional<ViewPair> PairOfFacet(const ShownMesh& mesh, uint32_t facet,
                                    const std::vector<View>& views);

// Compares two images on a facet as the refinement does, in windows of 5 x 5
// pixels (photometry/window_correlation.h), at full size.
// \pre the images have the sizes of their views
FacetMatch MatchFacet(const TriangleMesh& mesh, uint32_t facet,
                      const View& first, const GrayImage& first_image,
                      const View& second, const GrayImage& second_image);

}  // namespace colmap_ext
