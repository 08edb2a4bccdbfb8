#pragma once

#include <cstdint>
#include <vector>

#include "mesh/facet_confidences.h"
#include "mesh/fan_split.h"
#include "meshing/manifold_meshing.h"
#include "meshing/surface_extraction.h"
#include "scene/point_cloud.h"
#include "scene/progress.h"
#include "scene/view.h"

namespace colmap_ext {

// What the vertices of a tetrahedralization stand for. Those beyond the arrays
// are centroids of split cells.
struct SurfacePoints {
  const PointCloud& cloud;                     // may have no positions
  const std::vector<uint32_t>& vertex_points;  // [V] the cloud's, or kNoPoint
  const std::vector<float>& supports;          // [V] SupportOfVertices()
  const std::vector<uint8_t>& is_end;          // [V] MarkEnds()
};

// Makes a surface manifold, drops what the options want dropped, and gives it
// the attributes and confidences of its points (docs/method.md, sections 3.3
// and 3.6).
// \param result  gets the mesh and what belongs to it, the report its counts
// \throw std::invalid_argument where nothing is left
void SplitSurface(const ManifoldMeshingOptions& options,
                  ExtractedSurface extracted, const SurfacePoints& points,
                  const std::vector<View>& views, ManifoldMesh* result);

// What the points of a surface, or a part of it, tell of it.
struct AttributedSurface {
  VertexAttributes attributes;          // [V] without confidences
  std::vector<FacetDensity> densities;  // [F]
};

// \param surface  its sources are what the points are of
AttributedSurface AddAttributes(const FanSplit& surface,
                                const SurfacePoints& points,
                                const std::vector<View>& views);

// The steps after that: borders, remeshing, self-intersections, the gate.
// \throw std::invalid_argument where the trimming leaves nothing
// \throw std::logic_error where the mesh is not manifold
void FinishSurface(const ManifoldMeshingOptions& options,
                   const Progress& progress, ManifoldMesh* result);

}  // namespace colmap_ext
