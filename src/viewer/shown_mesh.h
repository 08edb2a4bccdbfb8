#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "labeling/facet_labels.h"
#include "viewer/shown_scene.h"

namespace colmap_ext {

// The elements that colors belong to, as in viewer_mesh.frag.
enum class ColorsOf : int { kPlain, kVertices, kFacets, kNormals };

struct MeshColors {
  ColorsOf of = ColorsOf::kPlain;
  std::vector<uint32_t> colors;  // [V] or [F] or empty; red in the lowest byte
  float shading = 1;             // 0: none, 1: full
};

// The colors of a mesh by a mode; plain if the mesh has no such data.
MeshColors ColorsByMode(const ShownMesh& mesh, MeshMode mode);

// The data that a mesh lacks for a mode, and how to get it, in one line; empty
// if none is missing.
std::string MissingData(const ShownMesh& mesh, MeshMode mode);

// A mesh of about `max_facets` facets to draw instead of a large one while the
// camera moves: vertices within a cube of a grid become one [Rossignac1993].
// Not manifold; keeps labels and colors.
// \pre max_facets > 0
ShownMesh CoarseMesh(const ShownMesh& mesh, size_t max_facets);

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
