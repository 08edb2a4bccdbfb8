#include "delaunay/tetrahedralization.h"

#include <algorithm>
#include <stdexcept>
#include <utility>

#include <tbb/parallel_for.h>

#include "delaunay/cell_order.h"
#include "delaunay/cell_places.h"
#include "delaunay/growing_complex.h"
#include "delaunay/insert_points.h"
#include "delaunay/insertion_order.h"
#include "delaunay/take_tetrahedra.h"
#include "delaunay/thinning.h"

namespace colmap_ext {
namespace {

// Keeps the vertices, in their order along the curve.
// \param points  [complex points] of the cloud, along the curve
// \param result  gets points, vertex_points, and point_vertices of those points
//        that have a vertex of their own; kInfiniteVertex for the others
void NumberVertices(const std::vector<uint32_t>& points, size_t num_points,
                    GrowingComplex* complex,
                    ThinnedTetrahedralization* result) {
  std::vector<Eigen::Vector3f>& positions = complex->points;
  result->point_vertices.assign(num_points, kInfiniteVertex);
  for (size_t i = 0; i < points.size(); ++i) {
    if (complex->vertex_cells[i] != kNone) {
      const size_t vertex = result->vertex_points.size();
      result->point_vertices[points[i]] = static_cast<uint32_t>(vertex);
      result->vertex_points.push_back(points[i]);
      positions[vertex] = positions[i];
    }
  }
  positions.resize(result->vertex_points.size());
  positions.shrink_to_fit();
  result->tetrahedra.points = std::move(positions);
}

// Gives points without a vertex that of their representative, or of its own.
void FollowRepresentatives(const std::vector<uint32_t>& representatives,
                           std::vector<uint32_t>* point_vertices) {
  for (uint32_t point = 0; point < point_vertices->size(); ++point) {
    uint32_t representative = point;
    while ((*point_vertices)[representative] == kInfiniteVertex) {
      representative = representatives[representative];
    }
    (*point_vertices)[point] = (*point_vertices)[representative];
  }
}

// Replaces points along the curve by their vertices.
void RenumberVertices(const std::vector<uint32_t>& points,
                      const std::vector<uint32_t>& point_vertices,
                      std::vector<Tetrahedralization::Cell>* cells) {
  tbb::parallel_for(size_t{0}, cells->size(), [&](size_t i) {
    for (uint32_t& vertex : (*cells)[i].vertices) {
      if (vertex != kInfiniteVertex) {
        vertex = point_vertices[points[vertex]];
      }
    }
  });
}

// \param points          [complex points] of the cloud, along the curve
// \param representatives [P] another point for each one without a vertex
ThinnedTetrahedralization Flatten(const std::vector<uint32_t>& points,
                                  const std::vector<uint32_t>& representatives,
                                  GrowingComplex* complex) {
  ThinnedTetrahedralization result;
  Tetrahedralization& tetrahedra = result.tetrahedra;
  tetrahedra.cells = TakeSortedCells(complex);
  NumberVertices(points, representatives.size(), complex, &result);
  FollowRepresentatives(representatives, &result.point_vertices);
  if (result.vertex_points.size() < points.size()) {
    RenumberVertices(points, result.point_vertices, &tetrahedra.cells);
  }
  tetrahedra.vertex_cells = FirstCells(tetrahedra);
  return result;
}

}  // namespace

void IncidentCells(const Tetrahedralization& tetrahedra, uint32_t vertex,
                   std::vector<uint32_t>* cells) {
  thread_local CellPlaces places;
  places.Clear();
  cells->clear();
  places.PlaceIn(tetrahedra.vertex_cells[vertex], cells);
  for (size_t i = 0; i < cells->size(); ++i) {
    const Tetrahedralization::Cell& cell = tetrahedra.cells[(*cells)[i]];
    for (int k = 0; k < 4; ++k) {
      if (cell.vertices[k] != vertex) {
        places.PlaceIn(cell.neighbors[k], cells);
      }
    }
  }
}

ThinnedTetrahedralization Tetrahedralize(const PointCloud& cloud,
                                         const std::vector<View>& views,
                                         const ThinningOptions& options,
                                         const Progress& progress) {
  Report(progress, kTriangulatingStage, 0);
  std::vector<uint32_t> representatives;
  const std::vector<uint32_t> points =
      DistinctPoints(cloud.positions, &representatives);
  if (points.size() < 4) {
    throw std::invalid_argument("fewer than four points: nothing to mesh");
  }
  GrowingComplex complex;
  complex.points.reserve(points.size());
  for (const uint32_t point : points) {
    complex.points.push_back(cloud.positions[point]);
  }
  const std::vector<uint32_t> order = InsertionOrder(points.size());
  if (options.max_proj_dist > 0) {
    InsertThinned(cloud, views, options, points, order, &representatives,
                  progress, &complex);
  } else {
    InsertPoints(order, progress, &complex);
  }
  ThinnedTetrahedralization result = Flatten(points, representatives, &complex);
  result.num_duplicate_points = cloud.size() - points.size();
  return result;
}

}  // namespace colmap_ext
