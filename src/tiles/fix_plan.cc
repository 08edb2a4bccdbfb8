#include "tiles/merged_plan.h"

#include <algorithm>
#include <functional>
#include <set>
#include <unordered_map>
#include <vector>

#include <tbb/parallel_sort.h>

#include "base/indices.h"
#include "meshing/singular_vertices.h"
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

  // NOLINTNEXTLINE(modernize-use-nullptr): there is no pointer here.
  auto operator<=>(const OpenFacet&) const = default;
};

// Cells of a plan that become ever more while some of its singular vertices are
// fixed.
class GrowingPatch {
 public:
  // \param changes  before, and then after
  explicit GrowingPatch(CellChanges* changes)
      : num_plan_vertices_(changes->seam().plan().Blocks().NumVertices()),
        collector_(changes->seam()),
        changes_(*changes),
        first_new_centroid_(num_plan_vertices_ +
                            static_cast<uint32_t>(changes->NumCentroids())) {
    AppendCell(
        {kInfiniteVertex, kInfiniteVertex, kInfiniteVertex, kInfiniteVertex},
        {}, 1);
  }

  // \param singular  the plan's vertices, ascending
  // \param is_examined  whether one would be singular only if it is among them
  // \param left  singular vertices that groups have left; kept up to date
  FixingReport Fix(FixingRule rule, const std::vector<uint32_t>& singular,
                   const std::function<bool(uint32_t)>& is_examined,
                   std::set<uint32_t>* left) {
    Add(singular);
    PartialComplex partial;
    for (const uint32_t id : singular) {
      partial.singular.push_back(places_.at(id));
    }
    partial.is_examined = [&](uint32_t vertex) {
      return vertex >= ids_.size() || ids_[vertex] >= first_new_centroid_ ||
             is_examined(ids_[vertex]);
    };
    partial.complete = [this](const std::vector<uint32_t>& vertices) {
      Complete(vertices);
    };
    partial.split = [this](uint32_t cell) {
      NameCentroid();
      split_ = CornersOf(cell);
    };
    const FixingReport report =
        FixSingularVertices(rule, &tetrahedra_, &graph_, &labels_, &partial);
    NameCentroid();
    for (const uint32_t vertex : TakeOverLabels()) {
      left->erase(vertex);
    }
    for (const uint32_t vertex : partial.singular) {
      left->insert(ids_[vertex]);
    }
    return report;
  }

 private:
  // A cell as it was added.
  struct Original {
    uint32_t cell;
    CellKey corners;  // the plan's
    uint8_t label;
  };

  // Loads all missing cells around some vertices. Those around centroids are
  // complete, as cells are split only at complete vertices.
  void Complete(const std::vector<uint32_t>& vertices) {
    NameCentroid();
    std::vector<uint32_t> ids;
    for (const uint32_t vertex : vertices) {
      if (ids_[vertex] < num_plan_vertices_ && is_complete_[vertex] == 0) {
        ids.push_back(ids_[vertex]);
      }
    }
    if (!ids.empty()) {
      Add(ids);
    }
  }

  void Add(const std::vector<uint32_t>& ids) {
    std::vector<PatchCell> cells;
    for (const PatchCell& cell : collector_.Take(ids)) {
      AppendParts(cell, &cells);
    }
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
      AppendCell(corners, cell.capacities, cell.label);
    }
    Connect(first);
  }

  // Appends a cell, or what it has been split into.
  void AppendParts(const PatchCell& cell, std::vector<PatchCell>* cells) const {
    const auto [centroid, label] = changes_.Of(cell.corners);
    if (centroid == kNone) {
      cells->push_back(cell);
      cells->back().label = label != kNotKnown ? label : cell.label;
      return;
    }
    for (int i = 0; i < 4; ++i) {
      PatchCell part = cell;
      part.corners[i] = centroid;
      part.capacities = PartOf(cell.capacities, i);
      AppendParts(part, cells);
    }
  }

  // The vertex that splitting has appended, if any.
  void NameCentroid() {
    if (ids_.size() < tetrahedra_.points.size()) {
      ids_.push_back(changes_.Split(split_, tetrahedra_.points.back()));
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
    Append(changes_.PositionsOf(added), &tetrahedra_.points);
    tetrahedra_.vertex_cells.resize(ids_.size(), kNone);
    is_complete_.resize(ids_.size(), 0);
  }

  void AppendCell(const CellKey& vertices, const NodeCapacities& capacities,
                  uint8_t label) {
    const auto index = static_cast<uint32_t>(tetrahedra_.cells.size());
    tetrahedra_.cells.push_back(
        {vertices, {kBorder, kBorder, kBorder, kBorder}});
    for (const uint32_t vertex : vertices) {
      if (vertex != kInfiniteVertex &&
          tetrahedra_.vertex_cells[vertex] == kNone) {
        tetrahedra_.vertex_cells[vertex] = index;
      }
    }
    graph_.push_back(capacities);
    labels_.push_back(label);
  }

  // Connects new cells with each other and with the others.
  void Connect(uint32_t first_new) {
    std::vector<OpenFacet> facets;
    auto& cells = tetrahedra_.cells;
    for (uint32_t cell = first_new; cell < cells.size(); ++cell) {
      for (uint32_t k = 0; k < 4; ++k) {
        facets.push_back({Sorted(FacetVertices(cells[cell], k)), 4 * cell + k});
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
        const FacetKey key = Sorted(FacetVertices(cells[cell], k));
        const uint32_t found = IndexOf(facets, key, &OpenFacet::key);
        if (found != kNone) {
          Join(4 * cell + k, facets[found].arc);
        }
      }
    }
  }

  void Join(uint32_t a, uint32_t b) {
    tetrahedra_.cells[a / 4].neighbors[a % 4] = b / 4;
    tetrahedra_.cells[b / 4].neighbors[b % 4] = a / 4;
  }

  CellKey CornersOf(uint32_t cell) const {
    return IdsOf(tetrahedra_.cells[cell].vertices, ids_);
  }

  // Tells the changes about cells that are not as they were added.
  // \return their vertices
  std::vector<uint32_t> TakeOverLabels() {
    std::vector<uint32_t> vertices;
    auto original = originals_.begin();
    for (uint32_t cell = kBorder + 1; cell < labels_.size(); ++cell) {
      const CellKey corners = CornersOf(cell);
      const bool is_original =
          original != originals_.end() && original->cell == cell;
      if (!is_original || corners != original->corners ||
          labels_[cell] != original->label) {
        changes_.SetLabel(corners, labels_[cell]);
        Append(corners, &vertices);
      }
      if (is_original) {
        ++original;
      }
    }
    return vertices;
  }

  const uint32_t num_plan_vertices_;
  PatchCollector collector_;
  CellChanges& changes_;
  uint32_t first_new_centroid_;
  Tetrahedralization tetrahedra_;
  FlowCapacities graph_;
  std::vector<uint8_t> labels_;
  std::vector<uint32_t> ids_;         // [V] the plan's, or of centroids
  std::vector<uint8_t> is_complete_;  // [V] 1: Complete() has nothing to add
  std::vector<Original> originals_;   // ascending in cells
  std::unordered_map<uint32_t, uint32_t> places_;  // of ids that were added
  CellKey split_ = {};  // corners of the cell that was split last
};

// Of a tile's own vertices, the plan's, ascending.
std::vector<uint32_t> SingularOf(const TilePart& part) {
  std::vector<uint32_t> singular;
  for (const uint32_t vertex :
       SingularVertices(part.tile.tetrahedra, part.labels)) {
    if (vertex < part.tile.num_own) {
      singular.push_back(part.tile.ids[vertex]);
    }
  }
  return singular;
}

void AddTo(const FixingReport& report, FixingReport* sum) {
  sum->num_singular_raw += report.num_singular_raw;
  sum->num_relabeled_cells += report.num_relabeled_cells;
  sum->num_split_cells += report.num_split_cells;
  sum->num_examined_vertices += report.num_examined_vertices;
}

}  // namespace

FixingReport FixPlan(FixingRule rule, bool at_once, CellChanges* changes,
                     const Progress& progress) {
  const PlanBlocks& blocks = changes->seam().plan().Blocks();
  const auto num_tiles = static_cast<uint32_t>(blocks.NumTiles());
  const uint32_t step = at_once ? num_tiles : 1;
  FixingReport sum;
  std::set<uint32_t> left;
  for (uint32_t first = 0; first < num_tiles; first += step) {
    Report(progress, "Fixing singular vertices",
           static_cast<double>(first) / num_tiles);
    const uint32_t begin = blocks.FirstVertex(first);
    const uint32_t end = blocks.FirstVertex(first + step);
    std::vector<uint32_t> singular;
    for (uint32_t tile = first; tile < first + step; ++tile) {
      Append(SingularOf(changes->ReadPart(tile)), &singular);
    }
    if (!singular.empty()) {
      GrowingPatch patch(changes);
      AddTo(patch.Fix(
                rule, singular,
                [&](uint32_t id) { return id >= begin && id < end; }, &left),
            &sum);
    }
  }
  sum.num_singular_fixed = left.size();
  return sum;
}

}  // namespace colmap_ext
