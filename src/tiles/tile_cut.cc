#include "tiles/tile_cut.h"

#include <algorithm>
#include <utility>

#include <tbb/parallel_for.h>

#include "delaunay/cell_graph.h"
#include "delaunay/cell_part.h"
#include "delaunay/part_votes.h"
#include "delaunay/quality_weights.h"
#include "delaunay/ray_walk.h"
#include "tiles/ray_mask.h"
#include "tiles/tile_labels.h"

namespace colmap_ext {
namespace {

// Points whose rays are walked at a time.
constexpr size_t kBatchPoints = 1 << 16;

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
          corners.push_back(tetrahedra.points[vertex].cast<double>());
        }
      }
      mask_.Mark(corners);
    });
    mask_.Finish();
  }

  // Whether any ray of a block may.
  bool MayPass(uint32_t block) const {
    const Eigen::AlignedBox3d box = Grown(blocks_.boxes[block]);
    return std::ranges::any_of(blocks_.views[block], [&](uint32_t view) {
      return mask_.MayTouch(box.merged(Eigen::AlignedBox3d(centers_[view])));
    });
  }

  // Appends the rays of a vertex that may to the observations' last row.
  void Append(const Observations& from, size_t row,
              const Eigen::Vector3f& position, Observations* to) const {
    const Eigen::Vector3d place = position.cast<double>();
    for (uint64_t k = from.offsets[row]; k < from.offsets[row + 1]; ++k) {
      const Eigen::Vector3d& center = centers_[from.views[k]];
      const Eigen::Vector3d end =
          place + behind_ * (place - center).normalized();
      if (mask_.MayCross(center, end)) {
        to->views.push_back(from.views[k]);
        to->alphas.push_back(from.alphas[k]);
      }
    }
  }

 private:
  static Eigen::AlignedBox3d BoundsOf(const PlanBlocks& blocks) {
    Eigen::AlignedBox3f bounds;
    for (const Eigen::AlignedBox3f& box : blocks.boxes) {
      bounds.extend(box);
    }
    return {bounds.min().cast<double>(), bounds.max().cast<double>()};
  }

  Eigen::AlignedBox3d Grown(const Eigen::AlignedBox3f& box) const {
    const Eigen::Vector3d margin = Eigen::Vector3d::Constant(behind_);
    return {box.min().cast<double>() - margin,
            box.max().cast<double>() + margin};
  }

  const PlanBlocks& blocks_;
  const std::vector<Eigen::Vector3d>& centers_;
  double behind_;
  RayMask mask_;
};

CellPart PartOf(const TileTetrahedra& tile,
                const std::vector<CellPlace>& places) {
  std::vector<uint8_t> is_inside;
  for (const CellPlace place : places) {
    is_inside.push_back(place != CellPlace::kBeyond);
  }
  return {tile.tetrahedra, std::move(is_inside)};
}

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
        filter_(blocks_, tile, places, centers, options),
        part_(PartOf(tile, places)),
        votes_(tile.tetrahedra, part_, centers, options, graph) {}

  RayReport Run(const Progress& progress) {
    RayReport report;
    for (uint32_t block = 0; block < blocks_.NumBlocks(); ++block) {
      if (filter_.MayPass(block)) {
        AddBlock(block);
      }
      if (points_.size() >= kBatchPoints || block + 1 == blocks_.NumBlocks()) {
        report += votes_.Add(points_);
        points_ = {};
        Report(progress, kWalkingStage,
               static_cast<double>(block + 1) /
                   static_cast<double>(blocks_.NumBlocks()));
      }
    }
    return report;
  }

 private:
  // Collects the rays of a block's vertices.
  void AddBlock(uint32_t block) {
    const uint32_t begin = blocks_.begins[block];
    const uint32_t end = blocks_.begins[block + 1];
    const std::vector<Eigen::Vector3f> positions =
        plan_.ReadPositions(begin, end);
    const Observations of_block = plan_.ReadObservations(begin, end);
    for (uint32_t id = begin; id < end; ++id) {
      const size_t num_before = points_.observations.size();
      filter_.Append(of_block, id - begin, positions[id - begin],
                     &points_.observations);
      if (points_.observations.size() > num_before) {
        points_.observations.offsets.push_back(points_.observations.size());
        points_.positions.push_back(positions[id - begin]);
        points_.vertices.push_back(VertexOf(id));
      }
    }
  }

  // The tile's vertex, or kNoVertex.
  uint32_t VertexOf(uint32_t id) const {
    const auto own_end = tile_.ids.begin() + tile_.num_own;
    auto found = std::lower_bound(tile_.ids.begin(), own_end, id);
    if (found == own_end || *found != id) {
      found = std::lower_bound(own_end, tile_.ids.end(), id);
    }
    return found != tile_.ids.end() && *found == id
               ? static_cast<uint32_t>(found - tile_.ids.begin())
               : kNoVertex;
  }

  const PlanVertices& plan_;
  const PlanBlocks& blocks_;
  const TileTetrahedra& tile_;
  RayFilter filter_;
  const CellPart part_;
  PartVotes votes_;
  PartPoints points_;  // of a batch
};

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

}  // namespace colmap_ext
