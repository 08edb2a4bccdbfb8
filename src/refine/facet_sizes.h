#pragma once

#include <cstddef>
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

// About how many facets a mesh has once it is remeshed, if it is curved
// everywhere: its area by that of a facet, at the median footprint of a pixel;
// not fewer than it has. For estimates of memory.
// \param area  px^2
// \param vertex_views [V] see VertexAttributes
size_t ExpectedFacets(double area, const TriangleMesh& mesh,
                      const Rows<uint32_t>& vertex_views,
                      const std::vector<View>& views);

}  // namespace colmap_ext
