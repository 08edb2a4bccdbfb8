#include "tiles/tile_cut.h"

#include <limits>

#include <tbb/parallel_for.h>
#include <tbb/parallel_sort.h>

#include "spatial/facet_tree.h"
#include "tiles/ray_mask.h"

namespace colmap_ext {
namespace {

uint32_t Clamp(uint32_t capacity) { return std::min(capacity, kMaxCapacity); }

// The graph of the part with free space beyond: the arcs from there are those
// of the source.
FlowCapacities WithFreeSpaceBeyond(NeighborView neighbors,
                                   const FlowCapacities& graph,
                                   const std::vector<CellPlace>& places) {
  FlowCapacities part = graph;
  tbb::parallel_for(size_t{0}, graph.size(), [&](size_t node) {
    if (places[node] == CellPlace::kBeyond) {
      part[node] = {};
      return;
    }
    for (uint32_t k = 0; k < 4; ++k) {
      const uint32_t other = neighbors[node][k];
      if (places[other] == CellPlace::kBeyond) {
        const uint32_t back =
            PlaceOf(static_cast<uint32_t>(node), neighbors[other]);
        part[node].source =
            Clamp(part[node].source) + Clamp(graph[other].arcs[back]);
        part[node].arcs[k] = 0;
      }
    }
  });
  return part;
}

// Nodes of the part within some rings of the shared ones; -1: all.
std::vector<uint8_t> Band(NeighborView neighbors,
                          const std::vector<CellPlace>& places, int rings) {
  std::vector<uint8_t> is_band(places.size(), 0);
  std::vector<uint32_t> front;
  for (uint32_t node = 0; node < places.size(); ++node) {
    if (places[node] == CellPlace::kShared ||
        (rings < 0 && places[node] == CellPlace::kInner)) {
      is_band[node] = 1;
      front.push_back(node);
    }
  }
  for (int ring = 0; ring < rings; ++ring) {
    std::vector<uint32_t> next;
    for (const uint32_t node : front) {
      for (const uint32_t other : neighbors[node]) {
        if (places[other] == CellPlace::kInner && is_band[other] == 0) {
          is_band[other] = 1;
          next.push_back(other);
        }
      }
    }
    front.swap(next);
  }
  return is_band;
}

// A node is certainly matter if it is matter even when all nodes beyond the
// part are free space: then it is matter in the minimum cut of the whole graph,
// too, as free space grows with free space around it [Gallo1989]. The opposite
// test is of little use: the votes for free space come along the rays from the
// cameras, which are beyond most parts.
//
// All other nodes of the part are not known within some rings of nodes around
// those that are shared, and further inside have the label of the minimum cut
// of the given graph, which continues beyond the part, but coarsely.
//
// \param graph   complete for the arcs from and to the nodes of the part
// \param places  [N]
// \param rings   -1: all nodes that are not certainly matter are unknown
PartLabels LabelPart(NeighborView neighbors, const FlowCapacities& graph,
                     const std::vector<CellPlace>& places, int rings) {
  PartLabels labels;
  labels.guesses = ComputeMinCut(neighbors, graph).on_source_side;
  labels.known = labels.guesses;
  if (std::ranges::find(places, CellPlace::kBeyond) == places.end()) {
    return labels;
  }
  const std::vector<uint8_t> most =
      ComputeMinCut(neighbors, WithFreeSpaceBeyond(neighbors, graph, places))
          .on_source_side;
  const std::vector<uint8_t> is_band = Band(neighbors, places, rings);
  for (size_t node = 0; node < places.size(); ++node) {
    const bool is_sure = most[node] == 0;
    if (places[node] == CellPlace::kBeyond ||
        (!is_sure && is_band[node] != 0)) {
      labels.known[node] = kNotKnown;
    } else if (is_sure) {
      labels.known[node] = kMatter;
    }
  }
  return labels;
}

// Vertices of other tiles whose rays are walked at a time.
constexpr size_t kBatchVertices = 1 << 16;

// [cells], see TileCut
std::vector<CellPlace> PlacesOf(const TileTetrahedra& tile, uint32_t home,
                                const PlanBlocks& blocks) {
  std::vector<CellPlace> places;
  const auto& cells = tile.tetrahedra.cells;
  for (uint32_t cell = 0; cell < cells.size(); ++cell) {
    int num_own = 0;
    int num_others = 0;
    for (const uint32_t vertex : cells[cell].vertices) {
      num_own += vertex < tile.num_own;
      num_others += vertex >= tile.num_own && vertex != kInfiniteVertex;
    }
    const bool is_own =
        num_own > 0 &&
        (num_others == 0 || blocks.OwnerOf(tile.CornersOf(cell)) == home);
    places.push_back(!is_own           ? CellPlace::kBeyond
                     : num_others == 0 ? CellPlace::kInner
                                       : CellPlace::kShared);
  }
  return places;
}

// Rays that may pass through a tile's cells.
class RayFilter {
 public:
  RayFilter(const PlanBlocks& blocks, const TileTetrahedra& tile,
            const std::vector<CellPlace>& places,
            const std::vector<Eigen::Vector3d>& centers,
            const VisibilityWeightOptions& options)
      : blocks_(blocks),
        centers_(centers),
        behind_(options.behind_sigma * options.distance_sigma),
        mask_(BoundsOf(blocks)) {
    const Tetrahedralization& tetrahedra = tile.tetrahedra;
    tbb::parallel_for(size_t{0}, tetrahedra.cells.size(), [&](size_t i) {
      if (places[i] == CellPlace::kBeyond) {
        return;
      }
      std::vector<Eigen::Vector3d> corners;
      for (const uint32_t vertex : tetrahedra.cells[i].vertices) {
        if (vertex != kInfiniteVertex) {
          corners.push_back(tetrahedra.PositionOf(vertex));
        }
      }
      mask_.Mark(corners);
    });
    mask_.Finish();
  }

  // Whether any ray of a block may.
  bool MayPass(uint32_t block) const {
    const Eigen::AlignedBox3d box =
        GrowBox(blocks_.boxes[block].cast<double>(), behind_);
    // Behind ends rays go on to the hull.
    return blocks_.have_ends[block] != 0 ||
           std::ranges::any_of(blocks_.views[block], [&](uint32_t view) {
             return mask_.MayTouch(
                 box.merged(Eigen::AlignedBox3d(centers_[view])));
           });
  }

  // Appends a row with the rays of a vertex that may.
  void Append(const Observations& from, size_t row,
              const Eigen::Vector3f& position, Observations* to) const {
    const Eigen::Vector3d place = position.cast<double>();
    for (const Observation& observation : from[row]) {
      const Eigen::Vector3d& center = centers_[observation.view];
      const Eigen::Vector3d way = place - center;
      const double length = from.IsEnd(row)
                                ? std::numeric_limits<double>::infinity()
                                : way.norm() + behind_;
      if (mask_.MayPass(center, way.normalized(), length)) {
        to->values.push_back(observation);
      }
    }
    to->EndRow();
    to->is_end.push_back(from.IsEnd(row));
  }

 private:
  static Eigen::AlignedBox3d BoundsOf(const PlanBlocks& blocks) {
    Eigen::AlignedBox3f bounds;
    for (const Eigen::AlignedBox3f& box : blocks.boxes) {
      bounds.extend(box);
    }
    return bounds.cast<double>();
  }

  const PlanBlocks& blocks_;
  const std::vector<Eigen::Vector3d>& centers_;
  double behind_;
  RayMask mask_;
};

// Adds the votes of a plan to a tile's graph.
class TileVotes {
 public:
  TileVotes(const PlanVertices& plan, const TileTetrahedra& tile,
            const std::vector<CellPlace>& places,
            const std::vector<Eigen::Vector3d>& centers,
            const VisibilityWeightOptions& options, FlowCapacities* graph)
      : plan_(plan),
        blocks_(plan.Blocks()),
        tile_(tile),
        centers_(centers),
        options_(options),
        filter_(blocks_, tile, places, centers, options),
        graph_(graph) {}

  RayReport Run(const Progress& progress) {
    AddVertices(progress);
    for (uint32_t block = 0; block < blocks_.NumBlocks(); ++block) {
      if (filter_.MayPass(block)) {
        AddBlock(block);
      }
      if (observations_.size() >= kBatchVertices) {
        AddBatch();
      }
    }
    AddBatch();
    return report_;
  }

 private:
  // The rays of the tile's vertices, block by block as their ids follow.
  void AddVertices(const Progress& progress) {
    Observations observations;
    Observations of_block;
    uint32_t block = kNone;
    for (size_t i = 0; i < tile_.ids.size(); ++i) {
      const uint32_t id = tile_.ids[i];
      if (block == kNone || id < blocks_.begins[block] ||
          id >= blocks_.begins[block + 1]) {
        block = blocks_.BlockOf(id);
        of_block = plan_.ReadObservations(blocks_.begins[block],
                                          blocks_.begins[block + 1]);
      }
      filter_.Append(of_block, id - blocks_.begins[block],
                     tile_.tetrahedra.points[i], &observations);
    }
    report_ += AddVisibilityWeights(tile_.tetrahedra, observations, centers_,
                                    options_, graph_, progress);
  }

  // Collects the rays of vertices that are not the tile's.
  void AddBlock(uint32_t block) {
    const uint32_t begin = blocks_.begins[block];
    const uint32_t end = blocks_.begins[block + 1];
    if (IsVertex(begin) && begin < end &&
        NumVertices(begin, end) == end - begin) {
      return;
    }
    const std::vector<Eigen::Vector3f> positions =
        plan_.ReadPositions(begin, end);
    const Observations of_block = plan_.ReadObservations(begin, end);
    for (uint32_t id = begin; id < end; ++id) {
      if (IsVertex(id)) {
        continue;
      }
      const size_t num_before = observations_.values.size();
      filter_.Append(of_block, id - begin, positions[id - begin],
                     &observations_);
      if (observations_.values.size() > num_before) {
        observations_.points.push_back(positions[id - begin]);
      } else {
        observations_.offsets.pop_back();
        observations_.is_end.pop_back();
      }
    }
  }

  void AddBatch() {
    report_ += AddVisibilityWeights(tile_.tetrahedra, observations_, centers_,
                                    options_, graph_);
    observations_ = {};
  }

  bool IsVertex(uint32_t id) const { return NumVertices(id, id + 1) == 1; }

  // How many of a range of ids are vertices of the tile.
  size_t NumVertices(uint32_t begin, uint32_t end) const {
    const auto count = [&](size_t first, size_t last) {
      const auto from = tile_.ids.begin() + static_cast<ptrdiff_t>(first);
      const auto to = tile_.ids.begin() + static_cast<ptrdiff_t>(last);
      return static_cast<size_t>(std::lower_bound(from, to, end) -
                                 std::lower_bound(from, to, begin));
    };
    return count(0, tile_.num_own) + count(tile_.num_own, tile_.ids.size());
  }

  const PlanVertices& plan_;
  const PlanBlocks& blocks_;
  const TileTetrahedra& tile_;
  const std::vector<Eigen::Vector3d>& centers_;
  const VisibilityWeightOptions& options_;
  RayFilter filter_;
  FlowCapacities* graph_;
  RayReport report_;
  Observations observations_;  // of the batch, by points
};

UnknownCell UnknownOf(const TileCut& cut, uint32_t cell) {
  const Tetrahedralization& tetrahedra = cut.tile.tetrahedra;
  const CellKey corners = cut.tile.CornersOf(cell);
  std::array<uint32_t, 4> order = {0, 1, 2, 3};
  std::ranges::sort(order, {}, [&](uint32_t k) { return corners[k]; });
  UnknownCell unknown;
  unknown.source = std::min(cut.graph[cell].source, kMaxCapacity);
  unknown.sink = std::min(cut.graph[cell].sink, kMaxCapacity);
  unknown.guess = cut.labels.guesses[cell];
  for (int i = 0; i < 4; ++i) {
    const uint32_t k = order[i];
    const uint32_t other = tetrahedra.cells[cell].neighbors[k];
    const uint32_t back = tetrahedra.FacetTo(other, cell);
    unknown.key[i] = corners[k];
    unknown.apexes[i] = cut.tile.CornersOf(other)[back];
    unknown.labels[i] = cut.places[other] != CellPlace::kBeyond
                            ? cut.labels.known[other]
                            : kOutside;
    unknown.out[i] = std::min(cut.graph[cell].arcs[k], kMaxCapacity);
    unknown.back[i] = std::min(cut.graph[other].arcs[back], kMaxCapacity);
  }
  return unknown;
}

}  // namespace

TileCut CutTile(const PlanVertices& plan, uint32_t tile,
                const std::vector<Eigen::Vector3d>& centers,
                const TileCutOptions& options, const Progress& progress) {
  TileCut result;
  result.tile = CertifyTile(plan, tile, progress);
  const Tetrahedralization& tetrahedra = result.tile.tetrahedra;
  result.places = PlacesOf(result.tile, tile, plan.Blocks());
  Report(progress, "Weighing facets", 0);
  result.graph = ZeroCapacities(tetrahedra);
  AddQualityWeights(tetrahedra, options.quality_regularization, &result.graph);
  VisibilityWeightOptions rays = options.rays;
  rays.inner_place = plan.Blocks().Center();
  result.rays =
      TileVotes(plan, result.tile, result.places, centers, rays, &result.graph)
          .Run(progress);
  Report(progress, "Cutting the graph", 0);
  result.labels = LabelPart(NeighborsOf(tetrahedra), result.graph,
                            result.places, options.seam_rings);
  return result;
}

TileSeam SeamOf(const TileCut& cut) {
  TileSeam seam;
  for (uint32_t cell = 0; cell < cut.places.size(); ++cell) {
    if (cut.places[cell] == CellPlace::kBeyond) {
      continue;
    }
    if (cut.labels.known[cell] == kNotKnown) {
      seam.unknown.push_back(UnknownOf(cut, cell));
    } else if (cut.places[cell] == CellPlace::kShared) {
      seam.shared.push_back(
          {Sorted(cut.tile.CornersOf(cell)), cut.labels.known[cell]});
    }
  }
  tbb::parallel_sort(
      seam.unknown.begin(), seam.unknown.end(),
      [](const UnknownCell& a, const UnknownCell& b) { return a.key < b.key; });
  std::ranges::sort(seam.shared, {}, &SharedCell::key);
  return seam;
}

}  // namespace colmap_ext
