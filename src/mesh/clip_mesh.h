#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <vector>

#include "base/union_find.h"
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

// Joins facets that share an edge, where joins(facet, other).
// \param partners [3 F] see PairHalfEdges()
UnionFind JoinFacets(const std::vector<uint32_t>& partners,
                     const std::function<bool(uint32_t, uint32_t)>& joins);

// Keeps the regions of dropped facets that kept ones enclose.
// \param sizes [F] a region is kept if they add up to max_size at most
// \param is_dropped [F] 1 or 0
void KeepEnclosed(const std::vector<uint32_t>& partners,
                  const std::vector<double>& sizes, double max_size,
                  std::vector<uint8_t>* is_dropped);

// Keeps the regions of dropped facets that continue the surface around them: a
// region ends at creases, is flat, coplanar with the kept facets along most of
// its rim, and its rim is longer than min_rim times its other outer edges. A
// membrane across the sky or an opening bends at its rim (docs/method.md, 3.8).
// \param partners [3 F] see PairHalfEdges()
// \param is_dropped [F] 1 or 0
void KeepContinuations(const TriangleMesh& mesh,
                       const std::vector<uint32_t>& partners, double min_rim,
                       std::vector<uint8_t>* is_dropped);

// Drops the facets with a side longer than `factor` times the given percentile
// (0 ... 100) of the facets' longest sides, unless they continue the surface
// around them or are enclosed; none where the factor is 0.
// \return how many
// \pre facet indices are in range
size_t DropLongFacets(double factor, double percentile, TriangleMesh* mesh);

// Drops the components, connected by edges of two facets, of less than
// min_facets facets.
// \return how many components
size_t DropSmallComponents(size_t min_facets, std::vector<Facet>* facets);

}  // namespace colmap_ext
