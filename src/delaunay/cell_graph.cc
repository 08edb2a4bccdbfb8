#include "delaunay/visibility_weights.h"

#include <algorithm>
#include <atomic>
#include <cmath>

#include <tbb/parallel_for.h>
#include <Eigen/Geometry>

namespace colmap_ext {

NeighborView NeighborsOf(const Tetrahedralization& tetrahedra) {
  return {&tetrahedra.cells.data()->neighbors,
          sizeof(Tetrahedralization::Cell)};
}

FlowCapacities ZeroCapacities(const Tetrahedralization& tetrahedra) {
  FlowCapacities graph;
  graph.reserve(WithSpareCells(tetrahedra.cells.size()));
  graph.resize(tetrahedra.cells.size());
  return graph;
}

uint32_t ToCapacity(double weight) {
  return static_cast<uint32_t>(
      std::min<double>(kWeightUnit * weight + 0.5, kMaxCapacity));
}

void AddCapacity(uint32_t capacity, uint32_t* sum) {
  std::atomic_ref<uint32_t> atomic(*sum);
  if (atomic.load(std::memory_order_relaxed) <= kMaxCapacity) {
    atomic.fetch_add(capacity, std::memory_order_relaxed);
  }
}

double CosFacetSphereAngle(const Tetrahedralization& tetrahedra,
                           uint32_t cell_index, int facet) {
  if (tetrahedra.IsInfinite(cell_index)) {
    return 1;
  }
  const auto& cell = tetrahedra.cells[cell_index];
  const std::array<uint32_t, 3> corners =
      FromLowest(tetrahedra, FacetVertices(cell, facet));
  const Eigen::Vector3d origin = tetrahedra.PositionOf(corners[0]);
  const Eigen::Vector3d a = tetrahedra.PositionOf(corners[1]) - origin;
  const Eigen::Vector3d b = tetrahedra.PositionOf(corners[2]) - origin;
  const Eigen::Vector3d c =
      tetrahedra.PositionOf(cell.vertices[facet]) - origin;
  const Eigen::Vector3d normal = a.cross(b);  // into the cell
  // The sphere's centre relative to the origin is this vector over twelve times
  // the volume, which is positive: the cosine needs its direction alone.
  const Eigen::Vector3d center = a.squaredNorm() * b.cross(c) +
                                 b.squaredNorm() * c.cross(a) +
                                 c.squaredNorm() * normal;
  const double length = center.norm() * normal.norm();
  return length > 0 ? std::clamp(normal.dot(center) / length, -1.0, 1.0) : 0;
}

void AddQualityWeights(const Tetrahedralization& tetrahedra, double weight,
                       FlowCapacities* graph) {
  const auto num_cells = static_cast<uint32_t>(tetrahedra.cells.size());
  std::vector<std::array<float, 4>> cosines(num_cells);
  tbb::parallel_for(uint32_t{0}, num_cells, [&](uint32_t cell) {
    for (int i = 0; i < 4; ++i) {
      cosines[cell][i] =
          static_cast<float>(CosFacetSphereAngle(tetrahedra, cell, i));
    }
  });
  tbb::parallel_for(uint32_t{0}, num_cells, [&](uint32_t cell) {
    for (int i = 0; i < 4; ++i) {
      const uint32_t other = tetrahedra.cells[cell].neighbors[i];
      const bool is_beyond_hull =
          tetrahedra.IsInfinite(cell) && tetrahedra.IsInfinite(other);
      const float cosine =
          is_beyond_hull
              ? -1
              : std::min(cosines[cell][i],
                         cosines[other][tetrahedra.FacetTo(other, cell)]);
      (*graph)[cell].arcs[i] += static_cast<uint32_t>(
          std::lround(kWeightUnit * weight * (1 - cosine)));
    }
  });
}

}  // namespace colmap_ext
