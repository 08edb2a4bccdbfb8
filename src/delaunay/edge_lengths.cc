#include "delaunay/tetrahedralization.h"

#include <algorithm>
#include <array>
#include <vector>

#include <tbb/parallel_for.h>

#include "base/percentile.h"

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

std::vector<float> EdgeLengths(const Tetrahedralization& tetrahedra,
                               const std::vector<uint8_t>& is_left_out) {
  constexpr size_t kBlock = 1 << 14;  // cells: 512 kB, fits a core's cache
  const size_t num_cells = tetrahedra.cells.size();
  std::vector<std::vector<float>> lengths((num_cells + kBlock - 1) / kBlock);
  tbb::parallel_for(size_t{0}, lengths.size(), [&](size_t block) {
    const size_t end = std::min(num_cells, (block + 1) * kBlock);
    for (size_t cell = block * kBlock; cell < end; ++cell) {
      AppendLengths(tetrahedra, is_left_out, static_cast<uint32_t>(cell),
                    &lengths[block]);
    }
  });
  std::vector<float> all;
  for (std::vector<float>& block : lengths) {
    all.insert(all.end(), block.begin(), block.end());
    std::vector<float>().swap(block);
  }
  return all;
}

float EdgeLengthPercentile(const Tetrahedralization& tetrahedra, double percent,
                           const std::vector<uint8_t>& is_left_out) {
  std::vector<float> lengths = EdgeLengths(tetrahedra, is_left_out);
  return lengths.empty() ? 0 : Percentile(percent, &lengths);
}

}  // namespace colmap_ext
