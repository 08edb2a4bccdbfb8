#include "tiles/singular_patch.h"

#include <algorithm>
#include <array>
#include <unordered_map>
#include <utility>

#include "tiles/patch_cells.h"

namespace colmap_ext {
namespace {

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
  const Ring fixed = collector.AddRings(singular);
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
