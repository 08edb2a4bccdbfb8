#include "tiles/seam_cut.h"

#include <algorithm>
#include <cstdlib>
#include <stdexcept>

#include "delaunay/cell_graph.h"
#include "optim/min_cut.h"
#include "tiles/tile_labels.h"

namespace colmap_ext {
namespace {

[[noreturn]] void ThrowContradiction() {
  throw std::logic_error("the tiles contradict each other at a seam");
}

// Whether two tiles say the same of an arc. A ray that starts on a facet in one
// of them is moved there by a millionth of sigma, which rounding may show.
bool Agree(uint32_t a, uint32_t b) {
  constexpr int64_t kMaxDifference = 16;  // of 4096 a ray
  return std::abs(int64_t{a} - int64_t{b}) <= kMaxDifference;
}

class SeamGraph {
 public:
  explicit SeamGraph(const std::vector<TileSeam>& seams) {
    for (const TileSeam& seam : seams) {
      for (const SharedCell& cell : seam.shared) {
        known_[cell.key] = static_cast<uint8_t>(cell.label);
      }
      cells_.insert(cells_.end(), seam.unknown.begin(), seam.unknown.end());
    }
    std::ranges::sort(cells_, {}, &UnknownCell::key);
    for (uint32_t node = 0; node < cells_.size(); ++node) {
      if (!nodes_.emplace(cells_[node].key, node).second) {
        ThrowContradiction();
      }
    }
  }

  SeamLabels Cut() {
    AddArcs();
    const MinCut cut = ComputeMinCut(graph_);
    if (CutValue(graph_, cut.on_source_side) != cut.flow) {
      throw std::logic_error("the minimum cut differs from the maximum flow");
    }
    SeamLabels result;
    result.labels = std::move(known_);
    result.num_cut_cells = cells_.size();
    result.flow = cut.flow;
    for (size_t node = 0; node < cells_.size(); ++node) {
      result.labels[cells_[node].key] = cut.on_source_side[node];
    }
    return result;
  }

 private:
  void AddArcs() {
    graph_.capacities.assign(cells_.size(), {0, 0, 0, 0});
    graph_.neighbors.assign(
        cells_.size(), {kNoNeighbor, kNoNeighbor, kNoNeighbor, kNoNeighbor});
    graph_.source.resize(cells_.size());
    graph_.sink.resize(cells_.size());
    for (uint32_t node = 0; node < cells_.size(); ++node) {
      graph_.source[node] = std::min(cells_[node].source, kMaxCapacity);
      graph_.sink[node] = std::min(cells_[node].sink, kMaxCapacity);
      for (int i = 0; i < 4; ++i) {
        AddArc(node, i);
      }
    }
  }

  void AddArc(uint32_t node, int i) {
    const UnknownCell& cell = cells_[node];
    CellKey other = cell.key;
    other[i] = cell.apexes[i];
    other = Sorted(other);
    const auto found = nodes_.find(other);
    if (found != nodes_.end()) {
      const UnknownCell& neighbor = cells_[found->second];
      const auto back =
          static_cast<size_t>(std::ranges::find(neighbor.key, cell.apexes[i]) -
                              neighbor.key.begin());
      if (neighbor.apexes[back] != cell.key[i] ||
          !Agree(neighbor.back[back], cell.out[i])) {
        ThrowContradiction();
      }
      graph_.neighbors[node][i] = found->second;
      graph_.capacities[node][i] = cell.out[i];
      return;
    }
    uint8_t label = cell.labels[i];
    if (label > kFreeSpace) {
      const auto known = known_.find(other);
      if (known == known_.end()) {
        ThrowContradiction();
      }
      label = known->second;
    }
    if (label == kFreeSpace) {
      AddCapacity(cell.back[i], &graph_.source[node]);
    } else {
      AddCapacity(cell.out[i], &graph_.sink[node]);
    }
  }

  std::unordered_map<CellKey, uint8_t, KeyHash> known_;
  std::vector<UnknownCell> cells_;  // [nodes]
  std::unordered_map<CellKey, uint32_t, KeyHash> nodes_;
  FlowGraph graph_;
};

}  // namespace

uint8_t SeamLabels::At(const CellKey& corners) const {
  const auto found = labels.find(Sorted(corners));
  if (found == labels.end()) {
    ThrowContradiction();
  }
  return found->second;
}

SeamLabels CutSeams(const std::vector<TileSeam>& seams) {
  return SeamGraph(seams).Cut();
}

void ApplySeamLabels(const SeamLabels& seam, const TileTetrahedra& tile,
                     std::vector<uint8_t>* labels) {
  for (uint32_t cell = 0; cell < labels->size(); ++cell) {
    if ((*labels)[cell] != kNotKnown) {
      continue;
    }
    if (!tile.IsStarCell(cell)) {
      (*labels)[cell] = kMatter;
      continue;
    }
    (*labels)[cell] = seam.At(tile.CornersOf(cell));
  }
}

}  // namespace colmap_ext
