#include "delaunay/visibility_weights.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <mutex>
#include <span>

#include <tbb/parallel_for.h>

#include "delaunay/ray_walk.h"
#include "spatial/predicates.h"

namespace colmap_ext {
namespace {

constexpr char kStage[] = "Walking rays";

// Sigmas. Beyond them the soft weight differs from one by exp(-12.5) at most,
// 0.015 of the weights' unit: less than a weight is rounded by.
constexpr double kNearSigmas = 5;

// Vertices whose rays are walked by one thread, camera after camera, so that
// neighboring rays find their cells in the cache. Any other number gives the
// same result.
constexpr uint32_t kBlock = 256;

// Rays that are walked together. Their paths fit a core's cache.
constexpr size_t kBatch = 64;

// A position and a cell that holds it, or an infinite one. The cell of a
// camera's centre is that of the centre moved as all targets are
// (RaySideExact), and no cell's index where it lies beyond the hull.
struct Place {
  Eigen::Vector3d position;
  uint32_t cell = kNone;
  bool is_inside = false;  // strictly, or strictly beyond the hull
};

std::vector<Place> LocateCenters(const Tetrahedralization& tetrahedra,
                                 const std::vector<Eigen::Vector3d>& centers) {
  std::vector<Place> located;
  for (const Eigen::Vector3d& center : centers) {
    const uint32_t cell = EnteredCell(
        tetrahedra, Locate(tetrahedra, center, tetrahedra.vertex_cells.front()),
        center, center);
    located.push_back(
        {center, tetrahedra.IsInfinite(cell)
                     ? static_cast<uint32_t>(tetrahedra.cells.size())
                     : cell});
  }
  return located;
}

// Points that are not vertices, each with a cell that it lies in.
std::vector<Place> LocatePoints(const Tetrahedralization& tetrahedra,
                                const std::vector<Eigen::Vector3f>& points) {
  std::vector<Place> located(points.size());
  tbb::parallel_for(size_t{0}, points.size() / kBlock + 1, [&](size_t block) {
    uint32_t hint = tetrahedra.vertex_cells.front();
    const size_t end = std::min(points.size(), (block + 1) * kBlock);
    for (size_t i = block * kBlock; i < end; ++i) {
      const Eigen::Vector3d position = points[i].cast<double>();
      const uint32_t cell = Locate(tetrahedra, position, hint);
      const bool is_infinite = tetrahedra.IsInfinite(cell);
      located[i] = {
          position, cell,
          is_infinite || IsStrictlyInside(tetrahedra, cell, position)};
      hint = is_infinite ? hint : cell;
    }
  });
  return located;
}

// Walks the rays of vertices, or of other points, and counts their votes.
class Voter {
 public:
  // \param places  of the observations' points
  Voter(const Tetrahedralization& tetrahedra, const Observations& observations,
        const std::vector<Place>& places, const std::vector<Place>& centers,
        const VisibilityWeightOptions& options, FlowCapacities* graph)
      : tetrahedra_(tetrahedra),
        observations_(observations),
        places_(places),
        centers_(centers),
        options_(options),
        near_distance_(kNearSigmas * options.distance_sigma),
        normalization_(-0.5 /
                       (options.distance_sigma * options.distance_sigma)),
        graph_(graph) {}

  // \param begin, end  vertices
  void VoteBlock(uint32_t begin, uint32_t end) {
    std::vector<VotingRay> block;
    for (uint32_t vertex = begin; vertex < end; ++vertex) {
      for (const auto& [view, alpha] : observations_[vertex]) {
        block.push_back({vertex, view, alpha});
      }
    }
    std::ranges::stable_sort(block, {}, &VotingRay::view);
    for (size_t i = 0; i < block.size(); i += kBatch) {
      VoteBatch({block.data() + i, std::min(kBatch, block.size() - i)});
    }
  }

  const RayReport& report() const { return report_; }

 private:
  struct VotingRay {
    uint32_t vertex;
    uint32_t view;
    float alpha;
  };

  // \param batch  kBatch rays at most
  void VoteBatch(std::span<const VotingRay> batch) {
    rays_.clear();
    for (const auto& [vertex, view, alpha] : batch) {
      rays_.push_back(
          RayFrom(vertex, centers_[view].position, centers_[view].cell,
                  observations_.IsEnd(vertex) ? 0 : near_distance_));
    }
    WalkRays(tetrahedra_, rays_, front_);
    if (!observations_.are_free) {
      std::ranges::transform(batch, rays_.begin(),
                             std::bind_front(&Voter::RayBehind, this));
      WalkRays(tetrahedra_, rays_, behind_);
    }
    for (size_t i = 0; i < batch.size(); ++i) {
      ++report_.num_rays;
      if (front_[i].end == kNone ||
          (!observations_.are_free && behind_[i].end == kNone)) {
        ++report_.num_lost_rays;
        continue;
      }
      report_.num_steps +=
          front_[i].crossings.size() + behind_[i].crossings.size();
      Vote(batch[i], front_[i], behind_[i]);
    }
  }

  Ray RayFrom(uint32_t vertex, const Eigen::Vector3d& target, uint32_t end,
              double near_distance) const {
    if (places_.empty()) {
      return {vertex, target, end, near_distance};
    }
    const auto& [position, cell, is_inside] = places_[vertex];
    return {
        kNone,
        target,
        end,
        near_distance,
        position,
        is_inside ? cell : EnteredCell(tetrahedra_, cell, position, target)};
  }

  Eigen::Vector3d PositionOf(uint32_t vertex) const {
    return !places_.empty() ? places_[vertex].position
                            : tetrahedra_.PositionOf(vertex);
  }

  // The ray behind the vertex; behind an end it continues to the hull.
  Ray RayBehind(const VotingRay& ray) const {
    const uint32_t vertex = ray.vertex;
    const Eigen::Vector3d& center = centers_[ray.view].position;
    const Eigen::Vector3d position = PositionOf(vertex);
    if (observations_.IsEnd(vertex)) {
      return RayFrom(vertex, 2 * position - center, kToHull, 0);
    }
    const Eigen::Vector3d direction = (position - center).normalized();
    return RayFrom(
        vertex,
        position + options_.behind_sigma * options_.distance_sigma * direction,
        kNone, near_distance_);
  }

  // Where flow is pushed along the ray at once (docs/method.md, section 2.3),
  // from both of its ends towards the point.
  void Vote(const VotingRay& ray, const RayPath& front, const RayPath& behind) {
    const uint32_t weight = ToCapacity(ray.alpha);
    PushAlong(front, ray, &Crossing::exit_arc, &NodeCapacities::source);
    if (observations_.IsEnd(ray.vertex)) {
      for (const Crossing& crossing : behind.crossings) {
        AddToArc(weight, crossing.exit_arc);
      }
    } else if (!observations_.are_free) {
      PushAlong(behind, ray, &Crossing::entry_arc, &NodeCapacities::sink);
    }
  }

  // Adds to the cell where a ray ends. If that is outside the hull of a tile,
  // which differs from the hull of the scene, it adds to each infinite cell
  // that the ray may end in.
  void AddAtEnds(uint32_t weight, const VotingRay& ray, const RayPath& path,
                 uint32_t NodeCapacities::*terminal) {
    if (!options_.inner_place || !places_.empty() || !path.crossings.empty() ||
        !tetrahedra_.IsInfinite(path.end)) {
      AddToTerminal(weight, path.end, terminal);
      return;
    }
    const Eigen::Vector3d target = terminal == &NodeCapacities::source
                                       ? centers_[ray.view].position
                                       : RayBehind(ray).target;
    IncidentCells(tetrahedra_, ray.vertex, &star_);
    for (const uint32_t cell : star_) {
      if (tetrahedra_.IsInfinite(cell) && GoesOver(cell, ray.vertex, target)) {
        AddToTerminal(weight, cell, terminal);
      }
    }
  }

  // Whether the ray from a vertex goes over the facet of an infinite cell, as
  // seen from the inner place. All of them are looked at, as what is the hull
  // here need not be that of all vertices at its other facets.
  bool GoesOver(uint32_t cell, uint32_t vertex,
                const Eigen::Vector3d& target) const {
    // Counter-clockwise seen from outside.
    const std::array<uint32_t, 3> facet = FacetVertices(
        tetrahedra_.cells[cell], tetrahedra_.IndexOf(cell, kInfiniteVertex));
    const auto at =
        static_cast<size_t>(std::ranges::find(facet, vertex) - facet.begin());
    const Eigen::Vector3d origin = PositionOf(vertex);
    const Eigen::Vector3d first = PositionOf(facet[(at + 1) % 3]);
    const Eigen::Vector3d second = PositionOf(facet[(at + 2) % 3]);
    const Eigen::Vector3d& inner = *options_.inner_place;
    return RaySideExact(origin, target, first, inner) > 0 &&
           RaySideExact(origin, target, second, inner) < 0 &&
           RaySideExact(origin, target, first, second) > 0;
  }

  // Pushes flow along the ray at once. The weights of the arcs do not fall from
  // the point outwards, and the last arc, to the terminal, has the whole
  // weight. The flow of each arc becomes capacity of its reverse; what the next
  // arc has more goes to the cell's terminal.
  // \param reverse_arc  of each arc
  // \param terminal  source or sink
  void PushAlong(const RayPath& path, const VotingRay& ray,
                 uint32_t Crossing::*reverse_arc,
                 uint32_t NodeCapacities::*terminal) {
    const uint32_t whole = ToCapacity(ray.alpha);
    const bool is_end = observations_.IsEnd(ray.vertex);
    uint32_t before = 0;
    for (const Crossing& crossing : path.crossings) {
      uint32_t weight = whole;
      if (!is_end && crossing.distance < near_distance_) {
        const double distance = crossing.distance;
        weight = ToCapacity(
            ray.alpha * (1 - std::exp(distance * distance * normalization_)));
      }
      AddToArc(weight, crossing.*reverse_arc);
      if (weight > before) {  // Distances fall by a rounding at most.
        AddToTerminal(weight - before, crossing.exit_arc / 4, terminal);
      }
      before = weight;
    }
    if (whole > before) {
      AddAtEnds(whole - before, ray, path, terminal);
    }
  }

  void AddToArc(uint32_t weight, uint32_t arc) {
    AddCapacity(weight, &(*graph_)[arc / 4].arcs[arc % 4]);
  }

  void AddToTerminal(uint32_t weight, uint32_t cell,
                     uint32_t NodeCapacities::*terminal) {
    AddCapacity(weight, &((*graph_)[cell].*terminal));
  }

  const Tetrahedralization& tetrahedra_;
  const Observations& observations_;
  const std::vector<Place>& places_;
  const std::vector<Place>& centers_;
  const VisibilityWeightOptions& options_;
  const double near_distance_;
  const double normalization_;
  FlowCapacities* graph_;
  RayReport report_;
  std::vector<uint32_t> star_;  // scratch
  std::vector<Ray> rays_;       // of a batch
  std::array<RayPath, kBatch> front_;
  std::array<RayPath, kBatch> behind_;
};

}  // namespace

Observations ObserveVertices(const PointCloud& cloud, size_t num_vertices,
                             const std::vector<uint32_t>& point_vertices,
                             const std::vector<float>& point_alphas) {
  const Rows<uint32_t> points =
      NumbersInRows(num_vertices, cloud.size(),
                    [&](uint32_t point) { return point_vertices[point]; });
  const auto append = [&](size_t vertex, std::vector<Observation>* all) {
    std::vector<Observation> row;
    for (const uint32_t point : points[vertex]) {
      for (const uint32_t view : cloud.views[point]) {
        row.push_back({view, point_alphas[point]});
      }
    }
    std::ranges::sort(row);
    for (size_t i = 0; i < row.size(); ++i) {
      if (i > 0 && row[i].view == row[i - 1].view) {
        all->back().alpha += row[i].alpha;
      } else {
        all->push_back(row[i]);
      }
    }
  };
  return {MakeRows<Observation>(num_vertices, append)};
}

RayReport AddVisibilityWeights(const Tetrahedralization& tetrahedra,
                               const Observations& observations,
                               const std::vector<Eigen::Vector3d>& centers,
                               const VisibilityWeightOptions& options,
                               FlowCapacities* graph,
                               const Progress& progress) {
  Report(progress, kStage, 0);
  const std::vector<Place> places =
      LocatePoints(tetrahedra, observations.points);
  const std::vector<Place> located = LocateCenters(tetrahedra, centers);
  const auto num_rows = static_cast<uint32_t>(observations.size());
  const uint32_t num_blocks = (num_rows + kBlock - 1) / kBlock;
  std::mutex mutex;
  size_t num_done = 0;
  RayReport report;
  tbb::parallel_for(uint32_t{0}, num_blocks, [&](uint32_t block) {
    Voter voter(tetrahedra, observations, places, located, options, graph);
    voter.VoteBlock(block * kBlock, std::min(num_rows, (block + 1) * kBlock));
    const std::lock_guard lock(mutex);
    report += voter.report();
    Report(progress, kStage, static_cast<double>(++num_done) / num_blocks);
  });
  return report;
}

}  // namespace colmap_ext
