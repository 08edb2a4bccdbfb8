#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "labeling/facet_labels.h"
#include "viewer/shown_scene.h"

namespace colmap_ext {

// The scene's views that see a corner of a facet, ascending.
std::vector<uint32_t> ViewsOfFacet(const ShownMesh& mesh, uint32_t facet);

// The pair of a facet's label; without a label, the two views in which the
// facet is largest.
std::optional<ViewPair> PairOfFacet(const ShownMesh& mesh, uint32_t facet,
                                    const std::vector<View>& views);

// Compares two images on a facet as the refinement does, in windows of 5 x 5
// pixels (photometry/window_correlation.h), at full size.
// \pre the images have the sizes of their views
FacetMatch MatchFacet(const TriangleMesh& mesh, uint32_t facet,
                      const View& first, const GrayImage& first_image,
                      const View& second, const GrayImage& second_image);

}  // namespace colmap_ext
