#pragma once

#include <cstdint>
#include <vector>

#include "base/rows.h"
#include "mesh/adjacency.h"
#include "mesh/triangle_mesh.h"
#include "photometry/photometric_energy.h"
#include "raster/visibility_buffers.h"
#include "scene/point_cloud.h"
#include "scene/view.h"

namespace colmap_ext {

// [F] whether the images agree on a surface well enough to refine it. If they
// show something else than the surface, such as the sky through a membrane
// between two roofs, correlation is low all around, and refinement would only
// add false relief. The correlation is taken from the surroundings of each
// vertex (AverageOverSurroundings), so that edges and highlights have no
// effect.
// \param terms [F] of the surface
// \param min_zncc  that the surroundings need; -1 or less: none.
std::vector<uint8_t> ConfirmedFacets(const TriangleMesh& mesh,
                                     const VertexRings& rings,
                                     const PhotometricTerms& terms,
                                     const PhotometricOptions& options,
                                     double min_zncc);

// How well points confirm each vertex of a surface that was not made from them
// one by one: [V] in [0, 1] (docs/method.md, section 7.6). Each point supports
// the facet next to it that faces the views that see it, if it is not farther
// than a few pixels; FacetConfidences() then compares support and size.
// \param vertex_views [V] the views that see each vertex, < views.size()
// \param points  finite; their views are < views.size()
// \pre facet indices are in range, the vertices are finite
std::vector<float> PointConfidences(const TriangleMesh& mesh,
                                    const Rows<uint32_t>& vertex_views,
                                    const PointCloud& points,
                                    const std::vector<View>& views);

// The confidence of each vertex of a refined surface: [V] in [0, 1]
// (docs/method.md, section 7.6). With t the share of texture in the pixels that
// are compared on the facets at the vertex, sum of w / number of pixels, and Z
// their mean correlation, it is
//   before + t max(0, Z - before):
// images confirm what points do not, such as glossy paint. Where points confirm
// what images do not, such as leaves, which look different from everywhere, the
// confidence stays.
// \param before [V] without the images, in [0, 1]; empty: 0 everywhere
// \param terms  of the mesh
std::vector<float> RefinedConfidences(const TriangleMesh& mesh,
                                      const PhotometricTerms& terms,
                                      const PhotometricOptions& options,
                                      const std::vector<float>& before);

// Returns [F] max(0, (f - b) / (f + b)), where f views see a facet from the
// front and b from behind, as they never see a solid object; 1 where none does.
std::vector<float> FrontShares(const VisibilityBuffers& buffers);

}  // namespace colmap_ext
