#include "delaunay/tetrahedralization.h"

#include <algorithm>
#include <stdexcept>
#include <unordered_set>
#include <utility>

#include <CGAL/Delaunay_triangulation_3.h>
#include <CGAL/Delaunay_triangulation_cell_base_3.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Triangulation_cell_base_with_info_3.h>
#include <CGAL/Triangulation_vertex_base_with_info_3.h>

#include "delaunay/cell_order.h"
#include "delaunay/insertion_order.h"

namespace colmap_ext {
namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using VertexBase =
    CGAL::Triangulation_vertex_base_with_info_3<uint32_t, Kernel>;
using CellBase = CGAL::Triangulation_cell_base_with_info_3<uint32_t, Kernel>;
template <typename Concurrency>
using Delaunay = CGAL::Delaunay_triangulation_3<
    Kernel,
    CGAL::Triangulation_data_structure_3<VertexBase, CellBase, Concurrency>>;

Kernel::Point_3 ToCgal(const Eigen::Vector3f& p) {
  return {p.x(), p.y(), p.z()};
}

// Tells whether a point is near enough to all four vertices of its cell, in all
// of its views, to be left out.
class ThinningRule {
 public:
  ThinningRule(const PointCloud& cloud, const std::vector<View>& views,
               const ThinningOptions& options)
      : cloud_(cloud),
        views_(views),
        max_proj_dist_squared_(options.max_proj_dist * options.max_proj_dist),
        max_depth_dist_(options.max_depth_dist) {}

  template <typename CellHandle>
  bool IsRedundant(uint32_t point, const CellHandle& cell) const {
    for (const uint32_t index : cloud_.views[point]) {
      const View& view = views_[index];
      const Eigen::Vector3d local =
          view.CamFromWorld(cloud_.positions[point].cast<double>());
      for (int i = 0; i < 4; ++i) {
        if (!IsNear(view, local, cell->vertex(i)->info())) {
          return false;
        }
      }
    }
    return true;
  }

 private:
  bool IsNear(const View& view, const Eigen::Vector3d& local,
              uint32_t vertex_point) const {
    const Eigen::Vector3d other =
        view.CamFromWorld(cloud_.positions[vertex_point].cast<double>());
    if (local.z() <= 0 || other.z() <= 0 ||
        std::abs(local.z() / other.z() - 1) > max_depth_dist_) {
      return false;
    }
    return (view.ImageFromCam(local) - view.ImageFromCam(other))
               .squaredNorm() <= max_proj_dist_squared_;
  }

  const PointCloud& cloud_;
  const std::vector<View>& views_;
  double max_proj_dist_squared_;
  double max_depth_dist_;
};

// The point of that vertex of a cell which is nearest to a point.
template <typename CellHandle>
uint32_t NearestVertex(const CellHandle& cell, const PointCloud& cloud,
                       uint32_t point) {
  uint32_t nearest = cell->vertex(0)->info();
  for (int i = 1; i < 4; ++i) {
    const uint32_t other = cell->vertex(i)->info();
    const auto& position = cloud.positions[point];
    if ((cloud.positions[other] - position).squaredNorm() <
        (cloud.positions[nearest] - position).squaredNorm()) {
      nearest = other;
    }
  }
  return nearest;
}

constexpr char kStage[] = "Triangulating points";

// A vertex's info is its point.
using SerialDelaunay = Delaunay<CGAL::Sequential_tag>;

// Inserts the points one after the other, without the redundant ones.
// \param representatives of redundant points are set to the point of the
//        nearest vertex of the cell that they fall into
SerialDelaunay InsertThinned(const PointCloud& cloud,
                             const std::vector<View>& views,
                             const ThinningOptions& options,
                             const std::vector<uint32_t>& points,
                             std::vector<uint32_t>* representatives,
                             const Progress& progress) {
  const ThinningRule rule(cloud, views, options);
  const std::vector<uint32_t> order = InsertionOrder(points);
  SerialDelaunay delaunay;
  SerialDelaunay::Cell_handle hint;
  for (size_t i = 0; i < order.size(); ++i) {
    const Kernel::Point_3 position = ToCgal(cloud.positions[order[i]]);
    SerialDelaunay::Locate_type type = SerialDelaunay::OUTSIDE_AFFINE_HULL;
    int li = 0;
    int lj = 0;
    const auto cell = delaunay.locate(position, type, li, lj, hint);
    const bool inside =
        delaunay.dimension() == 3 && !delaunay.is_infinite(cell);
    if (inside && rule.IsRedundant(order[i], cell)) {
      (*representatives)[order[i]] = NearestVertex(cell, cloud, order[i]);
      hint = cell;
      continue;
    }
    const auto vertex = delaunay.insert(position, type, cell, li, lj);
    vertex->info() = order[i];
    hint = vertex->cell();
    if (i % 65536 == 0) {
      Report(progress, kStage,
             static_cast<double>(i) / static_cast<double>(order.size()));
    }
  }
  return delaunay;
}

using ParallelDelaunay = Delaunay<CGAL::Parallel_tag>;

ParallelDelaunay InsertAll(const PointCloud& cloud,
                           const std::vector<uint32_t>& points) {
  Eigen::Vector3f lower = cloud.positions[points.front()];
  Eigen::Vector3f upper = lower;
  std::vector<std::pair<Kernel::Point_3, uint32_t>> input;
  input.reserve(points.size());
  for (const uint32_t point : points) {
    lower = lower.cwiseMin(cloud.positions[point]);
    upper = upper.cwiseMax(cloud.positions[point]);
    input.emplace_back(ToCgal(cloud.positions[point]), point);
  }
  constexpr int kLockGridSize = 50;  // cells an axis, CGAL's default
  ParallelDelaunay::Lock_data_structure locks(
      CGAL::Bbox_3(lower.x(), lower.y(), lower.z(), upper.x(), upper.y(),
                   upper.z()),
      kLockGridSize);
  ParallelDelaunay delaunay(input.begin(), input.end(), &locks);
  delaunay.set_lock_data_structure(nullptr);
  return delaunay;
}

// Numbers the vertices along the curve.
// \param points along the curve, a superset of the vertices' points
// \param result gets points, vertex_points, and point_vertices of those points
//        that have a vertex of their own; kInfiniteVertex for the others
template <typename Delaunay>
void NumberVertices(const Delaunay& delaunay, const PointCloud& cloud,
                    const std::vector<uint32_t>& points,
                    ThinnedTetrahedralization* result) {
  std::vector<uint32_t>& point_vertices = result->point_vertices;
  std::vector<Eigen::Vector3f>& positions = result->tetrahedra.points;
  point_vertices.assign(cloud.size(), kInfiniteVertex);
  for (const auto vertex : delaunay.finite_vertex_handles()) {
    point_vertices[vertex->info()] = 0;
  }
  for (const uint32_t point : points) {
    if (point_vertices[point] == 0) {
      point_vertices[point] = static_cast<uint32_t>(positions.size());
      positions.push_back(cloud.positions[point]);
      result->vertex_points.push_back(point);
    }
  }
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

// \throw std::invalid_argument where 32-bit arcs, 4 * cell + facet, would not
//        do
template <typename Delaunay>
std::vector<Tetrahedralization::Cell> CopyCells(
    const Delaunay& delaunay, const std::vector<uint32_t>& point_vertices) {
  const size_t num_cells = delaunay.tds().number_of_cells();
  if (num_cells >= UINT32_MAX / 4) {
    throw std::invalid_argument(
        "too many points for 32-bit indices: raise max_proj_dist");
  }
  uint32_t index = 0;
  for (const auto cell : delaunay.all_cell_handles()) {
    cell->info() = index++;
  }
  std::vector<Tetrahedralization::Cell> cells(num_cells);
  for (const auto cell : delaunay.all_cell_handles()) {
    Tetrahedralization::Cell& copy = cells[cell->info()];
    for (int i = 0; i < 4; ++i) {
      copy.vertices[i] = delaunay.is_infinite(cell->vertex(i))
                             ? kInfiniteVertex
                             : point_vertices[cell->vertex(i)->info()];
      copy.neighbors[i] = cell->neighbor(i)->info();
    }
    SortCorners(&copy);
  }
  return cells;
}

// The first finite cell of each vertex.
std::vector<uint32_t> FirstCells(const Tetrahedralization& tetrahedra) {
  std::vector<uint32_t> first(tetrahedra.points.size(), kNoCell);
  for (uint32_t cell = 0; cell < tetrahedra.cells.size(); ++cell) {
    if (tetrahedra.IsInfinite(cell)) {
      continue;
    }
    for (const uint32_t vertex : tetrahedra.cells[cell].vertices) {
      first[vertex] = std::min(first[vertex], cell);
    }
  }
  return first;
}

// Copies CGAL's structure into flat arrays, and empties it.
// \param points          along the curve, a superset of the vertices' points
// \param representatives [P] another point for each one without a vertex
// \throw std::invalid_argument
template <typename Delaunay>
void Flatten(const PointCloud& cloud, const std::vector<uint32_t>& points,
             const std::vector<uint32_t>& representatives, Delaunay* delaunay,
             ThinnedTetrahedralization* result) {
  if (delaunay->dimension() != 3) {
    throw std::invalid_argument(
        "the points lie in a plane: there is no volume to mesh");
  }
  NumberVertices(*delaunay, cloud, points, result);
  FollowRepresentatives(representatives, &result->point_vertices);
  Tetrahedralization& tetrahedra = result->tetrahedra;
  tetrahedra.cells = CopyCells(*delaunay, result->point_vertices);
  delaunay->clear();  // before SortCells needs memory
  SortCells(&tetrahedra.cells);
  tetrahedra.vertex_cells = FirstCells(tetrahedra);
}

}  // namespace

void IncidentCells(const Tetrahedralization& tetrahedra, uint32_t vertex,
                   std::vector<uint32_t>* cells) {
  // A vertex has some 25 cells, but an outlier can have thousands. Up to this
  // many (256 bytes) a linear search is faster than a hash table.
  constexpr size_t kMaxLinearSearch = 64;
  std::unordered_set<uint32_t> seen;
  const auto is_new = [&](uint32_t cell) {
    if (cells->size() <= kMaxLinearSearch) {
      return std::find(cells->begin(), cells->end(), cell) == cells->end();
    }
    if (seen.empty()) {
      seen.insert(cells->begin(), cells->end());
    }
    return seen.insert(cell).second;
  };
  cells->assign(1, tetrahedra.vertex_cells[vertex]);
  for (size_t i = 0; i < cells->size(); ++i) {
    const Tetrahedralization::Cell& cell = tetrahedra.cells[(*cells)[i]];
    for (int k = 0; k < 4; ++k) {
      if (cell.vertices[k] != vertex && is_new(cell.neighbors[k])) {
        cells->push_back(cell.neighbors[k]);
      }
    }
  }
}

ThinnedTetrahedralization Tetrahedralize(const PointCloud& cloud,
                                         const std::vector<View>& views,
                                         const ThinningOptions& options,
                                         const Progress& progress) {
  Report(progress, kStage, 0);
  ThinnedTetrahedralization result;
  std::vector<uint32_t> representatives;
  const std::vector<uint32_t> points =
      DistinctPoints(cloud.positions, &representatives);
  result.num_duplicate_points = cloud.size() - points.size();
  if (points.size() < 4) {
    throw std::invalid_argument("fewer than four points: nothing to mesh");
  }
  if (options.max_proj_dist > 0) {
    auto delaunay = InsertThinned(cloud, views, options, points,
                                  &representatives, progress);
    Flatten(cloud, points, representatives, &delaunay, &result);
  } else {
    auto delaunay = InsertAll(cloud, points);
    Flatten(cloud, points, representatives, &delaunay, &result);
  }
  return result;
}

}  // namespace colmap_ext
