#include "tiles/merged_plan.h"

#include <algorithm>
#include <array>
#include <cstdlib>
#include <map>
#include <numeric>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "base/indices.h"

namespace colmap_ext {
namespace {

// Whether two tiles say the same of an arc. They do so to the unit, but for the
// last bit of the exponentials of other processors.
bool Agree(uint32_t a, uint32_t b) {
  constexpr int64_t kMaxDifference = 16;  // of 4096 a ray
  return std::abs(int64_t{a} - int64_t{b}) <= kMaxDifference;
}

// Cells that are cut at a time.
class SeamWindow {
 public:
  explicit SeamWindow(SeamLabels* labels) : labels_(*labels) {}

  void AddTile(uint32_t tile) {
    for (uint32_t place = 0; place < labels_.NumUnknown(tile); ++place) {
      AddNode({0, tile, place});
    }
    num_own_ = nodes_.size();
  }

  // Adds rings of cells around those that are there, and finds out what lies
  // across the facets of all.
  void Connect(int num_rings) {
    for (int ring = 0; across_.size() < nodes_.size(); ++ring) {
      const size_t end = nodes_.size();
      for (size_t node = across_.size(); node < end; ++node) {
        const auto [label, tile, place] = nodes_[node];
        const auto seam = labels_.Seam(tile);
        std::array<SeamCell, 4>& across = across_.emplace_back();
        for (int i = 0; i < 4; ++i) {
          across[i] = labels_.Across(tile, seam->unknown[place], i);
          if (ring < num_rings && across[i].IsUnknown()) {
            AddNode(across[i]);
          }
        }
      }
    }
  }

  // \pre Connect() was called last
  // \return see CutSeams(), of the arcs from cells of the tiles that were added
  size_t Cut() {
    neighbors_.assign(nodes_.size(), {kNone, kNone, kNone, kNone});
    graph_.assign(nodes_.size(), {});
    for (uint32_t node = 0; node < nodes_.size(); ++node) {
      AddArcs(node);
    }
    const MinCut cut = ComputeMinCut(neighbors_, graph_);
    if (CutValue(neighbors_, graph_, cut.on_source_side) != cut.flow) {
      throw std::logic_error("the minimum cut differs from the maximum flow");
    }
    for (uint32_t node = 0; node < nodes_.size(); ++node) {
      labels_.Set(nodes_[node], cut.on_source_side[node]);
    }
    return num_contradictions_;
  }

 private:
  // Where it is not there yet.
  void AddNode(const SeamCell& cell) {
    std::vector<uint32_t>& of_tile = node_of_[cell.tile];
    if (of_tile.empty()) {
      of_tile.assign(labels_.NumUnknown(cell.tile), kNone);
    }
    if (of_tile[cell.place] == kNone) {
      of_tile[cell.place] = static_cast<uint32_t>(nodes_.size());
      nodes_.push_back(cell);
    }
  }

  uint32_t NodeOf(const SeamCell& cell) const {
    const auto of_tile = node_of_.find(cell.tile);
    return cell.IsUnknown() && of_tile != node_of_.end()
               ? of_tile->second[cell.place]
               : kNone;
  }

  void AddArcs(uint32_t node) {
    const auto seam = labels_.Seam(nodes_[node].tile);
    const UnknownCell& cell = seam->unknown[nodes_[node].place];
    graph_[node] = {.source = cell.source, .sink = cell.sink};
    for (int i = 0; i < 4; ++i) {
      const SeamCell& other = across_[node][i];
      const uint32_t other_node = NodeOf(other);
      if (other_node != kNone) {
        num_contradictions_ += node < num_own_ && !IsToldAlike(cell, i, other);
        neighbors_[node][i] = other_node;
        graph_[node].arcs[i] = cell.out[i];
      } else if (other.label == kFreeSpace) {
        AddCapacity(cell.back[i], &graph_[node].source);
      } else {
        AddCapacity(cell.out[i], &graph_[node].sink);
      }
    }
  }

  // Whether the tile of the cell across says the same of the arc to it.
  bool IsToldAlike(const UnknownCell& cell, int i,
                   const SeamCell& across) const {
    const auto seam = labels_.Seam(across.tile);
    const UnknownCell& other = seam->unknown[across.place];
    const auto back = static_cast<size_t>(
        std::ranges::find(other.key, cell.apexes[i]) - other.key.begin());
    return back < other.key.size() && other.apexes[back] == cell.key[i] &&
           Agree(other.back[back], cell.out[i]);
  }

  SeamLabels& labels_;
  std::vector<SeamCell> nodes_;
  size_t num_own_ = 0;  // of the tiles that were added, the first ones
  size_t num_contradictions_ = 0;
  std::vector<std::array<SeamCell, 4>> across_;  // [nodes]
  // Of tiles, by TileSeam::unknown.
  std::map<uint32_t, std::vector<uint32_t>> node_of_;
  std::vector<std::array<uint32_t, 4>> neighbors_;
  FlowCapacities graph_;
};

}  // namespace

size_t CutSeams(int seam_rings, SeamLabels* labels, const Progress& progress) {
  size_t num_contradictions = 0;
  const auto num_tiles = static_cast<uint32_t>(labels->NumTiles());
  const bool at_once = seam_rings == kAllAtOnce;
  if (at_once) {
    labels->HoldAllSeams();
  }
  const uint32_t step = at_once ? num_tiles : 1;
  for (uint32_t first = 0; first < num_tiles; first += step) {
    Report(progress, "Cutting the seams",
           static_cast<double>(first) / num_tiles);
    SeamWindow window(labels);
    for (uint32_t tile = first; tile < first + step; ++tile) {
      window.AddTile(tile);
    }
    window.Connect(at_once ? 0 : 2 * seam_rings);
    num_contradictions += window.Cut();
  }
  return num_contradictions;
}

SeamLabels::SeamLabels(const PlanVertices& plan, const TileParts& parts)
    : plan_(plan), parts_(parts) {
  for (uint32_t tile = 0; tile < plan.Blocks().NumTiles(); ++tile) {
    const TileSeam seam = parts.ReadSeam(tile);
    std::vector<uint8_t> labels;
    labels.reserve(seam.unknown.size());
    for (const UnknownCell& cell : seam.unknown) {
      labels.push_back(static_cast<uint8_t>(cell.guess));
    }
    labels_.push_back(std::move(labels));
    num_bytes_.push_back(seam.unknown.size() * sizeof(UnknownCell) +
                         seam.shared.size() * sizeof(SharedCell));
  }
  seams_.SetMaxBytes(kSeamsHeld * std::ranges::max(num_bytes_));
}

void SeamLabels::HoldAllSeams() {
  seams_.SetMaxBytes(
      std::accumulate(num_bytes_.begin(), num_bytes_.end(), size_t{0}));
}

size_t SeamLabels::NumUnknown() const {
  size_t count = 0;
  for (const std::vector<uint8_t>& labels : labels_) {
    count += labels.size();
  }
  return count;
}

std::shared_ptr<const TileSeam> SeamLabels::Seam(uint32_t tile) const {
  return seams_.Get(tile, num_bytes_[tile], [&] {
    return std::make_shared<TileSeam>(parts_.ReadSeam(tile));
  });
}

SeamCell SeamLabels::Find(const CellKey& corners) const {
  const CellKey key = Sorted(corners);
  const uint32_t tile = plan_.Blocks().OwnerOf(key);
  const auto seam = Seam(tile);
  const uint32_t unknown = IndexOf(seam->unknown, key, &UnknownCell::key);
  if (unknown != kNone) {
    return {labels_[tile][unknown], tile, unknown};
  }
  const uint32_t shared = IndexOf(seam->shared, key, &SharedCell::key);
  if (shared != kNone) {
    return {static_cast<uint8_t>(seam->shared[shared].label), tile, kNone};
  }
  throw std::logic_error("tile " + std::to_string(tile) +
                         " lacks a cell that its neighbor has");
}

SeamCell SeamLabels::Across(uint32_t tile, const UnknownCell& cell,
                            int facet) const {
  if (cell.labels[facet] <= kFreeSpace) {
    return {cell.labels[facet], tile, kNone};
  }
  CellKey other = cell.key;
  other[facet] = cell.apexes[facet];
  return Find(other);
}

TilePart SeamLabels::ReadPart(uint32_t tile) const {
  TilePart part = parts_.ReadPart(tile);
  for (uint32_t cell = 0; cell < part.labels.size(); ++cell) {
    uint8_t& label = part.labels[cell];
    if (label == kNotKnown) {
      label =
          part.tile.IsStarCell(cell) ? At(part.tile.CornersOf(cell)) : kMatter;
    }
  }
  return part;
}

}  // namespace colmap_ext
