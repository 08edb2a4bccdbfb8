#include "tiles/merged_plan.h"

#include <algorithm>

#include "base/index_limit.h"
#include "meshing/cell_splitting.h"

namespace colmap_ext {

uint32_t CellChanges::Split(const CellKey& corners,
                            const Eigen::Vector3f& centroid) {
  const uint32_t vertex =
      ExpectIndexable(blocks_.NumVertices() + centroids_.size() + 1,
                      "vertices") -
      1;
  changes_[Sorted(corners)].centroid = vertex;
  vertices_.insert(corners.begin(), corners.end());
  centroids_.push_back(centroid);
  tiles_.push_back(TileOf(std::ranges::min(corners)));
  return vertex;
}

void CellChanges::SetLabel(const CellKey& corners, uint8_t label) {
  changes_[Sorted(corners)].label = label;
  vertices_.insert(corners.begin(), corners.end());
}

CellChanges::Change CellChanges::Of(const CellKey& corners) const {
  const auto found = changes_.find(Sorted(corners));
  return found != changes_.end() ? found->second : Change();
}

uint32_t CellChanges::TileOf(uint32_t vertex) const {
  return vertex < blocks_.NumVertices()
             ? blocks_.TileOf(vertex)
             : tiles_[vertex - blocks_.NumVertices()];
}

std::vector<Eigen::Vector3f> CellChanges::PositionsOf(
    const std::vector<uint32_t>& ids) const {
  const uint32_t num_vertices = blocks_.NumVertices();
  const auto first_centroid = std::ranges::lower_bound(ids, num_vertices);
  std::vector<Eigen::Vector3f> positions = colmap_ext::PositionsOf(
      seam_.plan(), std::vector<uint32_t>(ids.begin(), first_centroid));
  for (auto id = first_centroid; id != ids.end(); ++id) {
    positions.push_back(centroids_[*id - num_vertices]);
  }
  return positions;
}

TilePart CellChanges::ReadPart(uint32_t tile) const {
  TilePart part = seam_.ReadPart(tile);
  std::vector<uint8_t> is_at_change;
  for (const uint32_t id : part.tile.ids) {
    is_at_change.push_back(vertices_.contains(id));
  }
  const auto& cells = part.tile.tetrahedra.cells;
  const auto num_cells = static_cast<uint32_t>(cells.size());
  for (uint32_t cell = 0; cell < num_cells; ++cell) {
    if (std::ranges::all_of(cells[cell].vertices, [&](uint32_t vertex) {
          return vertex == kInfiniteVertex || is_at_change[vertex] != 0;
        })) {
      ApplyTo(cell, &part);
    }
  }
  return part;
}

// And what is made of its parts.
void CellChanges::ApplyTo(uint32_t cell, TilePart* part) const {
  const auto [centroid, label] = Of(part->tile.CornersOf(cell));
  if (centroid == kNone) {
    part->labels[cell] = label != kNotKnown ? label : part->labels[cell];
    return;
  }
  const auto first_new = static_cast<uint32_t>(part->labels.size());
  SplitCell(cell, &part->tile.tetrahedra, nullptr, &part->labels);
  part->tile.ids.push_back(centroid);
  for (const uint32_t child : {cell, first_new, first_new + 1, first_new + 2}) {
    ApplyTo(child, part);
  }
}

}  // namespace colmap_ext
