#include "tiles/singular_patch.h"

#include <algorithm>
#include <array>
#include <map>
#include <utility>

#include "meshing/singular_vertices.h"

namespace colmap_ext {
namespace {

// A cell of a patch by the plan's vertices, oriented, the first two the lowest.
struct PatchCell {
  CellKey corners;
  uint8_t label = 0;
  bool has_capacities = false;  // which its own tile knows
  std::array<uint32_t, 4> capacities = {0, 0, 0, 0};
  uint32_t source = 0;
  uint32_t sink = 0;
};

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

using Ring = std::unordered_set<uint32_t>;

// Collects cells around vertices from all tiles.
class PatchCollector {
 public:
  PatchCollector(const PlanVertices& plan, const TileParts& parts,
                 const SeamLabels& seam)
      : blocks_(plan.Blocks()), parts_(parts), seam_(seam) {}

  // All singular vertices, ascending.
  std::vector<uint32_t> FindSingular() const {
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

  // Adds all cells at the vertices.
  // \return the vertices with those at the same cells
  Ring AddStars(const Ring& vertices) {
    std::map<uint32_t, std::vector<uint32_t>> by_tile;
    for (const uint32_t id : vertices) {
      if (!is_added_.contains(id)) {
        by_tile[blocks_.TileOf(id)].push_back(id);
      }
    }
    Ring ring = vertices;
    for (const auto& [tile, ids] : by_tile) {
      AddStarsOf(tile, ids);
    }
    is_added_.insert(vertices.begin(), vertices.end());
    for (const auto& [key, cell] : cells_) {
      for (const uint32_t id : key) {
        if (id != kInfiniteVertex) {
          ring.insert(id);
        }
      }
    }
    return ring;
  }

  // In the order of their corners.
  std::vector<PatchCell> Take() {
    AddMissingCapacities();
    std::vector<PatchCell> cells;
    for (auto& [key, cell] : cells_) {
      cells.push_back(cell);
    }
    std::ranges::sort(cells, {}, &PatchCell::corners);
    return cells;
  }

 private:
  void AddStarsOf(uint32_t tile, const std::vector<uint32_t>& ids) {
    const auto part = parts_.ReadPart(tile);
    const FlowCapacities graph = parts_.ReadGraph(tile);
    std::vector<uint8_t> labels = part->labels;
    ApplySeamLabels(seam_, part->tile, &labels);
    std::vector<uint32_t> star;
    for (const uint32_t id : ids) {
      IncidentCells(part->tile.tetrahedra, id - blocks_.FirstVertex(tile),
                    &star);
      for (const uint32_t index : star) {
        AddCell(tile, *part, graph, labels[index], index);
      }
    }
  }

  void AddCell(uint32_t tile, const TilePart& part, const FlowCapacities& graph,
               uint8_t label, uint32_t index) {
    PatchCell cell{part.tile.CornersOf(index), label};
    const CellKey key = Sorted(cell.corners);
    PatchCell& kept = cells_.try_emplace(key, cell).first->second;
    if (kept.has_capacities || blocks_.OwnerOf(key) != tile) {
      return;
    }
    cell.has_capacities = true;
    cell.capacities = graph.capacities[index];
    cell.source = graph.source[index];
    cell.sink = graph.sink[index];
    SortCorners(&cell);
    kept = cell;
  }

  // Reads cells whose own tiles were not asked yet: all around one of their
  // vertices there, of which those that are in the patch count.
  void AddMissingCapacities() {
    std::map<uint32_t, Ring> by_tile;
    for (const auto& [key, cell] : cells_) {
      if (!cell.has_capacities) {
        const uint32_t owner = blocks_.OwnerOf(key);
        by_tile[owner].insert(*std::ranges::find_if(key, [&](uint32_t id) {
          return id != kInfiniteVertex && blocks_.TileOf(id) == owner;
        }));
      }
    }
    for (const auto& [tile, ids] : by_tile) {
      const auto part = parts_.ReadPart(tile);
      const FlowCapacities graph = parts_.ReadGraph(tile);
      std::vector<uint32_t> star;
      for (const uint32_t id : ids) {
        IncidentCells(part->tile.tetrahedra, id - blocks_.FirstVertex(tile),
                      &star);
        for (const uint32_t index : star) {
          const auto found = cells_.find(Sorted(part->tile.CornersOf(index)));
          if (found != cells_.end()) {
            AddCell(tile, *part, graph, found->second.label, index);
          }
        }
      }
    }
  }

  const PlanBlocks& blocks_;
  const TileParts& parts_;
  const SeamLabels& seam_;
  std::unordered_map<CellKey, PatchCell, KeyHash> cells_;
  Ring is_added_;
};

// Connects cells through their facets; the last one is the border.
void ConnectCells(Tetrahedralization* tetrahedra) {
  const auto border = static_cast<uint32_t>(tetrahedra->cells.size());
  std::unordered_map<FacetKey, uint32_t, KeyHash> open;  // arcs
  for (uint32_t index = 0; index < border; ++index) {
    Tetrahedralization::Cell& cell = tetrahedra->cells[index];
    for (uint32_t k = 0; k < 4; ++k) {
      cell.neighbors[k] = border;
      const auto& corners = kFacetCorners[k];
      const FacetKey facet =
          Sorted(FacetKey{cell.vertices[corners[0]], cell.vertices[corners[1]],
                          cell.vertices[corners[2]]});
      const auto [found, is_new] = open.try_emplace(facet, 4 * index + k);
      if (!is_new) {
        const uint32_t arc = found->second;
        cell.neighbors[k] = arc / 4;
        tetrahedra->cells[arc / 4].neighbors[arc % 4] = index;
        open.erase(found);
      }
    }
  }
  tetrahedra->cells.push_back(
      {{kInfiniteVertex, kInfiniteVertex, kInfiniteVertex, kInfiniteVertex},
       {border, border, border, border}});
}

struct Patch {
  Tetrahedralization tetrahedra;
  std::vector<uint32_t> ids;
  FlowCapacities graph;
  std::vector<uint8_t> labels;
};

Patch Assemble(const PlanVertices& plan, const std::vector<PatchCell>& cells) {
  Patch patch;
  for (const PatchCell& cell : cells) {
    for (const uint32_t id : cell.corners) {
      if (id != kInfiniteVertex) {
        patch.ids.push_back(id);
      }
    }
  }
  std::ranges::sort(patch.ids);
  patch.ids.erase(std::unique(patch.ids.begin(), patch.ids.end()),
                  patch.ids.end());
  patch.tetrahedra.points = PositionsOf(plan, patch.ids);
  patch.tetrahedra.vertex_cells.assign(patch.ids.size(), kNoCell);
  for (const PatchCell& cell : cells) {
    const auto index = static_cast<uint32_t>(patch.tetrahedra.cells.size());
    const bool is_finite = cell.corners[2] != kInfiniteVertex &&
                           cell.corners[3] != kInfiniteVertex;
    Tetrahedralization::Cell& added = patch.tetrahedra.cells.emplace_back();
    added.vertices = cell.corners;
    for (uint32_t& vertex : added.vertices) {
      if (vertex != kInfiniteVertex) {
        vertex = static_cast<uint32_t>(
            std::ranges::lower_bound(patch.ids, vertex) - patch.ids.begin());
        uint32_t& first = patch.tetrahedra.vertex_cells[vertex];
        first = is_finite ? std::min(first, index) : first;
      }
    }
    patch.graph.capacities.push_back(cell.capacities);
    patch.graph.source.push_back(cell.source);
    patch.graph.sink.push_back(cell.sink);
    patch.labels.push_back(cell.label);
  }
  ConnectCells(&patch.tetrahedra);
  patch.graph.capacities.push_back({0, 0, 0, 0});
  patch.graph.source.push_back(0);
  patch.graph.sink.push_back(0);
  patch.labels.push_back(1);
  return patch;
}

// Vertices at cells that are not as they were before.
std::unordered_set<uint32_t> ChangedVertices(
    const std::vector<PatchCell>& before, const Patch& patch) {
  std::unordered_set<uint32_t> changed;
  for (size_t i = 0; i < patch.tetrahedra.cells.size(); ++i) {
    const CellKey& vertices = patch.tetrahedra.cells[i].vertices;
    CellKey corners = vertices;
    for (uint32_t& corner : corners) {
      corner = corner == kInfiniteVertex ? corner : patch.ids[corner];
    }
    const bool is_border = i == before.size();
    if (is_border || (i < before.size() && corners == before[i].corners &&
                      patch.labels[i] == before[i].label)) {
      continue;
    }
    for (const uint32_t id : corners) {
      if (id != kInfiniteVertex) {
        changed.insert(id);
      }
    }
    // Of a split cell the corner that the centroid took the place of, too.
    for (size_t k = 0; i < before.size() && k < 4; ++k) {
      if (before[i].corners[k] != kInfiniteVertex) {
        changed.insert(before[i].corners[k]);
      }
    }
  }
  return changed;
}

}  // namespace

SingularPatch FixPatches(const PlanVertices& plan, const TileParts& parts,
                         const SeamLabels& seam, FixingRule rule) {
  PatchCollector collector(plan, parts, seam);
  const std::vector<uint32_t> singular = collector.FindSingular();
  SingularPatch result;
  if (singular.empty()) {
    return result;
  }
  const Ring fixed = collector.AddStars(Ring(singular.begin(), singular.end()));
  collector.AddStars(collector.AddStars(fixed));
  const std::vector<PatchCell> cells = collector.Take();
  Patch patch = Assemble(plan, cells);
  std::vector<uint8_t> is_left;
  for (const uint32_t id : patch.ids) {
    is_left.push_back(!fixed.contains(id));
  }
  result.report = FixSingularVertices(rule, &patch.tetrahedra, &patch.graph,
                                      &patch.labels, is_left);
  const size_t num_vertices = patch.ids.size();
  for (size_t i = num_vertices; i < patch.tetrahedra.points.size(); ++i) {
    patch.ids.push_back(plan.Blocks().NumVertices() +
                        static_cast<uint32_t>(i - num_vertices));
  }
  result.changed = ChangedVertices(cells, patch);
  result.tetrahedra = std::move(patch.tetrahedra);
  result.ids = std::move(patch.ids);
  result.labels = std::move(patch.labels);
  return result;
}

}  // namespace colmap_ext
