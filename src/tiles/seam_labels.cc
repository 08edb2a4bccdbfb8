#include "tiles/seam_labels.h"

#include <algorithm>
#include <numeric>
#include <stdexcept>
#include <string>
#include <utility>

namespace colmap_ext {
namespace {

// The place of a key among cells whose keys ascend.
template <typename Cell>
size_t PlaceOf(const std::vector<Cell>& cells, const CellKey& key) {
  const auto found = std::ranges::lower_bound(cells, key, {}, &Cell::key);
  return found != cells.end() && found->key == key
             ? static_cast<size_t>(found - cells.begin())
             : cells.size();
}

}  // namespace

SeamLabels::SeamLabels(const PlanBlocks& blocks, const TileParts& parts)
    : blocks_(blocks), parts_(parts) {
  for (uint32_t tile = 0; tile < blocks.NumTiles(); ++tile) {
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
  const uint32_t tile = blocks_.OwnerOf(key);
  const auto seam = Seam(tile);
  if (const size_t place = PlaceOf(seam->unknown, key);
      place < seam->unknown.size()) {
    return {labels_[tile][place], tile, static_cast<uint32_t>(place)};
  }
  if (const size_t place = PlaceOf(seam->shared, key);
      place < seam->shared.size()) {
    return {static_cast<uint8_t>(seam->shared[place].label), tile, kNone};
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
