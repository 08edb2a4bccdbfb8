#pragma once

#include "refine/facetwise_refinement.h"
#include "scene/progress.h"

namespace colmap_ext {

// Gives thin facets, which steps along the normals leave, a better shape,
// unless that makes facets cross.
void ImproveFacets(RefinedMesh* state);

// Counts self-intersections in the report.
void CountSelfIntersections(const Progress& progress, RefinedMesh* state);

// Repairs self-intersections, and counts them in the report.
// \return whether the mesh is another one now
bool RemoveSelfIntersections(const Progress& progress, RefinedMesh* state);

// What follows the last level: the borders are trimmed and closed, what lies
// outside of the region is cut off, self-intersections are repaired. Of a mesh
// that was not refined (RefinementReport::is_skipped) only the second.
// \throw std::invalid_argument if the trimming or the region leaves nothing.
void FinishRefinement(const FacetwiseRefinementOptions& options,
                      const Progress& progress, RefinedMesh* refined);

}  // namespace colmap_ext
