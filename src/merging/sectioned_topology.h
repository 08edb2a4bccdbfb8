#pragma once

#include "merging/sectioned_mesh.h"
#include "mesh/topology.h"

namespace colmap_ext {

// Analyze() of a mesh of which one section is held at a time, and the facets at
// vertices that several sections share. Components of a mesh that is not
// manifold are those that vertices connect.
MeshReport AnalyzeSections(const SectionedMesh& mesh);

}  // namespace colmap_ext
