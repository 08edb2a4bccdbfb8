#pragma once

#include <vector>

#include <Eigen/Core>

#include "mesh/triangle_mesh.h"
#include "mesh/vertex_attributes.h"
#include "raster/facet_visibility.h"
#include "raster/visibility_buffers.h"
#include "refine/fixed_sources.h"

namespace colmap_ext {

// Subdivides facets that are larger in an image than `max_area`, until none is,
// or 8 times. What counts is the second largest of the areas in the views that
// see a facet, as two views are needed to refine it; facets that fewer than two
// views see are left as they are.
// \param max_area  px^2, of the drawn views.
// \param draw  draws the mesh into the views; called again for each new mesh.
// \param attributes  [V] a new vertex gets those between its edge's ends.
// \param origins  [V] see RefinedMesh; a new vertex gets the mean.
// \param fixed_sources  of the mesh; edges between vertices that stay are not
//        cut, and facets there are left as they are
// \return which views see the facets of the mesh that is left.
FacetVisibility SubdivideLargeFacets(double max_area, const DrawMesh& draw,
                                     TriangleMesh* mesh,
                                     VertexAttributes* attributes,
                                     std::vector<Eigen::Vector3f>* origins,
                                     FixedSources* fixed_sources);

}  // namespace colmap_ext
