#include "tiles/patch_cells.h"

#include <algorithm>
#include <map>
#include <utility>

#include <tbb/parallel_sort.h>

#include "base/index_limit.h"

namespace colmap_ext {
namespace {

// Sorts the corners, and what belongs to them, as those of a
// Tetrahedralization's cells are.
void SortCorners(PatchCell* cell) {
  bool is_odd = false;
  const auto swap = [&](int i, int j) {
    std::swap(cell->corners[i], cell->corners[j]);
    std::swap(cell->capacities.facets[i], cell->capacities.facets[j]);
  };
  for (int i = 1; i < 4; ++i) {
    for (int j = i; j > 0 && cell->corners[j] < cell->corners[j - 1]; --j) {
      swap(j - 1, j);
      is_odd = !is_odd;
    }
  }
  if (is_odd) {
    swap(2, 3);
  }
}

}  // namespace

std::vector<PatchCell> PatchCollector::Take(
    const std::vector<uint32_t>& vertices) {
  for (const uint32_t id : vertices) {
    Reach(id, 0, nullptr, kNone);
  }
  while (!waiting_.empty()) {
    auto next = waiting_.extract(waiting_.begin());
    AddRingsIn(next.key(), std::move(next.mapped()));
  }
  AddMissingCapacities();
  num_taken_ = keys_.size();
  std::vector<PatchCell> cells = std::move(cells_);
  cells_.clear();
  tbb::parallel_sort(cells.begin(), cells.end(),
                     [](const PatchCell& a, const PatchCell& b) {
                       return a.corners < b.corners;
                     });
  return cells;
}

// Goes on from vertices of a tile as far as that has their cells.
void PatchCollector::AddRingsIn(uint32_t tile, std::vector<uint32_t> ids) {
  TileWindow from(parts_, seam_, tile);
  std::vector<uint32_t> star;
  for (uint8_t ring = 0; ring < kNumRings; ++ring) {
    for (size_t i = 0; i < ids.size(); ++i) {
      if (rings_.at(ids[i]) != ring) {
        continue;
      }
      from.CellsAt(ids[i] - blocks_.FirstVertex(tile), &star);
      for (const uint32_t index : star) {
        AddCell(tile, index, &from);
        for (const uint32_t id : from.CornersOf(index)) {
          Reach(id, static_cast<uint8_t>(ring + 1), &ids, tile);
        }
      }
    }
  }
}

// Has the cells at a vertex added, if it lies in a lower ring than was known.
// \param here  vertices of the tile that is being read
void PatchCollector::Reach(uint32_t id, uint8_t ring,
                           std::vector<uint32_t>* here, uint32_t tile) {
  if (id == kInfiniteVertex || ring >= kNumRings) {
    return;
  }
  const auto [found, is_new] = rings_.try_emplace(id, ring);
  if (!is_new && found->second <= ring) {
    return;
  }
  found->second = ring;
  const uint32_t home = blocks_.TileOf(id);
  (home == tile ? *here : waiting_[home]).push_back(id);
}

void PatchCollector::AddCell(uint32_t tile, uint32_t index, TileWindow* from) {
  PatchCell cell{from->CornersOf(index)};
  const CellKey key = Sorted(cell.corners);
  GrowSlots();
  uint32_t* slot = &slots_[SlotOf(key)];
  const bool is_new = *slot == kNone;
  if (is_new) {
    *slot = static_cast<uint32_t>(keys_.size());
    keys_.push_back(key);
    cell.label = from->LabelOf(index);
    cells_.push_back(cell);
  }
  if (*slot < num_taken_) {
    return;
  }
  PatchCell& kept = cells_[*slot - num_taken_];
  if (kept.has_capacities || blocks_.OwnerOf(key) != tile) {
    return;
  }
  cell.label = kept.label;
  cell.has_capacities = true;
  cell.capacities = from->CapacitiesOf(index);
  SortCorners(&cell);
  kept = cell;
}

// Reads cells from their own tiles, where those were not read yet: all around
// one of their vertices there, of which those that are in the patch count.
void PatchCollector::AddMissingCapacities() {
  std::map<uint32_t, std::unordered_set<uint32_t>> by_tile;
  for (const PatchCell& cell : cells_) {
    if (!cell.has_capacities) {
      const uint32_t owner = blocks_.OwnerOf(cell.corners);
      by_tile[owner].insert(
          *std::ranges::find_if(cell.corners, [&](uint32_t id) {
            return id != kInfiniteVertex && blocks_.TileOf(id) == owner;
          }));
    }
  }
  std::vector<uint32_t> star;
  for (const auto& [tile, ids] : by_tile) {
    TileWindow from(parts_, seam_, tile);
    for (const uint32_t id : ids) {
      from.CellsAt(id - blocks_.FirstVertex(tile), &star);
      for (const uint32_t index : star) {
        if (slots_[SlotOf(Sorted(from.CornersOf(index)))] != kNone) {
          AddCell(tile, index, &from);
        }
      }
    }
  }
}

size_t PatchCollector::SlotOf(const CellKey& key) const {
  const size_t mask = slots_.size() - 1;
  size_t slot = KeyHash()(key) & mask;
  while (slots_[slot] != kNone && keys_[slots_[slot]] != key) {
    slot = (slot + 1) & mask;
  }
  return slot;
}

// Makes room for one more cell.
void PatchCollector::GrowSlots() {
  constexpr size_t kFirst = 1 << 12;
  if (2 * (keys_.size() + 1) <= slots_.size()) {
    return;
  }
  slots_.assign(std::max(kFirst, 2 * slots_.size()), kNone);
  for (uint32_t i = 0; i < keys_.size(); ++i) {
    slots_[SlotOf(keys_[i])] = i;
  }
}

TileWindow::TileWindow(const TileParts& parts, const SeamLabels& seam,
                       uint32_t tile)
    : parts_(parts),
      seam_(seam),
      tile_(tile),
      vertices_(parts.ReadVertices(tile)),
      num_cells_(parts.NumCells(tile)),
      blocks_((num_cells_ + kBlockCells - 1) / kBlockCells) {}

const PartCells& TileWindow::BlockOf(uint32_t cell) {
  std::unique_ptr<PartCells>& block = blocks_[cell / kBlockCells];
  if (!block) {
    const uint32_t begin = cell - cell % kBlockCells;
    block = std::make_unique<PartCells>(parts_.ReadCells(
        tile_, begin, std::min(num_cells_, begin + kBlockCells)));
  }
  return *block;
}

void TileWindow::CellsAt(uint32_t vertex, std::vector<uint32_t>* cells) {
  places_.Clear();
  cells->clear();
  places_.PlaceIn(vertices_.first_cells[vertex], cells);
  for (size_t i = 0; i < cells->size(); ++i) {
    const uint32_t index = (*cells)[i];
    const auto& cell = BlockOf(index).cells[index % kBlockCells];
    for (int k = 0; k < 4; ++k) {
      if (cell.vertices[k] != vertex) {
        places_.PlaceIn(cell.neighbors[k], cells);
      }
    }
  }
}

CellKey TileWindow::CornersOf(uint32_t cell) {
  CellKey corners = BlockOf(cell).cells[cell % kBlockCells].vertices;
  for (uint32_t& corner : corners) {
    corner = corner == kInfiniteVertex ? corner : vertices_.ids[corner];
  }
  return corners;
}

uint8_t TileWindow::LabelOf(uint32_t cell) {
  const uint8_t label = BlockOf(cell).labels[cell % kBlockCells];
  return label == kNotKnown ? seam_.At(CornersOf(cell)) : label;
}

CellCapacities TileWindow::CapacitiesOf(uint32_t cell) {
  const FlowCapacities& graph = BlockOf(cell).graph;
  const uint32_t place = cell % kBlockCells;
  return {graph.capacities[place], graph.source[place], graph.sink[place]};
}

}  // namespace colmap_ext
