#include "tiles/merged_plan.h"

#include <algorithm>
#include <numeric>
#include <stdexcept>
#include <string>
#include <utility>

#include "base/indices.h"

namespace colmap_ext {

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
