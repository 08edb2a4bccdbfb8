#pragma once

#include <cstdint>
#include <vector>

#include "labeling/facet_labels.h"
#include "mesh/adjacency.h"
#include "mesh/triangle_mesh.h"
#include "photometry/photometric_energy.h"
#include "scene/view.h"

namespace colmap_ext {

// The footprint of a pixel on the surface at each vertex: [V] scene units. The
// mean over the views of the best pairs of the facets at the vertex; the median
// of all where there are none. 0 if no facet has a label.
// \param views  of the size of the level's images.
std::vector<float> VertexFootprints(const TriangleMesh& mesh,
                                    const VertexRings& rings,
                                    const FacetLabels& labels,
                                    const std::vector<View>& views);

// Whether any pixel is compared on a facet at the vertex: [V].
std::vector<uint8_t> SeenVertices(const TriangleMesh& mesh,
                                  const PhotometricTerms& terms);

// The pixels that each vertex accounts for: [V] a third of those compared on
// its facets, in all directions of all pairs, or of those that the facets
// cover, if that is more. Without the area, large facets of which little is
// compared have no stiffness, and the noise of a few pixels raises them to
// spikes (docs/method.md, section 6.2).
// \param footprints  [V] see VertexFootprints()
std::vector<float> PixelsOfVertices(const TriangleMesh& mesh,
                                    const PhotometricTerms& terms,
                                    const std::vector<float>& footprints);

}  // namespace colmap_ext
