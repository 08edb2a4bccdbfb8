#pragma once

#include <cstdint>
#include <vector>

#include "base/rows.h"
#include "mesh/surface.h"
#include "raster/visibility_buffers.h"
#include "scene/view.h"

namespace colmap_ext {

// Returns [F] the area that each facet covers in the images, px^2: the second
// largest over the views that see it, as two views are needed to refine it; 0
// where fewer than two do.
std::vector<float> RefinableAreas(const TriangleMesh& mesh,
                                  const std::vector<View>& views,
                                  const FacetVisibility& visibility);

// Subdivides facets that are larger in an image than `max_area`, until none is,
// or 8 times. What counts is the second largest of the areas in the views that
// see a facet, as two views are needed to refine it; facets that fewer than two
// views see are left as they are.
// \param max_area  px^2, of the drawn views.
// \param draw  draws the mesh into the views; called for the first mesh and, if
//        it is subdivided, for the last.
// \param surface  Edges between fixed vertices are not cut, and facets there
//        are left as they are.
// \return which views see the facets of the mesh that is left.
FacetVisibility SubdivideLargeFacets(double max_area, const DrawMesh& draw,
                                     Surface* surface);

// Remeshes a surface by what the images can show of it: its facets get about
// the given area in the images (RefinableAreas()). Where fewer than two views
// see the surface, they grow.
// \param area  px^2, of the drawn views.
// \param draw  draws the mesh into the views.
// \return which views see the facets of the new mesh.
FacetVisibility RemeshForImages(double area, const DrawMesh& draw,
                                Surface* surface);

// Returns [F] about how many facets will stand in the place of each once the
// mesh is remeshed: less than one where they grow.
// \param area  px^2
// \param vertex_views [V] see VertexAttributes
std::vector<float> ExpectedParts(double area, const TriangleMesh& mesh,
                                 const Rows<uint32_t>& vertex_views,
                                 const std::vector<View>& views);

}  // namespace colmap_ext
