#include "tiles/tile_cut.h"

#include <algorithm>

#include <tbb/parallel_sort.h>

namespace colmap_ext {
namespace {

UnknownCell UnknownOf(const TileCut& cut, uint32_t cell) {
  const Tetrahedralization& tetrahedra = cut.tile.tetrahedra;
  const CellKey corners = cut.tile.CornersOf(cell);
  std::array<uint32_t, 4> order = {0, 1, 2, 3};
  std::ranges::sort(order, {}, [&](uint32_t k) { return corners[k]; });
  UnknownCell unknown;
  unknown.source = std::min(cut.graph[cell].source, kMaxCapacity);
  unknown.sink = std::min(cut.graph[cell].sink, kMaxCapacity);
  unknown.guess = cut.labels.guesses[cell];
  for (int i = 0; i < 4; ++i) {
    const uint32_t k = order[i];
    const uint32_t other = tetrahedra.cells[cell].neighbors[k];
    const uint32_t back = tetrahedra.FacetTo(other, cell);
    unknown.key[i] = corners[k];
    unknown.apexes[i] = cut.tile.CornersOf(other)[back];
    unknown.labels[i] = cut.places[other] != CellPlace::kBeyond
                            ? cut.labels.known[other]
                            : kOutside;
    unknown.out[i] = std::min(cut.graph[cell].arcs[k], kMaxCapacity);
    unknown.back[i] = std::min(cut.graph[other].arcs[back], kMaxCapacity);
  }
  return unknown;
}

}  // namespace

TileSeam SeamOf(const TileCut& cut) {
  TileSeam seam;
  for (uint32_t cell = 0; cell < cut.places.size(); ++cell) {
    if (cut.places[cell] == CellPlace::kBeyond) {
      continue;
    }
    if (cut.labels.known[cell] == kNotKnown) {
      seam.unknown.push_back(UnknownOf(cut, cell));
    } else if (cut.places[cell] == CellPlace::kShared) {
      seam.shared.push_back(
          {Sorted(cut.tile.CornersOf(cell)), cut.labels.known[cell]});
    }
  }
  tbb::parallel_sort(
      seam.unknown.begin(), seam.unknown.end(),
      [](const UnknownCell& a, const UnknownCell& b) { return a.key < b.key; });
  std::ranges::sort(seam.shared, {}, &SharedCell::key);
  return seam;
}

}  // namespace colmap_ext
