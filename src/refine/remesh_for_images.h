#pragma once

#include <vector>

#include <Eigen/Core>

#include "mesh/triangle_mesh.h"
#include "mesh/vertex_attributes.h"
#include "raster/facet_visibility.h"
#include "raster/mesh_drawings.h"
#include "refine/fixed_sources.h"

namespace colmap_ext {

// Remeshes a surface by what the images can show of it: its facets get about
// the given area in the images (RefinableAreas()). Where fewer than two views
// see the surface, they grow.
// \param area  px^2, of the drawn views.
// \param draw  draws the mesh into the views.
// \param attributes  [V] see CarryAttributes().
// \param origins  [V] see RefinedMesh; new vertices get those between their
//        facet's corners.
// \param fixed_sources  of the mesh
// \return which views see the facets of the new mesh.
FacetVisibility RemeshForImages(double area, const DrawMesh& draw,
                                TriangleMesh* mesh,
                                VertexAttributes* attributes,
                                std::vector<Eigen::Vector3f>* origins,
                                FixedSources* fixed_sources);

}  // namespace colmap_ext
