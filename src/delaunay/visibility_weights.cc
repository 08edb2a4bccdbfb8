#include "delaunay/visibility_weights.h"

#include <algorithm>
#include <array>
#include <mutex>
#include <numeric>
#include <span>
#include <utility>

#include <tbb/parallel_for.h>

#include "delaunay/path_votes.h"
#include "delaunay/ray_places.h"
#include "delaunay/ray_walk.h"

namespace colmap_ext {
namespace {

// Vertices whose rays are walked by one thread, camera after camera, so that
// neighboring rays find their cells in the cache. Any other number gives the
// same result.
constexpr uint32_t kBlock = 256;

// Rays that are walked together. Their paths fit a core's cache.
constexpr size_t kBatch = 64;

// Walks the rays of vertices and counts their votes.
class Voter {
 public:
  Voter(const Tetrahedralization& tetrahedra, const Observations& observations,
        const std::vector<RayPlace>& centers,
        const VisibilityWeightOptions& options, FlowCapacities* graph,
        std::vector<uint32_t>* free_support)
      : tetrahedra_(tetrahedra),
        observations_(observations),
        centers_(centers),
        near_distance_(kNearSigmas * options.distance_sigma),
        behind_distance_(options.behind_sigma * options.distance_sigma),
        votes_(tetrahedra, options, graph),
        free_support_(free_support) {}

  // \param begin, end  vertices
  void VoteBlock(uint32_t begin, uint32_t end) {
    const std::vector<Observation> block =
        ObservationsByView(observations_, begin, end);
    for (size_t i = 0; i < block.size(); i += kBatch) {
      VoteBatch({block.data() + i, std::min(kBatch, block.size() - i)});
    }
  }

  const RayReport& report() const { return report_; }

 private:
  // \param batch  kBatch observations at most
  void VoteBatch(std::span<const Observation> batch) {
    rays_.clear();
    for (const Observation& observation : batch) {
      const RayPlace& center = centers_[observation.view];
      rays_.push_back(
          {observation.vertex, center.position, center.cell,
           observations_.IsEnd(observation.vertex) ? 0 : near_distance_});
    }
    WalkRays(tetrahedra_, rays_, front_);
    for (size_t i = 0; i < batch.size(); ++i) {
      rays_[i] = RayBehind(batch[i]);
    }
    WalkRays(tetrahedra_, rays_, behind_);
    for (size_t i = 0; i < batch.size(); ++i) {
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

  Eigen::Vector3d PositionOf(uint32_t vertex) const {
    return tetrahedra_.points[vertex].cast<double>();
  }

  // Behind an end it goes on to the hull, as no cell is kNoCell - 1.
  Ray RayBehind(const Observation& observation) const {
    const uint32_t vertex = observation.vertex;
    const Eigen::Vector3d& center = centers_[observation.view].position;
    const Eigen::Vector3d position = PositionOf(vertex);
    if (observations_.IsEnd(vertex)) {
      return {vertex, 2 * position - center, kNoCell - 1, 0};
    }
    const Eigen::Vector3d direction = (position - center).normalized();
    return {vertex, position + behind_distance_ * direction, kNoCell,
            near_distance_};
  }

  void Vote(const Observation& observation, const RayPath& front,
            const RayPath& behind) {
    const Observer observer = {
        observation.vertex, PositionOf(observation.vertex),
        centers_[observation.view].position, observation.alpha,
        observations_.IsEnd(observation.vertex)};
    votes_.AddFront(observer, front);
    votes_.AddBehind(observer, behind);
    if (free_support_ != nullptr) {
      AddFreeSupport(ToCapacity(observation.alpha), front);
    }
  }

  void AddFreeSupport(uint32_t weight, const RayPath& front) {
    for (const Crossing& crossing : front.crossings) {
      AddCapacity(weight, &(*free_support_)[crossing.exit_arc / 4]);
    }
    AddCapacity(weight, &(*free_support_)[front.end]);
  }

  const Tetrahedralization& tetrahedra_;
  const Observations& observations_;
  const std::vector<RayPlace>& centers_;
  const double near_distance_;
  const double behind_distance_;
  PathVotes votes_;
  std::vector<uint32_t>* free_support_;  // [cells], or null
  RayReport report_;
  std::vector<Ray> rays_;  // of a batch
  std::array<RayPath, kBatch> front_;
  std::array<RayPath, kBatch> behind_;
};

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

std::vector<Observation> ObservationsByView(const Observations& observations,
                                            uint32_t begin, uint32_t end) {
  std::vector<Observation> block;
  for (uint32_t vertex = begin; vertex < end; ++vertex) {
    for (uint64_t k = observations.offsets[vertex];
         k < observations.offsets[vertex + 1]; ++k) {
      block.push_back({observations.views[k], vertex, observations.alphas[k]});
    }
  }
  std::ranges::stable_sort(block, {}, &Observation::view);
  return block;
}

RayReport AddVisibilityWeights(const Tetrahedralization& tetrahedra,
                               const Observations& observations,
                               const std::vector<Eigen::Vector3d>& centers,
                               const VisibilityWeightOptions& options,
                               FlowCapacities* graph, const Progress& progress,
                               std::vector<uint32_t>* free_support) {
  Report(progress, kWalkingStage, 0);
  if (free_support != nullptr) {
    free_support->assign(tetrahedra.cells.size(), 0);
  }
  const std::vector<RayPlace> located =
      LocateCenters(tetrahedra, centers, options.distance_sigma);
  const auto num_rows = static_cast<uint32_t>(observations.offsets.size() - 1);
  const uint32_t num_blocks = (num_rows + kBlock - 1) / kBlock;
  std::mutex mutex;
  size_t num_done = 0;
  RayReport report;
  tbb::parallel_for(uint32_t{0}, num_blocks, [&](uint32_t block) {
    Voter voter(tetrahedra, observations, located, options, graph,
                free_support);
    voter.VoteBlock(block * kBlock, std::min(num_rows, (block + 1) * kBlock));
    const std::lock_guard lock(mutex);
    report += voter.report();
    Report(progress, kWalkingStage,
           static_cast<double>(++num_done) / num_blocks);
  });
  return report;
}

}  // namespace colmap_ext
