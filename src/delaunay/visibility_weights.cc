#include "delaunay/visibility_weights.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <mutex>
#include <numeric>
#include <span>
#include <utility>

#include <tbb/parallel_for.h>

#include "delaunay/predicates.h"
#include "delaunay/ray_maker.h"
#include "delaunay/ray_walk.h"

namespace colmap_ext {
namespace {

constexpr char kStage[] = "Walking rays";

// Vertices whose rays are walked by one thread, camera after camera, so that
// neighboring rays find their cells in the cache. Any other number gives the
// same result.
constexpr uint32_t kBlock = 256;

// Rays that are walked together. Their paths fit a core's cache.
constexpr size_t kBatch = 64;

// Walks the rays of vertices, or of other points, and counts their votes.
class Voter {
 public:
  // \param points  that the rows are of; null: they are of the vertices
  // \param part    null: all cells
  Voter(const Tetrahedralization& tetrahedra, const Observations& observations,
        const std::vector<Eigen::Vector3f>* points,
        const std::vector<ViewCenter>& centers,
        const VisibilityWeightOptions& options, VotingPart* part,
        FlowCapacities* graph, std::vector<uint32_t>* free_support)
      : tetrahedra_(tetrahedra),
        observations_(observations),
        has_vertices_(points == nullptr),
        centers_(centers),
        options_(options),
        normalization_(-0.5 /
                       (options.distance_sigma * options.distance_sigma)),
        maker_(tetrahedra, points, options, part),
        part_(part),
        graph_(graph),
        free_support_(free_support) {}

  // \param begin, end  vertices
  void VoteBlock(uint32_t begin, uint32_t end) {
    std::vector<Observation> block;
    for (uint32_t vertex = begin; vertex < end; ++vertex) {
      for (uint64_t k = observations_.offsets[vertex];
           k < observations_.offsets[vertex + 1]; ++k) {
        block.push_back(
            {observations_.views[k], vertex, observations_.alphas[k]});
      }
    }
    std::stable_sort(block.begin(), block.end(),
                     [](const Observation& a, const Observation& b) {
                       return a.view < b.view;
                     });
    for (size_t i = 0; i < block.size(); i += kBatch) {
      VoteBatch({block.data() + i, std::min(kBatch, block.size() - i)});
    }
  }

  const RayReport& report() const { return report_; }

 private:
  struct Observation {
    uint32_t view;
    uint32_t vertex;
    float alpha;
  };

  // \param batch  kBatch observations at most
  void VoteBatch(std::span<const Observation> batch) {
    Walk(batch, &RayMaker::ToCenter, front_);
    Walk(batch, &RayMaker::Behind, behind_);
    for (size_t i = 0; i < batch.size(); ++i) {
      if (front_[i].end == kNotWalked && behind_[i].end == kNotWalked) {
        continue;
      }
      ++report_.num_rays;
      if (front_[i].end == kNoCell || behind_[i].end == kNoCell) {
        ++report_.num_lost_rays;
        continue;
      }
      report_.num_steps +=
          front_[i].crossings.size() + behind_[i].crossings.size();
      Vote(batch[i], front_[i], behind_[i]);
    }
  }

  using MakeRay = bool (RayMaker::*)(uint32_t vertex, const ViewCenter& center,
                                     bool is_end, Ray* ray);

  // \param paths [batch] are overwritten
  void Walk(std::span<const Observation> batch, MakeRay make_ray,
            std::span<RayPath> paths) {
    rays_.clear();
    walked_.clear();
    for (size_t i = 0; i < batch.size(); ++i) {
      paths[i].end = kNotWalked;
      Ray ray;
      if ((maker_.*make_ray)(batch[i].vertex, centers_[batch[i].view],
                             observations_.IsEnd(batch[i].vertex), &ray)) {
        rays_.push_back(ray);
        walked_.push_back(i);
      }
    }
    WalkListed(paths);
    // A ray may miss the cell on its way that it starts in, by a rounding.
    size_t num_missed = 0;
    for (size_t k = 0; k < rays_.size(); ++k) {
      if (paths[walked_[k]].end == kNoCell &&
          maker_.StartAtPoint(batch[walked_[k]].vertex, &rays_[k])) {
        rays_[num_missed] = rays_[k];
        walked_[num_missed++] = walked_[k];
      }
    }
    rays_.resize(num_missed);
    WalkListed(paths);
  }

  // Walks rays_; ray k has the path walked_[k].
  void WalkListed(std::span<RayPath> paths) {
    for (size_t k = 0; k < rays_.size(); ++k) {
      std::swap(listed_[k], paths[walked_[k]]);
    }
    WalkRays(tetrahedra_, rays_, listed_);
    for (size_t k = 0; k < rays_.size(); ++k) {
      std::swap(listed_[k], paths[walked_[k]]);
    }
  }

  bool IsInside(uint32_t cell) const {
    return part_ == nullptr || part_->is_inside[cell] != 0;
  }

  // Where flow is pushed along the ray at once (docs/method.md, section 2.3),
  // from both of its ends towards the point.
  void Vote(const Observation& observation, const RayPath& front,
            const RayPath& behind) {
    const uint32_t weight = ToCapacity(observation.alpha);
    if (front.end != kNotWalked) {
      PushAlong(front, observation, &Crossing::exit_arc, &graph_->source,
                part_ != nullptr ? &part_->free_space : nullptr);
    }
    const bool is_end = observations_.IsEnd(observation.vertex);
    if (behind.end != kNotWalked && is_end) {
      AddFreeSpace(weight, behind);
    } else if (behind.end != kNotWalked) {
      PushAlong(behind, observation, &Crossing::entry_arc, &graph_->sink,
                part_ != nullptr ? &part_->matter : nullptr);
    }
    if (free_support_ != nullptr) {
      AddFreeSupport(weight, front);
    }
  }

  // Behind an end of rays.
  void AddFreeSpace(uint32_t weight, const RayPath& path) {
    bool was_inside = true;
    for (const Crossing& crossing : path.crossings) {
      const bool is_inside = IsInside(crossing.exit_arc / 4);
      if (is_inside && !was_inside) {
        AddCapacity(weight, &part_->free_space[crossing.exit_arc / 4]);
      }
      was_inside = is_inside;
      AddToArc(weight, crossing.exit_arc);
    }
  }

  // Adds to the cell where a ray ends. Where that is beyond the hull, which a
  // part of all vertices has another one of, it is all that may be the one.
  void AddAtEnds(uint32_t weight, const Observation& observation,
                 const RayPath& path, std::vector<uint32_t>* sums) {
    if (!options_.inner_place || !has_vertices_ || !path.crossings.empty() ||
        !tetrahedra_.IsInfinite(path.end)) {
      AddCapacity(weight, &(*sums)[path.end]);
      return;
    }
    const Eigen::Vector3d& center = centers_[observation.view].position;
    const Eigen::Vector3d origin = maker_.PositionOf(observation.vertex);
    const bool is_front = sums == &graph_->source;
    const Eigen::Vector3d target = is_front ? center : 2 * origin - center;
    IncidentCells(tetrahedra_, observation.vertex, &star_);
    for (const uint32_t cell : star_) {
      if (tetrahedra_.IsInfinite(cell) &&
          GoesOver(cell, observation.vertex, target)) {
        AddCapacity(weight, &(*sums)[cell]);
      }
    }
  }

  // Whether the ray from a vertex goes over the facet of an infinite cell, as
  // seen from the inner place.
  bool GoesOver(uint32_t cell, uint32_t vertex,
                const Eigen::Vector3d& target) const {
    const auto& vertices = tetrahedra_.cells[cell].vertices;
    // Counter-clockwise seen from outside.
    std::array<uint32_t, 3> facet;
    const uint32_t infinite = tetrahedra_.IndexOf(cell, kInfiniteVertex);
    for (int i = 0; i < 3; ++i) {
      facet[i] = vertices[kFacetCorners[infinite][i]];
    }
    const auto at =
        static_cast<size_t>(std::ranges::find(facet, vertex) - facet.begin());
    const auto side = [&](size_t next) {
      return RaySideExact(maker_.PositionOf(vertex), target,
                          maker_.PositionOf(facet[(at + next) % 3]),
                          *options_.inner_place);
    };
    return side(1) > 0 && side(2) < 0;
  }

  void AddFreeSupport(uint32_t weight, const RayPath& front) {
    for (const Crossing& crossing : front.crossings) {
      AddCapacity(weight, &(*free_support_)[crossing.exit_arc / 4]);
    }
    AddCapacity(weight, &(*free_support_)[front.end]);
  }

  // A path of arcs whose weights do not fall from the point outwards, to a
  // terminal arc of the whole weight. As much flow as each arc takes leaves its
  // reverse with the capacity, and the cells with what the next arc did not
  // take.
  // \param reverse_arc  of each arc
  // \param terminal [cells] source or sink
  // \param brought [cells] what comes along from beyond the part
  void PushAlong(const RayPath& path, const Observation& observation,
                 uint32_t Crossing::*reverse_arc,
                 std::vector<uint32_t>* terminal,
                 std::vector<uint32_t>* brought) {
    const uint32_t whole = ToCapacity(observation.alpha);
    const bool is_end = observations_.IsEnd(observation.vertex);
    uint32_t before = 0;
    bool was_inside = true;
    const auto enter = [&](uint32_t cell) {
      const bool is_inside = IsInside(cell);
      if (is_inside && !was_inside) {
        AddCapacity(before, &(*brought)[cell]);
      }
      was_inside = is_inside;
    };
    for (const Crossing& crossing : path.crossings) {
      const uint32_t cell = crossing.exit_arc / 4;
      enter(cell);
      if (!was_inside && !IsInside(crossing.entry_arc / 4)) {
        continue;
      }
      uint32_t weight = whole;
      if (!is_end && crossing.distance < maker_.near_distance()) {
        weight = SoftWeight(observation.alpha, crossing.distance);
      }
      AddToArc(weight, crossing.*reverse_arc);
      if (was_inside && weight > before) {  // Distances fall by a rounding.
        AddCapacity(weight - before, &(*terminal)[cell]);
      }
      before = weight;
    }
    enter(path.end);
    // Where it leaves the hull at once the end may be another one.
    if (whole > before && (was_inside || path.crossings.empty())) {
      AddAtEnds(whole - before, observation, path, terminal);
    }
  }

  uint32_t SoftWeight(double alpha, double distance) const {
    return ToCapacity(alpha *
                      (1 - std::exp(distance * distance * normalization_)));
  }

  void AddToArc(uint32_t weight, uint32_t arc) {
    AddCapacity(weight, &graph_->capacities[arc / 4][arc % 4]);
  }

  // Of a ray that nothing of is in the part.
  static constexpr uint32_t kNotWalked = kNoCell - 1;

  const Tetrahedralization& tetrahedra_;
  const Observations& observations_;
  const bool has_vertices_;
  const std::vector<ViewCenter>& centers_;
  const VisibilityWeightOptions& options_;
  const double normalization_;
  RayMaker maker_;
  VotingPart* part_;
  FlowCapacities* graph_;
  std::vector<uint32_t>* free_support_;  // [cells], or null
  RayReport report_;
  std::vector<uint32_t> star_;  // scratch
  std::vector<Ray> rays_;       // of a batch
  std::vector<size_t> walked_;  // [rays] which of the batch
  std::array<RayPath, kBatch> listed_;
  std::array<RayPath, kBatch> front_;
  std::array<RayPath, kBatch> behind_;
};

// Counts the votes of all rows of observations.
RayReport Vote(const Tetrahedralization& tetrahedra,
               const Observations& observations,
               const std::vector<Eigen::Vector3f>* points,
               const std::vector<Eigen::Vector3d>& centers,
               const VisibilityWeightOptions& options, VotingPart* part,
               FlowCapacities* graph, const Progress& progress,
               std::vector<uint32_t>* free_support) {
  const std::vector<ViewCenter> located =
      LocateCenters(tetrahedra, centers, options.distance_sigma);
  const auto num_rows = static_cast<uint32_t>(observations.offsets.size() - 1);
  const uint32_t num_blocks = (num_rows + kBlock - 1) / kBlock;
  std::mutex mutex;
  size_t num_done = 0;
  RayReport report;
  tbb::parallel_for(uint32_t{0}, num_blocks, [&](uint32_t block) {
    Voter voter(tetrahedra, observations, points, located, options, part, graph,
                free_support);
    voter.VoteBlock(block * kBlock, std::min(num_rows, (block + 1) * kBlock));
    const std::lock_guard lock(mutex);
    report.num_rays += voter.report().num_rays;
    report.num_lost_rays += voter.report().num_lost_rays;
    report.num_steps += voter.report().num_steps;
    Report(progress, kStage, static_cast<double>(++num_done) / num_blocks);
  });
  return report;
}

}  // namespace

Observations ObserveVertices(const PointCloud& cloud, size_t num_vertices,
                             const std::vector<uint32_t>& point_vertices,
                             const std::vector<float>& point_alphas) {
  // The points of each vertex, compressed sparse rows.
  std::vector<uint64_t> offsets(num_vertices + 1, 0);
  for (const uint32_t vertex : point_vertices) {
    ++offsets[vertex + 1];
  }
  std::partial_sum(offsets.begin(), offsets.end(), offsets.begin());
  std::vector<uint32_t> points(cloud.size());
  std::vector<uint64_t> next(offsets.begin(), offsets.end() - 1);
  for (uint32_t point = 0; point < cloud.size(); ++point) {
    points[next[point_vertices[point]]++] = point;
  }
  Observations observations;
  std::vector<std::pair<uint32_t, float>> row;  // view, alpha
  for (size_t vertex = 0; vertex < num_vertices; ++vertex) {
    row.clear();
    for (uint64_t k = offsets[vertex]; k < offsets[vertex + 1]; ++k) {
      for (const uint32_t view : cloud.views[points[k]]) {
        row.emplace_back(view, point_alphas[points[k]]);
      }
    }
    std::sort(row.begin(), row.end());
    for (size_t i = 0; i < row.size(); ++i) {
      if (i > 0 && row[i].first == row[i - 1].first) {
        observations.alphas.back() += row[i].second;
      } else {
        observations.views.push_back(row[i].first);
        observations.alphas.push_back(row[i].second);
      }
    }
    observations.offsets.push_back(observations.size());
  }
  return observations;
}

RayReport AddVisibilityWeights(const Tetrahedralization& tetrahedra,
                               const Observations& observations,
                               const std::vector<Eigen::Vector3d>& centers,
                               const VisibilityWeightOptions& options,
                               FlowCapacities* graph, const Progress& progress,
                               std::vector<uint32_t>* free_support) {
  Report(progress, kStage, 0);
  if (free_support != nullptr) {
    free_support->assign(tetrahedra.cells.size(), 0);
  }
  return Vote(tetrahedra, observations, nullptr, centers, options, nullptr,
              graph, progress, free_support);
}

RayReport AddOuterVisibilityWeights(const Tetrahedralization& tetrahedra,
                                    const std::vector<Eigen::Vector3f>& points,
                                    const Observations& observations,
                                    const std::vector<Eigen::Vector3d>& centers,
                                    const VisibilityWeightOptions& options,
                                    VotingPart* part, FlowCapacities* graph) {
  return Vote(tetrahedra, observations, &points, centers, options, part, graph,
              {}, nullptr);
}

}  // namespace colmap_ext
