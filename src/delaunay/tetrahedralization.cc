#include "delaunay/tetrahedralization.h"

#include <cmath>
#include <stdexcept>
#include <utility>

#include "base/percentile.h"
#include "delaunay/growing_complex.h"

namespace colmap_ext {
namespace {

// Whether a point is near enough to all corners of its cell, in all of its
// views, to be left out.
bool IsRedundant(const PointCloud& cloud, const std::vector<View>& views,
                 const ThinningOptions& options, uint32_t point,
                 const std::array<uint32_t, 4>& corners) {
  return std::ranges::all_of(cloud.views[point], [&](uint32_t index) {
    const View& view = views[index];
    const Eigen::Vector3d local =
        view.CamFromWorld(cloud.positions[point].cast<double>());
    return std::ranges::all_of(corners, [&](uint32_t corner) {
      const Eigen::Vector3d other =
          view.CamFromWorld(cloud.positions[corner].cast<double>());
      return local.z() > 0 && other.z() > 0 &&
             std::abs(local.z() / other.z() - 1) <= options.max_depth_dist &&
             (view.ImageFromCam(local) - view.ImageFromCam(other))
                     .squaredNorm() <=
                 options.max_proj_dist * options.max_proj_dist;
    });
  });
}

uint32_t NearestCorner(const PointCloud& cloud, uint32_t point,
                       const std::array<uint32_t, 4>& corners) {
  return *std::ranges::min_element(corners, {}, [&](uint32_t corner) {
    return (cloud.positions[corner] - cloud.positions[point]).squaredNorm();
  });
}

// Gives points without a vertex the vertex of their representative, or of its
// representative in turn.
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

// Pairs of corners.
constexpr std::array<std::array<int, 2>, 6> kEdges = {
    {{{0, 1}}, {{0, 2}}, {{0, 3}}, {{1, 2}}, {{1, 3}}, {{2, 3}}}};

// Whether no cell around the edge has a lower index.
bool IsLowestCellOfEdge(const Tetrahedralization& tetrahedra, uint32_t first,
                        int from, int to) {
  const auto& start = tetrahedra.cells[first].vertices;
  const uint32_t u = start[from];
  const uint32_t v = start[to];
  uint32_t index = first;
  // The other two corners: the walk leaves through the facet opposite to one,
  // and comes back through the other's.
  int leave = 0;
  while (leave == from || leave == to) ++leave;
  const int back = 6 - from - to - leave;
  if (tetrahedra.cells[first].neighbors[back] < first) return false;
  for (;;) {
    const uint32_t next = tetrahedra.cells[index].neighbors[leave];
    if (next == first) return true;
    if (next < first) return false;
    // The next one to leave opposite to is neither on the edge nor new.
    const int entered = tetrahedra.FacetTo(next, index);
    const auto& vertices = tetrahedra.cells[next].vertices;
    leave = 0;
    while (leave == entered || vertices[leave] == u || vertices[leave] == v) {
      ++leave;
    }
    index = next;
  }
}

// Appends the lengths of the finite edges whose lowest cell is this one.
void AppendLengths(const Tetrahedralization& tetrahedra,
                   const std::vector<uint8_t>& is_left_out, uint32_t cell,
                   std::vector<float>* lengths) {
  const auto& v = tetrahedra.cells[cell].vertices;
  const auto counts = [&](uint32_t vertex) {
    return vertex != kInfiniteVertex &&
           (is_left_out.empty() || is_left_out[vertex] == 0);
  };
  for (const auto& [i, j] : kEdges) {
    if (counts(v[i]) && counts(v[j]) &&
        IsLowestCellOfEdge(tetrahedra, cell, i, j)) {
      lengths->push_back(
          (tetrahedra.points[v[i]] - tetrahedra.points[v[j]]).norm());
    }
  }
}

}  // namespace

void SortCorners(std::array<uint32_t, 4>* vertices,
                 std::array<uint32_t, 4>* of_corners) {
  bool is_odd = false;
  const auto swap = [&](int i, int j) {
    std::swap((*vertices)[i], (*vertices)[j]);
    std::swap((*of_corners)[i], (*of_corners)[j]);
  };
  for (int i = 1; i < 4; ++i) {
    for (int j = i; j > 0 && (*vertices)[j] < (*vertices)[j - 1]; --j) {
      swap(j - 1, j);
      is_odd = !is_odd;
    }
  }
  if (is_odd) {
    swap(2, 3);
  }
}

void IncidentCells(const Tetrahedralization& tetrahedra, uint32_t vertex,
                   std::vector<uint32_t>* cells) {
  CollectStar(
      vertex, tetrahedra.vertex_cells[vertex],
      [&](uint32_t cell) -> const auto& { return tetrahedra.cells[cell]; },
      cells);
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
  // Redundant points are left out; they are represented by the nearest vertex
  // of the cell that they fall into.
  const auto leave_out = [&](const GrowingComplex& so_far, uint32_t point,
                             uint32_t cell) {
    if (InfiniteCorner(so_far.cells[cell]) != 4) {
      return false;
    }
    std::array<uint32_t, 4> corners;
    std::ranges::transform(so_far.cells[cell].vertices, corners.begin(),
                           [&](uint32_t vertex) { return points[vertex]; });
    if (!IsRedundant(cloud, views, options, points[point], corners)) {
      return false;
    }
    representatives[points[point]] =
        NearestCorner(cloud, points[point], corners);
    return true;
  };
  InsertPoints(InsertionOrder(points.size()),
               options.max_proj_dist > 0 ? LeaveOut(leave_out) : LeaveOut(),
               progress, &complex);
  ThinnedTetrahedralization result;
  result.num_duplicate_points = cloud.size() - points.size();
  result.point_vertices.assign(cloud.size(), kNone);
  std::vector<uint32_t> numbers(points.size(), kNone);
  for (size_t i = 0; i < points.size(); ++i) {
    if (complex.vertex_cells[i] != kNone) {
      numbers[i] = static_cast<uint32_t>(result.vertex_points.size());
      result.point_vertices[points[i]] = numbers[i];
      result.vertex_points.push_back(points[i]);
    }
  }
  FollowRepresentatives(representatives, &result.point_vertices);
  result.tetrahedra = TakeTetrahedra(numbers, &complex);
  return result;
}

std::vector<float> EdgeLengths(const Tetrahedralization& tetrahedra,
                               const std::vector<uint8_t>& is_left_out) {
  return MakeRows<float>(tetrahedra.cells.size(),
                         [&](size_t cell, std::vector<float>* lengths) {
                           AppendLengths(tetrahedra, is_left_out,
                                         static_cast<uint32_t>(cell), lengths);
                         })
      .values;
}

float EdgeLengthPercentile(const Tetrahedralization& tetrahedra, double percent,
                           const std::vector<uint8_t>& is_left_out) {
  std::vector<float> lengths = EdgeLengths(tetrahedra, is_left_out);
  return lengths.empty() ? 0 : Percentile(percent, &lengths);
}

}  // namespace colmap_ext
