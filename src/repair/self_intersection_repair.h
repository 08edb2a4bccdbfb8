#pragma once

#include <cstddef>

#include "mesh/surface.h"
#include "mesh/triangle_mesh.h"
#include "spatial/self_intersections.h"

namespace colmap_ext {

struct SelfIntersectionRepair {
  size_t num_before = 0;  // pairs of facets, FindSelfIntersections()
  size_t num_after = 0;   // at most as many

  bool operator==(const SelfIntersectionRepair&) const = default;
};

// Removes self-intersections where local changes do.
//
// In a few rounds, the vertices of each cluster of facets that intersect, and
// as many rings around them as there were rounds, are pushed along their
// normals, inwards or outwards, or smoothed, a little or much, whichever is
// allowed first: copies of a vertex by so little that no picture shows it. A
// change is allowed only if it removes pairs, makes no new ones and turns no
// facet over (GuardedMesh). So the pairs that remain are pairs of before.
//
// What may change, and what it may meet then, is copied as a patch, which alone
// gets adjacency: that takes little memory beside the mesh. The patch is what
// lies around all pairs at first, then, more rings wide, around those left.
//
// The mesh remains manifold, with the same number of vertices and facets and
// the same borders. A mesh without self-intersections is not changed. The
// result does not depend on the number of threads.
//
// \param fixed  of the mesh; pairs of two fixed facets do not count
// \pre the mesh is manifold
SelfIntersectionRepair RepairSelfIntersections(TriangleMesh* mesh,
                                               const FixedVertices& fixed = {});

// Smooths and pushes folded edges flat in the same way, without new
// self-intersections. Folded is an edge whose facets' normals are more than 120
// degrees apart.
// \pre the mesh is manifold
void Unfold(TriangleMesh* mesh, const FixedVertices& fixed = {});

// Replaces facets that still intersect, and all at their vertices: drops them
// and closes the holes that this opens. Where a filling would intersect or not
// be manifold, a ring or two more is replaced; where that does not help either,
// a hole stays. Facets at fixed vertices, and all if there are many pairs, stay
// as they are.
// \param num_pairs  that intersect; then those that are left
// \return what the surface comes from, see TrimAndCloseHoles()
// \pre the mesh is manifold
Provenance FinishRepair(size_t* num_pairs, Surface* surface);

// Marks all facets at the vertices within some rings of edges around pairs of
// facets. Goes through all of the mesh once a ring, and needs no adjacency.
// \return [F] 1: it is one of these
std::vector<uint8_t> MarkAround(const TriangleMesh& mesh,
                                const std::vector<FacetPair>& pairs,
                                int num_rings);

}  // namespace colmap_ext
