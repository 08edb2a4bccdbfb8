#include "delaunay/tetrahedralization.h"

#include <algorithm>
#include <bit>
#include <numeric>
#include <stdexcept>
#include <unordered_set>
#include <utility>

#include <CGAL/Delaunay_triangulation_3.h>
#include <CGAL/Delaunay_triangulation_cell_base_3.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Triangulation_cell_base_with_info_3.h>
#include <CGAL/Triangulation_vertex_base_with_info_3.h>
#include <tbb/parallel_sort.h>

#include "delaunay/space_filling_curve.h"

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

// The points without repeats, along the curve. Of points at one position the
// first is kept.
// \param stand_ins [P] is set to that one for the others, and to itself
std::vector<uint32_t> DistinctPoints(
    const std::vector<Eigen::Vector3f>& positions,
    std::vector<uint32_t>* stand_ins) {
  const std::vector<uint64_t> keys = MortonKeys(positions);
  std::vector<uint32_t> points(positions.size());
  std::iota(points.begin(), points.end(), 0);
  tbb::parallel_sort(points.begin(), points.end(), [&](uint32_t a, uint32_t b) {
    if (keys[a] != keys[b]) return keys[a] < keys[b];
    const auto& p = positions[a];
    const auto& q = positions[b];
    if (p.x() != q.x()) return p.x() < q.x();
    if (p.y() != q.y()) return p.y() < q.y();
    if (p.z() != q.z()) return p.z() < q.z();
    return a < b;
  });
  stand_ins->resize(positions.size());
  size_t size = 0;
  for (const uint32_t point : points) {
    if (size == 0 || positions[points[size - 1]] != positions[point]) {
      points[size++] = point;
    }
    (*stand_ins)[point] = points[size - 1];
  }
  points.resize(size);
  return points;
}

// A biased randomized insertion order: rounds of doubling size, each along the
// curve.
// \param points along the curve
std::vector<uint32_t> InsertionOrder(const std::vector<uint32_t>& points) {
  std::vector<uint8_t> rounds(points.size());
  for (size_t i = 0; i < points.size(); ++i) {
    uint64_t hash = (i + 1) * 0x9e3779b97f4a7c15ULL;  // splitmix64
    hash = (hash ^ (hash >> 30)) * 0xbf58476d1ce4e5b9ULL;
    hash = (hash ^ (hash >> 27)) * 0x94d049bb133111ebULL;
    hash ^= hash >> 31;
    rounds[i] = static_cast<uint8_t>(std::countl_zero(hash | 1));
  }
  std::vector<uint32_t> order;
  order.reserve(points.size());
  for (int round = 63; round >= 0; --round) {
    for (size_t i = 0; i < points.size(); ++i) {
      if (rounds[i] == round) {
        order.push_back(points[i]);
      }
    }
  }
  return order;
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

// \param stand_ins of points that are left out is set to the point of a vertex
// of
//        the cell that they fall into
SerialDelaunay InsertThinned(const PointCloud& cloud,
                             const std::vector<View>& views,
                             const ThinningOptions& options,
                             const std::vector<uint32_t>& points,
                             std::vector<uint32_t>* stand_ins,
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
      (*stand_ins)[order[i]] = NearestVertex(cell, cloud, order[i]);
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

// Sorts a cell's corners, facets along with them, so that the first vertices
// are the lowest and the orientation stays.
void Canonicalize(Tetrahedralization::Cell* cell) {
  bool odd = false;
  for (int i = 1; i < 4; ++i) {
    for (int j = i; j > 0 && cell->vertices[j] < cell->vertices[j - 1]; --j) {
      std::swap(cell->vertices[j], cell->vertices[j - 1]);
      std::swap(cell->neighbors[j], cell->neighbors[j - 1]);
      odd = !odd;
    }
  }
  if (odd) {
    std::swap(cell->vertices[2], cell->vertices[3]);
    std::swap(cell->neighbors[2], cell->neighbors[3]);
  }
}

// Puts the cells into an order that depends on their vertices alone.
void SortCells(std::vector<Tetrahedralization::Cell>* cells) {
  std::vector<uint32_t> order(cells->size());
  std::iota(order.begin(), order.end(), 0);
  tbb::parallel_sort(order.begin(), order.end(), [&](uint32_t a, uint32_t b) {
    return (*cells)[a].vertices < (*cells)[b].vertices;
  });
  std::vector<uint32_t> rank(cells->size());
  for (uint32_t i = 0; i < order.size(); ++i) {
    rank[order[i]] = i;
  }
  std::vector<Tetrahedralization::Cell> sorted(cells->size());
  for (size_t i = 0; i < order.size(); ++i) {
    sorted[i] = (*cells)[order[i]];
    for (uint32_t& neighbor : sorted[i].neighbors) {
      neighbor = rank[neighbor];
    }
  }
  cells->swap(sorted);
}

// Copies CGAL's structure into flat arrays.
// \param points along the curve, a superset of the vertices' points
template <typename Delaunay>
void Flatten(Delaunay* delaunay, const PointCloud& cloud,
             const std::vector<uint32_t>& points,
             const std::vector<uint32_t>& stand_ins,
             ThinnedTetrahedralization* result) {
  if (delaunay->dimension() != 3) {
    throw std::invalid_argument(
        "the points lie in a plane: there is no volume to mesh");
  }
  Tetrahedralization& tetrahedra = result->tetrahedra;
  std::vector<uint32_t>& point_vertices = result->point_vertices;
  point_vertices.assign(cloud.size(), kInfiniteVertex);
  for (const auto vertex : delaunay->finite_vertex_handles()) {
    point_vertices[vertex->info()] = 0;
  }
  for (const uint32_t point : points) {
    if (point_vertices[point] == 0) {
      point_vertices[point] = static_cast<uint32_t>(tetrahedra.points.size());
      tetrahedra.points.push_back(cloud.positions[point]);
      result->vertex_points.push_back(point);
    }
  }
  for (uint32_t point = 0; point < cloud.size(); ++point) {
    uint32_t vertex_point = point;
    while (point_vertices[vertex_point] == kInfiniteVertex) {
      vertex_point = stand_ins[vertex_point];
    }
    point_vertices[point] = point_vertices[vertex_point];
  }
  const size_t num_cells = delaunay->tds().number_of_cells();
  if (num_cells >= UINT32_MAX / 4) {
    throw std::invalid_argument(
        "too many points for 32-bit indices: raise max_proj_dist");
  }
  uint32_t index = 0;
  for (const auto cell : delaunay->all_cell_handles()) {
    cell->info() = index++;
  }
  tetrahedra.cells.resize(num_cells);
  for (const auto cell : delaunay->all_cell_handles()) {
    Tetrahedralization::Cell& flat = tetrahedra.cells[cell->info()];
    for (int i = 0; i < 4; ++i) {
      flat.vertices[i] = delaunay->is_infinite(cell->vertex(i))
                             ? kInfiniteVertex
                             : point_vertices[cell->vertex(i)->info()];
      flat.neighbors[i] = cell->neighbor(i)->info();
    }
    Canonicalize(&flat);
  }
  delaunay->clear();
  SortCells(&tetrahedra.cells);
  tetrahedra.vertex_cells.assign(tetrahedra.points.size(), kNoCell);
  for (uint32_t cell = 0; cell < tetrahedra.cells.size(); ++cell) {
    for (const uint32_t vertex : tetrahedra.cells[cell].vertices) {
      if (vertex != kInfiniteVertex &&
          tetrahedra.vertex_cells[vertex] == kNoCell &&
          !tetrahedra.IsInfinite(cell)) {
        tetrahedra.vertex_cells[vertex] = cell;
      }
    }
  }
}

}  // namespace

void IncidentCells(const Tetrahedralization& tetrahedra, uint32_t vertex,
                   std::vector<uint32_t>* cells) {
  // A vertex has some 25 cells, but an outlier can have thousands.
  constexpr size_t kMaxLinearSearch = 64;
  std::unordered_set<uint32_t> seen;
  cells->clear();
  cells->push_back(tetrahedra.vertex_cells[vertex]);
  for (size_t i = 0; i < cells->size(); ++i) {
    const Tetrahedralization::Cell& cell = tetrahedra.cells[(*cells)[i]];
    for (int k = 0; k < 4; ++k) {
      const uint32_t neighbor = cell.neighbors[k];
      if (cell.vertices[k] == vertex) {
        continue;
      }
      if (cells->size() <= kMaxLinearSearch) {
        if (std::find(cells->begin(), cells->end(), neighbor) == cells->end()) {
          cells->push_back(neighbor);
        }
        continue;
      }
      if (seen.empty()) {
        seen.insert(cells->begin(), cells->end());
      }
      if (seen.insert(neighbor).second) {
        cells->push_back(neighbor);
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
  std::vector<uint32_t> stand_ins;
  const std::vector<uint32_t> points =
      DistinctPoints(cloud.positions, &stand_ins);
  result.num_duplicate_points = cloud.size() - points.size();
  if (points.size() < 4) {
    throw std::invalid_argument("fewer than four points: nothing to mesh");
  }
  if (options.max_proj_dist > 0) {
    auto delaunay =
        InsertThinned(cloud, views, options, points, &stand_ins, progress);
    Flatten(&delaunay, cloud, points, stand_ins, &result);
  } else {
    auto delaunay = InsertAll(cloud, points);
    Flatten(&delaunay, cloud, points, stand_ins, &result);
  }
  return result;
}

}  // namespace colmap_ext
