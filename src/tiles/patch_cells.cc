#include "tiles/patch_cells.h"

#include <algorithm>
#include <utility>

#include <tbb/parallel_sort.h>

namespace colmap_ext {

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
  TileWindow from(seam_, tile);
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
  const uint32_t place = places_.PlaceIn(key, &keys_);
  if (place < num_taken_) {
    return;
  }
  if (place - num_taken_ == cells_.size()) {
    cell.label = from->LabelOf(index);
    cells_.push_back(cell);
  }
  PatchCell& kept = cells_[place - num_taken_];
  if (kept.has_capacities || blocks_.OwnerOf(key) != tile) {
    return;
  }
  cell.label = kept.label;
  cell.has_capacities = true;
  cell.capacities = from->CapacitiesOf(index);
  SortCorners(&cell.corners, &cell.capacities.arcs);
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
    TileWindow from(seam_, tile);
    for (const uint32_t id : ids) {
      from.CellsAt(id - blocks_.FirstVertex(tile), &star);
      for (const uint32_t index : star) {
        if (places_.Contains(Sorted(from.CornersOf(index)), keys_)) {
          AddCell(tile, index, &from);
        }
      }
    }
  }
}

TileWindow::TileWindow(const SeamLabels& seam, uint32_t tile)
    : seam_(seam),
      tile_(tile),
      vertices_(seam.parts().ReadVertices(tile)),
      num_cells_(seam.parts().NumCells(tile)),
      blocks_((num_cells_ + kBlockCells - 1) / kBlockCells) {}

const PartCells& TileWindow::BlockOf(uint32_t cell) {
  std::unique_ptr<PartCells>& block = blocks_[cell / kBlockCells];
  if (!block) {
    const uint32_t begin = cell - cell % kBlockCells;
    block = std::make_unique<PartCells>(seam_.parts().ReadCells(
        tile_, begin, std::min(num_cells_, begin + kBlockCells)));
  }
  return *block;
}

void TileWindow::CellsAt(uint32_t vertex, std::vector<uint32_t>* cells) {
  CollectStar(
      vertex, vertices_.first_cells[vertex],
      [this](uint32_t cell) -> const auto& {
        return BlockOf(cell).cells[cell % kBlockCells];
      },
      cells);
}

uint8_t TileWindow::LabelOf(uint32_t cell) {
  const uint8_t label = BlockOf(cell).labels[cell % kBlockCells];
  return label == kNotKnown ? seam_.At(CornersOf(cell)) : label;
}

}  // namespace colmap_ext
