#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include <Eigen/Core>

#include "mesh/triangle_mesh.h"
#include "spatial/facet_tree.h"

namespace colmap_ext {

// Two facets, the lower index first.
using FacetPair = std::array<uint32_t, 2>;

// Whether a pair intersects, see FindSelfIntersections().
bool DoesPairIntersect(const TriangleMesh& mesh, const FacetPair& pair);

// Returns the pairs of facets that intersect, ascending: each facet whose
// corners lie on one line, paired with itself, and two facets with area that
// meet in more than what they share by index:
// - without a common vertex: they have a point in common, if only a touching
//   one;
// - with one: the side opposite of it, of one, has a point in common with the
//   other;
// - with two: they lie in one plane, folded onto each other;
// - with three: always.
// All signs are exact (spatial/predicates.h). This is what CGAL's
// Polygon_mesh_processing::self_intersections() counts.
//
// Takes little memory beside the mesh: only a few parts of it have a tree at a
// time.
// \param max_part_facets  of a part. The default is a choice.
// \pre facet indices are in range, no facet repeats a vertex, vertices are
//      finite
std::vector<FacetPair> FindSelfIntersections(const TriangleMesh& mesh,
                                             size_t max_part_facets = 1 << 16);

// The same with an existing tree.
// \pre the tree is of this mesh's facets and encloses its positions
std::vector<FacetPair> FindSelfIntersections(const TriangleMesh& mesh,
                                             const FacetTree& tree);

// Returns those of the pairs that have one of the chosen facets at least. Takes
// time in proportion to their number.
// \param facets  indices, each once
// \pre the tree is of this mesh's facets and encloses its positions
std::vector<FacetPair> FindSelfIntersections(
    const TriangleMesh& mesh, const FacetTree& tree,
    const std::vector<uint32_t>& facets);

// Puts the corners of facets that intersect back to where they were. Facets may
// intersect others then: to be repeated until no corner moves.
// \param positions [V]
// \return how many vertices moved
size_t PutBackIntersecting(const std::vector<Eigen::Vector3f>& positions,
                           TriangleMesh* mesh);

}  // namespace colmap_ext
