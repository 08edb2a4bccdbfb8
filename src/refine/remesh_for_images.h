#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include <Eigen/Core>

#include "base/rows.h"
#include "mesh/triangle_mesh.h"
#include "mesh/vertex_attributes.h"
#include "raster/facet_visibility.h"
#include "raster/visibility_buffers.h"
#include "refine/fixed_sources.h"
#include "scene/view.h"

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

// About how many facets a mesh has once it is remeshed, if it is curved
// everywhere: its area by that of a facet, at the median footprint of a pixel;
// not fewer than it has. For estimates of memory.
// \param area  px^2
// \param vertex_views [V] see VertexAttributes
size_t ExpectedFacets(double area, const TriangleMesh& mesh,
                      const Rows<uint32_t>& vertex_views,
                      const std::vector<View>& views);

}  // namespace colmap_ext
