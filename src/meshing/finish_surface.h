#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "mesh/surface.h"
#include "mesh/triangle_mesh.h"
#include "meshing/manifold_meshing.h"
#include "scene/point_cloud.h"
#include "scene/progress.h"
#include "scene/view.h"

namespace colmap_ext {

// The support of each vertex of a tetrahedralization, the summed weights of the
// points that it stands for: [num_vertices].
// \param point_vertices [P] the vertex of each point, < num_vertices
// \param point_weights [P] not negative
std::vector<float> SupportOfVertices(
    size_t num_vertices, const std::vector<uint32_t>& point_vertices,
    const std::vector<float>& point_weights);

// What the vertices of a surface have: [V] the mean of two values of vertices
// of the tetrahedralization.
// \param sources [V] two of these vertices each, see Provenance
// \param missing  the value of those from values.size() on
std::vector<float> MeansOfSources(
    const std::vector<float>& values,
    const std::vector<std::array<uint32_t, 2>>& sources, float missing);

// The colours and views of vertices: those of their own points.
// \param vertex_points [V] the cloud's
VertexAttributes AttributesOfPoints(const PointCloud& cloud,
                                    const std::vector<uint32_t>& vertex_points);

// What the vertices of a tetrahedralization stand for. Those beyond the arrays
// are centroids of split cells.
struct SurfacePoints {
  VertexAttributes attributes;  // [V] AttributesOfPoints()
  std::vector<float> supports;  // [V] SupportOfVertices()
  std::vector<float> noises;    // [V] LocalNoise(); empty: not smoothed
  std::vector<uint8_t> is_end;  // [V] MarkEnds()
};

// Makes a surface manifold, drops the facets that the options exclude, smooths
// it, and adds the attributes and confidences of its points (docs/method.md,
// sections 3.3, 3.6 and 3.7). Then trims it, closes its holes, remeshes it,
// repairs self-intersections, and checks that it is manifold.
// \param result  gets the mesh and what belongs to it, the report its counts
// \throw std::invalid_argument if no facet is left
// \throw std::logic_error where the mesh is not manifold
void FinishSurface(const ManifoldMeshingOptions& options,
                   ExtractedSurface extracted, SurfacePoints points,
                   const std::vector<View>& views, const Progress& progress,
                   ManifoldMesh* result);

// Colours and views of a mesh's vertices from those that they come from: the
// mean colour of two, and the views of either. A vertex that comes from none
// inherits them from its neighbors: their mean colour, and the views that at
// least half of them have. Neighbors that have none yet do not count; vertices
// far from all others inherit in later rounds. Without colours there are none.
// \param sources [V] two rows of the attributes for each vertex, which may be
//        the same, or what is beyond them
VertexAttributes InheritAttributes(const TriangleMesh& mesh,
                                   std::vector<std::array<uint32_t, 2>> sources,
                                   VertexAttributes attributes);

}  // namespace colmap_ext
