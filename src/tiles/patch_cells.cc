#include "tiles/patch_cells.h"

#include <algorithm>
#include <map>
#include <utility>

#include "meshing/singular_vertices.h"

namespace colmap_ext {
namespace {

constexpr uint32_t kNoSlot = UINT32_MAX;

// Sorts the corners, and what belongs to them, as those of a
// Tetrahedralization's cells are.
void SortCorners(PatchCell* cell) {
  bool is_odd = false;
  const auto swap = [&](int i, int j) {
    std::swap(cell->corners[i], cell->corners[j]);
    std::swap(cell->capacities[i], cell->capacities[j]);
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

PatchCollector::Tile PatchCollector::Read(uint32_t tile) const {
  Tile read{parts_.ReadPart(tile), parts_.ReadGraph(tile), {}};
  read.labels = read.part->labels;
  ApplySeamLabels(seam_, read.part->tile, &read.labels);
  return read;
}

std::vector<uint32_t> PatchCollector::FindSingular() const {
  std::vector<uint32_t> singular;
  for (uint32_t tile = 0; tile < blocks_.NumTiles(); ++tile) {
    const auto part = parts_.ReadPart(tile);
    std::vector<uint8_t> labels = part->labels;
    ApplySeamLabels(seam_, part->tile, &labels);
    for (const uint32_t vertex :
         SingularVertices(part->tile.tetrahedra, labels)) {
      if (vertex < part->tile.num_own) {
        singular.push_back(part->tile.ids[vertex]);
      }
    }
  }
  return singular;
}

Ring PatchCollector::AddRings(const std::vector<uint32_t>& vertices) {
  for (const uint32_t id : vertices) {
    Reach(id, 0, nullptr, kNoSlot);
  }
  while (!waiting_.empty()) {
    auto next = waiting_.extract(waiting_.begin());
    AddRingsIn(next.key(), std::move(next.mapped()));
  }
  Ring first;
  for (const auto& [id, ring] : rings_) {
    if (ring <= 1) {
      first.insert(id);
    }
  }
  return first;
}

// Goes on from vertices of a tile as far as that has their cells.
void PatchCollector::AddRingsIn(uint32_t tile, std::vector<uint32_t> ids) {
  const Tile from = Read(tile);
  std::vector<uint32_t> star;
  for (uint8_t ring = 0; ring < kNumRings; ++ring) {
    for (size_t i = 0; i < ids.size(); ++i) {
      if (rings_.at(ids[i]) != ring) {
        continue;
      }
      IncidentCells(from.part->tile.tetrahedra,
                    ids[i] - blocks_.FirstVertex(tile), &star);
      for (const uint32_t index : star) {
        AddCell(tile, from, index);
        for (const uint32_t id : from.part->tile.CornersOf(index)) {
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
  if (id == kInfiniteVertex) {
    return;
  }
  const auto [found, is_new] = rings_.try_emplace(id, ring);
  if (!is_new && found->second <= ring) {
    return;
  }
  found->second = ring;
  if (ring < kNumRings) {
    const uint32_t home = blocks_.TileOf(id);
    (home == tile ? *here : waiting_[home]).push_back(id);
  }
}

std::vector<PatchCell> PatchCollector::Take() {
  AddMissingCapacities();
  std::vector<uint32_t>().swap(slots_);
  std::unordered_map<uint32_t, uint8_t>().swap(rings_);
  std::ranges::sort(cells_, {}, &PatchCell::corners);
  return std::move(cells_);
}

template <typename Ids, typename Function>
void PatchCollector::ForEachCellAt(uint32_t tile, const Ids& ids,
                                   const Function& function) const {
  const Tile from = Read(tile);
  std::vector<uint32_t> star;
  for (const uint32_t id : ids) {
    IncidentCells(from.part->tile.tetrahedra, id - blocks_.FirstVertex(tile),
                  &star);
    for (const uint32_t index : star) {
      function(from, index);
    }
  }
}

void PatchCollector::AddCell(uint32_t tile, const Tile& from, uint32_t index) {
  PatchCell cell{from.part->tile.CornersOf(index), from.labels[index]};
  const CellKey key = Sorted(cell.corners);
  GrowSlots();
  uint32_t* slot = &slots_[SlotOf(key)];
  if (*slot == kNoSlot) {
    *slot = static_cast<uint32_t>(cells_.size());
    cells_.push_back(cell);
  }
  PatchCell& kept = cells_[*slot];
  if (kept.has_capacities || blocks_.OwnerOf(key) != tile) {
    return;
  }
  cell.has_capacities = true;
  cell.capacities = from.graph.capacities[index];
  cell.source = from.graph.source[index];
  cell.sink = from.graph.sink[index];
  SortCorners(&cell);
  kept = cell;
}

// Reads cells whose own tiles were not asked yet: all around one of their
// vertices there, of which those that are in the patch count.
void PatchCollector::AddMissingCapacities() {
  std::map<uint32_t, Ring> by_tile;
  for (const PatchCell& cell : cells_) {
    if (!cell.has_capacities) {
      const uint32_t owner = blocks_.OwnerOf(cell.corners);
      by_tile[owner].insert(
          *std::ranges::find_if(cell.corners, [&](uint32_t id) {
            return id != kInfiniteVertex && blocks_.TileOf(id) == owner;
          }));
    }
  }
  for (const auto& [tile, ids] : by_tile) {
    ForEachCellAt(
        tile, ids, [this, owner = tile](const Tile& from, uint32_t index) {
          const CellKey key = Sorted(from.part->tile.CornersOf(index));
          if (slots_[SlotOf(key)] != kNoSlot) {
            AddCell(owner, from, index);
          }
        });
  }
}

size_t PatchCollector::SlotOf(const CellKey& key) const {
  const size_t mask = slots_.size() - 1;
  size_t slot = KeyHash()(key) & mask;
  while (slots_[slot] != kNoSlot &&
         Sorted(cells_[slots_[slot]].corners) != key) {
    slot = (slot + 1) & mask;
  }
  return slot;
}

// Makes room for one more cell.
void PatchCollector::GrowSlots() {
  constexpr size_t kFirst = 1 << 12;
  if (2 * (cells_.size() + 1) <= slots_.size()) {
    return;
  }
  slots_.assign(std::max(kFirst, 2 * slots_.size()), kNoSlot);
  for (uint32_t i = 0; i < cells_.size(); ++i) {
    slots_[SlotOf(Sorted(cells_[i].corners))] = i;
  }
}

}  // namespace colmap_ext
