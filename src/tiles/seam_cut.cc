#include "tiles/seam_cut.h"

#include <algorithm>
#include <cstdlib>
#include <stdexcept>

#include "optim/min_cut.h"
#include "tiles/tile_labels.h"

namespace colmap_ext {
namespace {

[[noreturn]] void ThrowContradiction() {
  throw std::logic_error("the tiles contradict each other at a seam");
}

// Whether two tiles say the same of a cell. A ray that starts on a facet in one
// of them is moved there by a millionth of sigma, which rounding may show.
bool Agree(const UnknownCell& a, const UnknownCell& b) {
  constexpr int64_t kMaxDifference = 16;  // of 4096 a ray
  bool agree = a.apexes == b.apexes;
  const auto compare = [&](uint32_t x, uint32_t y) {
    agree = agree && std::abs(int64_t{x} - int64_t{y}) <= kMaxDifference;
  };
  for (int i = 0; i < 4; ++i) {
    compare(a.out[i], b.out[i]);
    compare(a.back[i], b.back[i]);
  }
  compare(a.source, b.source);
  compare(a.sink, b.sink);
  return agree;
}

class SeamGraph {
 public:
  explicit SeamGraph(const std::vector<TileSeam>& seams) {
    for (const TileSeam& seam : seams) {
      for (const SharedCell& cell : seam.shared) {
        const auto label = static_cast<uint8_t>(cell.label);
        const auto [entry, is_new] = known_.try_emplace(cell.key, label);
        if (!is_new && entry->second != label) {
          ThrowContradiction();
        }
      }
    }
    for (const TileSeam& seam : seams) {
      for (const UnknownCell& cell : seam.unknown) {
        Collect(cell);
      }
    }
    std::ranges::stable_sort(cells_, {}, &UnknownCell::key);
    Unite();
  }

  SeamLabels Cut() {
    AddArcs();
    const MinCut cut = ComputeMinCut(graph_);
    if (CutValue(graph_, cut.on_source_side) != cut.flow) {
      throw std::logic_error("the minimum cut differs from the maximum flow");
    }
    SeamLabels result;
    result.labels = std::move(solved_);
    result.num_cut_cells = cells_.size();
    result.flow = cut.flow;
    for (size_t node = 0; node < cells_.size(); ++node) {
      result.labels[cells_[node].key] = cut.on_source_side[node];
    }
    return result;
  }

 private:
  // Cells that another tile could tell are solved.
  void Collect(const UnknownCell& cell) {
    const auto found = known_.find(cell.key);
    if (found != known_.end()) {
      solved_[cell.key] = found->second;
    } else {
      cells_.push_back(cell);
    }
  }

  // Makes one cell of those of several tiles, with all that they know of what
  // is beside it.
  // \pre sorted
  void Unite() {
    size_t size = 0;
    for (const UnknownCell& cell : cells_) {
      if (size == 0 || cells_[size - 1].key != cell.key) {
        nodes_[cell.key] = static_cast<uint32_t>(size);
        cells_[size++] = cell;
        continue;
      }
      UnknownCell& first = cells_[size - 1];
      if (!Agree(first, cell)) {
        ThrowContradiction();
      }
      for (int i = 0; i < 4; ++i) {
        if (cell.labels[i] <= kFreeSpace) {
          first.labels[i] = cell.labels[i];
        }
      }
    }
    cells_.resize(size);
  }

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
      graph_.source[node] += cell.back[i];
    } else {
      graph_.sink[node] += cell.out[i];
    }
  }

  std::unordered_map<CellKey, uint8_t, KeyHash> known_;
  std::unordered_map<CellKey, uint8_t, KeyHash> solved_;
  std::vector<UnknownCell> cells_;  // [nodes]
  std::unordered_map<CellKey, uint32_t, KeyHash> nodes_;
  FlowGraph graph_;
};

}  // namespace

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
    CellKey key = tile.tetrahedra.cells[cell].vertices;
    for (uint32_t& corner : key) {
      corner = corner == kInfiniteVertex ? corner : tile.ids[corner];
    }
    const auto found = seam.labels.find(Sorted(key));
    if (found == seam.labels.end()) {
      ThrowContradiction();
    }
    (*labels)[cell] = found->second;
  }
}

}  // namespace colmap_ext
