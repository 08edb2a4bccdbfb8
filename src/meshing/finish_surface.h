#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "base/indices.h"
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

// What the vertices of a tetrahedralization stand for. Those beyond the arrays
// are centroids of split cells.
struct SurfacePoints {
  PointCloud cloud;                     // may have no positions
  std::vector<uint32_t> vertex_points;  // [V] the cloud's, or kNone
  std::vector<float> supports;          // [V] SupportOfVertices()
  std::vector<float> noises;            // [V] LocalNoise(); empty: not smoothed
  std::vector<uint8_t> is_end;          // [V] MarkEnds()
};

// Makes a surface manifold, drops the facets that the options exclude, smooths
// it, and adds the attributes and confidences of its points (docs/method.md,
// sections 3.3, 3.6 and 3.7).
// \param result  gets the mesh and what belongs to it, the report its counts
// \throw std::invalid_argument if no facet is left
void MakeSurfaceManifold(const ManifoldMeshingOptions& options,
                         ExtractedSurface extracted, SurfacePoints points,
                         const std::vector<View>& views, ManifoldMesh* result);

// The steps after that: borders, remeshing, self-intersections, the gate.
// \throw std::invalid_argument if the trimming leaves no facet
// \throw std::logic_error where the mesh is not manifold
void FinishSurface(const ManifoldMeshingOptions& options,
                   const std::vector<View>& views, const Progress& progress,
                   ManifoldMesh* result);

// Colours and views of a mesh's vertices from the fused points that they come
// from: the mean colour of two points, and the views of either. A vertex that
// comes from none inherits them from its neighbors: their mean colour, and the
// views that at least half of them have. Neighbors that have none yet do not
// count; vertices far from all points inherit in later rounds. Without colours
// in the cloud there are none.
// \param points [V] two points of each vertex, which may be the same, or
//        kNone; the cloud's indices
VertexAttributes InheritAttributes(
    const TriangleMesh& mesh, const PointCloud& cloud,
    const std::vector<std::array<uint32_t, 2>>& points);

}  // namespace colmap_ext
