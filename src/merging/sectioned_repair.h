#pragma once

#include "merging/sectioned_mesh.h"
#include "repair/self_intersection_repair.h"

namespace colmap_ext {

// RepairSelfIntersections() of a mesh of which one section is held at a time:
// the result is the same. Pairs are found section by section. What may move is
// held at once: the rings around all pairs, few at first, more around the pairs
// that are left then, and what comes near to them.
// \pre the mesh is manifold
SelfIntersectionRepair RepairSections(SectionedMesh* mesh);

// FindSelfIntersections(), section by section.
std::vector<FacetPair> FindSelfIntersections(const SectionedMesh& mesh);

}  // namespace colmap_ext
