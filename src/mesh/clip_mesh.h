#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "mesh/surface.h"
#include "scene/region.h"

// What a mesh is reduced to: a region, facets of usual size, large components.
namespace colmap_ext {

// Cuts off what lies outside of a region. Facets across its border are cut
// along it: new vertices lie on the border, one an edge that is cut, so that
// the mesh stays as connected as it was. Vertices that float coordinates put a
// rounding beyond the border count as on it, so that clipping a mesh again
// changes nothing. A vertex on the border may become singular: see SplitFans().
// Vertices that no facet uses any more are dropped; facets inside keep their
// order, parts of others come in their place.
// \return what the mesh comes from; nothing where all of it lies inside
// \pre facet indices are in range, vertices are finite
std::optional<Provenance> ClipMesh(const Region& region, TriangleMesh* mesh);

// The same for a manifold surface, which stays manifold.
std::optional<Provenance> CutOff(const Region& region, Surface* surface);

// Drops the facets with a side longer than `factor` times the given percentile
// (0 ... 100) of the facets' longest sides; none where the factor is 0.
// \return how many
// \pre facet indices are in range
size_t DropLongFacets(double factor, double percentile, TriangleMesh* mesh);

struct DroppedComponents {
  size_t num_components = 0;
  size_t num_facets = 0;
};

// Drops the components, connected through edges, of less than min_facets
// facets.
DroppedComponents DropSmallComponents(size_t min_facets,
                                      std::vector<Facet>* facets);

}  // namespace colmap_ext
