#include "tiles/singular_patch.h"

#include <algorithm>
#include <array>
#include <functional>
#include <numeric>
#include <tuple>
#include <unordered_map>
#include <unordered_set>
#include <utility>

#include <tbb/parallel_sort.h>

#include "tiles/patch_cells.h"

namespace colmap_ext {
namespace {

// The cell beside those that are not there.
constexpr uint32_t kBorder = 0;

// A facet of a cell whose neighbor is not known: by its vertices, and four
// times the cell plus the corner opposite to it.
struct OpenFacet {
  FacetKey key;
  uint32_t arc;

  bool operator<(const OpenFacet& other) const {
    return std::tie(key, arc) < std::tie(other.key, other.arc);
  }
};

FacetKey FacetOf(const Tetrahedralization::Cell& cell, uint32_t k) {
  const auto& corners = kFacetCorners[k];
  return Sorted(FacetKey{cell.vertices[corners[0]], cell.vertices[corners[1]],
                         cell.vertices[corners[2]]});
}

// Cells of a plan that become ever more while their singular vertices are
// fixed.
class GrowingPatch {
 public:
  GrowingPatch(const PlanVertices& plan, const TileParts& parts,
               const SeamLabels& seam)
      : plan_(plan), collector_(plan, parts, seam) {
    AddCell(
        {kInfiniteVertex, kInfiniteVertex, kInfiniteVertex, kInfiniteVertex},
        {}, 1);
  }

  // \return the report, where any vertex is singular
  FixingReport Fix(FixingRule rule) {
    const std::vector<uint32_t> ids = collector_.FindSingular();
    if (ids.empty()) {
      return {};
    }
    Add(ids);
    PartialComplex partial;
    for (const uint32_t id : ids) {
      partial.singular.push_back(places_.at(id));
    }
    partial.complete = [this](const std::vector<uint32_t>& vertices) {
      Complete(vertices);
    };
    const FixingReport report =
        FixSingularVertices(rule, &tetrahedra_, &graph_, &labels_, &partial);
    NameCentroids();
    return report;
  }

  // To be called last.
  SingularPatch Take() {
    SingularPatch patch;
    patch.changed = ChangedVertices();
    SortVertices();
    patch.tetrahedra = std::move(tetrahedra_);
    patch.ids = std::move(ids_);
    patch.labels = std::move(labels_);
    return patch;
  }

 private:
  // A cell as its tile has it.
  struct Original {
    uint32_t cell;
    CellKey corners;  // the plan's
    uint8_t label;
  };

  // Adds what is missing around some vertices. All is there around centroids:
  // cells are split at vertices that are complete.
  void Complete(const std::vector<uint32_t>& vertices) {
    NameCentroids();
    std::vector<uint32_t> ids;
    for (const uint32_t vertex : vertices) {
      if (ids_[vertex] < plan_.Blocks().NumVertices() &&
          is_complete_[vertex] == 0) {
        ids.push_back(ids_[vertex]);
      }
    }
    if (!ids.empty()) {
      Add(ids);
    }
  }

  void Add(const std::vector<uint32_t>& ids) {
    const std::vector<PatchCell> cells = collector_.Take(ids);
    AddVertices(cells);
    for (const uint32_t id : ids) {
      is_complete_[places_.at(id)] = 1;
    }
    const auto first = static_cast<uint32_t>(tetrahedra_.cells.size());
    for (const PatchCell& cell : cells) {
      originals_.push_back(
          {static_cast<uint32_t>(labels_.size()), cell.corners, cell.label});
      CellKey corners = cell.corners;
      for (uint32_t& corner : corners) {
        corner = corner == kInfiniteVertex ? corner : places_.at(corner);
      }
      AddCell(corners, cell, cell.label);
    }
    Connect(first);
  }

  // Ids for vertices that splitting has appended.
  void NameCentroids() {
    while (ids_.size() < tetrahedra_.points.size()) {
      ids_.push_back(plan_.Blocks().NumVertices() + num_centroids_++);
      is_complete_.push_back(1);
    }
  }

  void AddVertices(const std::vector<PatchCell>& cells) {
    std::vector<uint32_t> added;
    for (const PatchCell& cell : cells) {
      for (const uint32_t id : cell.corners) {
        if (id != kInfiniteVertex && places_.try_emplace(id, 0).second) {
          added.push_back(id);
        }
      }
    }
    std::ranges::sort(added);
    for (const uint32_t id : added) {
      places_[id] = static_cast<uint32_t>(ids_.size());
      ids_.push_back(id);
    }
    const std::vector<Eigen::Vector3f> positions = PositionsOf(plan_, added);
    tetrahedra_.points.insert(tetrahedra_.points.end(), positions.begin(),
                              positions.end());
    tetrahedra_.vertex_cells.resize(ids_.size(), kNoCell);
    is_complete_.resize(ids_.size(), 0);
  }

  void AddCell(const CellKey& vertices, const PatchCell& cell, uint8_t label) {
    const auto index = static_cast<uint32_t>(tetrahedra_.cells.size());
    tetrahedra_.cells.push_back(
        {vertices, {kBorder, kBorder, kBorder, kBorder}});
    for (const uint32_t vertex : vertices) {
      if (vertex != kInfiniteVertex &&
          tetrahedra_.vertex_cells[vertex] == kNoCell) {
        tetrahedra_.vertex_cells[vertex] = index;
      }
    }
    graph_.capacities.push_back(cell.capacities);
    graph_.source.push_back(cell.source);
    graph_.sink.push_back(cell.sink);
    labels_.push_back(label);
  }

  // Connects new cells with each other and with the others.
  void Connect(uint32_t first_new) {
    std::vector<OpenFacet> facets;
    auto& cells = tetrahedra_.cells;
    for (uint32_t cell = first_new; cell < cells.size(); ++cell) {
      for (uint32_t k = 0; k < 4; ++k) {
        facets.push_back({FacetOf(cells[cell], k), 4 * cell + k});
      }
    }
    tbb::parallel_sort(facets);
    size_t num_open = 0;
    for (size_t i = 0; i < facets.size(); ++i) {
      if (i + 1 < facets.size() && facets[i].key == facets[i + 1].key) {
        Join(facets[i].arc, facets[i + 1].arc);
        ++i;
      } else {
        facets[num_open++] = facets[i];
      }
    }
    facets.resize(num_open);
    for (uint32_t cell = kBorder + 1; cell < first_new; ++cell) {
      for (uint32_t k = 0; k < 4; ++k) {
        if (cells[cell].neighbors[k] != kBorder) {
          continue;
        }
        const FacetKey key = FacetOf(cells[cell], k);
        const auto found =
            std::ranges::lower_bound(facets, key, {}, &OpenFacet::key);
        if (found != facets.end() && found->key == key) {
          Join(4 * cell + k, found->arc);
        }
      }
    }
  }

  void Join(uint32_t a, uint32_t b) {
    tetrahedra_.cells[a / 4].neighbors[a % 4] = b / 4;
    tetrahedra_.cells[b / 4].neighbors[b % 4] = a / 4;
  }

  CellKey CornersOf(uint32_t cell) const {
    CellKey corners = tetrahedra_.cells[cell].vertices;
    for (uint32_t& corner : corners) {
      corner = corner == kInfiniteVertex ? corner : ids_[corner];
    }
    return corners;
  }

  // Vertices at cells that are not as their tiles have them.
  std::unordered_set<uint32_t> ChangedVertices() const {
    std::unordered_set<uint32_t> changed;
    const auto insert = [&](const CellKey& corners) {
      changed.insert(corners.begin(), corners.end());
    };
    auto original = originals_.begin();
    for (uint32_t cell = kBorder + 1; cell < labels_.size(); ++cell) {
      const CellKey corners = CornersOf(cell);
      if (original == originals_.end() || original->cell != cell) {
        insert(corners);
        continue;
      }
      if (corners != original->corners || labels_[cell] != original->label) {
        insert(corners);
        insert(original->corners);
      }
      ++original;
    }
    changed.erase(kInfiniteVertex);
    return changed;
  }

  // In the order of their ids.
  void SortVertices() {
    std::vector<uint32_t> order(ids_.size());
    std::iota(order.begin(), order.end(), 0);
    std::ranges::sort(order, {}, [this](uint32_t i) { return ids_[i]; });
    std::vector<uint32_t> numbers(order.size());
    Tetrahedralization sorted;
    std::vector<uint32_t> ids;
    for (uint32_t i = 0; i < order.size(); ++i) {
      numbers[order[i]] = i;
      ids.push_back(ids_[order[i]]);
      sorted.points.push_back(tetrahedra_.points[order[i]]);
      sorted.vertex_cells.push_back(tetrahedra_.vertex_cells[order[i]]);
    }
    sorted.cells = std::move(tetrahedra_.cells);
    for (Tetrahedralization::Cell& cell : sorted.cells) {
      for (uint32_t& vertex : cell.vertices) {
        vertex = vertex == kInfiniteVertex ? vertex : numbers[vertex];
      }
    }
    tetrahedra_ = std::move(sorted);
    ids_ = std::move(ids);
  }

  const PlanVertices& plan_;
  PatchCollector collector_;
  Tetrahedralization tetrahedra_;
  FlowCapacities graph_;
  std::vector<uint8_t> labels_;
  std::vector<uint32_t> ids_;         // [V] the plan's
  std::vector<uint8_t> is_complete_;  // [V] 1: Complete() has nothing to add
  std::vector<Original> originals_;   // ascending in cells
  std::unordered_map<uint32_t, uint32_t> places_;  // vertices of the plan's
  uint32_t num_centroids_ = 0;
};

}  // namespace

SingularPatch FixPatches(const PlanVertices& plan, const TileParts& parts,
                         const SeamLabels& seam, FixingRule rule) {
  GrowingPatch growing(plan, parts, seam);
  const FixingReport report = growing.Fix(rule);
  SingularPatch patch = growing.Take();
  patch.report = report;
  return patch;
}

}  // namespace colmap_ext
