#pragma once

#include <cstddef>
#include <vector>

#include <Eigen/Core>

#include "mesh/triangle_mesh.h"
#include "mesh/vertex_attributes.h"
#include "scene/view.h"

namespace colmap_ext {

// Subdivides facets that are larger in an image than `max_area`, px^2, until
// none is, or 8 times. What counts is the second largest of the areas in the
// views that see a facet, for two are needed to refine it; facets that fewer
// than two views see are left as they are.
// \param views  of the images' sizes.
// \param origins  [V] see RefinedMesh; a new vertex gets the mean.
void SubdivideLargeFacets(double max_area, double min_cosine,
                          const std::vector<View>& views, TriangleMesh* mesh,
                          VertexAttributes* attributes,
                          std::vector<Eigen::Vector3f>* origins);

}  // namespace colmap_ext
