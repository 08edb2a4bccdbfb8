#include "tiles/cell_changes.h"

#include <algorithm>

#include "base/index_limit.h"
#include "meshing/cell_splitting.h"

namespace colmap_ext {
namespace {

template <typename Value>
std::optional<Value> ValueAt(
    const std::unordered_map<CellKey, Value, KeyHash>& values,
    const CellKey& corners) {
  const auto found = values.find(Sorted(corners));
  return found != values.end() ? std::optional<Value>(found->second)
                               : std::nullopt;
}

}  // namespace

uint32_t CellChanges::Split(const CellKey& corners,
                            const Eigen::Vector3f& centroid) {
  const uint32_t vertex =
      ExpectIndexable(blocks_.NumVertices() + centroids_.size() + 1,
                      "vertices") -
      1;
  splits_[Sorted(corners)] = vertex;
  vertices_.insert(corners.begin(), corners.end());
  centroids_.push_back(centroid);
  tiles_.push_back(TileOf(std::ranges::min(corners)));
  return vertex;
}

void CellChanges::SetLabel(const CellKey& corners, uint8_t label) {
  labels_[Sorted(corners)] = label;
  vertices_.insert(corners.begin(), corners.end());
}

std::optional<uint32_t> CellChanges::CentroidOf(const CellKey& corners) const {
  return ValueAt(splits_, corners);
}

std::optional<uint8_t> CellChanges::LabelOf(const CellKey& corners) const {
  return ValueAt(labels_, corners);
}

uint32_t CellChanges::TileOf(uint32_t vertex) const {
  return vertex < blocks_.NumVertices()
             ? blocks_.TileOf(vertex)
             : tiles_[vertex - blocks_.NumVertices()];
}

void CellChanges::Apply(TilePart* part) const {
  std::vector<uint8_t> is_at_change;
  for (const uint32_t id : part->tile.ids) {
    is_at_change.push_back(vertices_.contains(id));
  }
  const std::vector<Tetrahedralization::Cell>& cells =
      part->tile.tetrahedra.cells;
  const auto num_cells = static_cast<uint32_t>(cells.size());
  for (uint32_t cell = 0; cell < num_cells; ++cell) {
    if (std::ranges::all_of(cells[cell].vertices, [&](uint32_t vertex) {
          return vertex == kInfiniteVertex || is_at_change[vertex] != 0;
        })) {
      ApplyTo(cell, part);
    }
  }
}

// And what is made of its parts.
void CellChanges::ApplyTo(uint32_t cell, TilePart* part) const {
  const CellKey corners = part->tile.CornersOf(cell);
  const std::optional<uint32_t> centroid = CentroidOf(corners);
  if (!centroid) {
    part->labels[cell] = LabelOf(corners).value_or(part->labels[cell]);
    return;
  }
  const auto first_new = static_cast<uint32_t>(part->labels.size());
  SplitCell(cell, &part->tile.tetrahedra, nullptr, &part->labels);
  part->tile.ids.push_back(*centroid);
  for (const uint32_t child : {cell, first_new, first_new + 1, first_new + 2}) {
    ApplyTo(child, part);
  }
}

}  // namespace colmap_ext
