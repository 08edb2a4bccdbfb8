#include "delaunay/tetrahedralization.h"

#include <stdexcept>
#include <utility>

#include "base/rows.h"
#include "delaunay/growing_complex.h"

namespace colmap_ext {
namespace {

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

Tetrahedralization Tetrahedralize(std::vector<Eigen::Vector3f> points,
                                  const Progress& progress) {
  Report(progress, kTriangulatingStage, 0);
  const size_t num_points = points.size();
  if (num_points < 4) {
    throw std::invalid_argument("too few points to mesh: lower max_proj_dist");
  }
  GrowingComplex complex;
  complex.points = std::move(points);
  InsertPoints(InsertionOrder(num_points), progress, &complex);
  return TakeTetrahedra(Iota(num_points), &complex);
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

}  // namespace colmap_ext
