#include "delaunay/visibility_weights.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <mutex>
#include <numeric>
#include <span>
#include <utility>

#include <tbb/parallel_for.h>

#include "delaunay/locate.h"
#include "delaunay/ray_walk.h"

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

// A camera's centre and the cell that holds it.
struct Center {
  Eigen::Vector3d position;
  uint32_t cell = 0;  // no cell's index where it lies beyond the hull
};

// A centre on a facet lies strictly inside no cell, and a walk may end in
// another one than the centre's, as it treats the centre as moved by an
// infinitesimal step. Such a centre is moved, by a millionth of the points'
// noise at each try and in a direction that no simple plane contains.
std::vector<Center> LocateCenters(const Tetrahedralization& tetrahedra,
                                  const std::vector<Eigen::Vector3d>& centers,
                                  double sigma) {
  std::vector<Center> located(centers.size());
  for (size_t i = 0; i < centers.size(); ++i) {
    constexpr int kMaxTries = 64;
    located[i].cell = static_cast<uint32_t>(tetrahedra.cells.size());
    for (int k = 0; k < kMaxTries; ++k) {
      located[i].position =
          centers[i] + 1e-6 * sigma * k * Eigen::Vector3d(1, 0.618, 0.382);
      const uint32_t cell = Locate(tetrahedra, located[i].position,
                                   tetrahedra.vertex_cells.front());
      if (tetrahedra.IsInfinite(cell)) {
        break;
      }
      if (IsStrictlyInside(tetrahedra, cell, located[i].position)) {
        located[i].cell = cell;
        break;
      }
    }
  }
  return located;
}

// Walks the rays of vertices and counts their votes.
class Voter {
 public:
  Voter(const Tetrahedralization& tetrahedra, const Observations& observations,
        const std::vector<Center>& centers,
        const VisibilityWeightOptions& options, FlowCapacities* graph,
        std::vector<uint32_t>* free_support)
      : tetrahedra_(tetrahedra),
        observations_(observations),
        centers_(centers),
        options_(options),
        near_distance_(kNearSigmas * options.distance_sigma),
        normalization_(-0.5 /
                       (options.distance_sigma * options.distance_sigma)),
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
    rays_.clear();
    for (const Observation& observation : batch) {
      rays_.push_back(RayToCenter(observation));
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

  Ray RayToCenter(const Observation& observation) const {
    const Center& center = centers_[observation.view];
    return {observation.vertex, center.position, center.cell,
            NearDistance(observation.vertex)};
  }

  // Behind an end it goes on to the hull, as no cell is kNoCell - 1.
  Ray RayBehind(const Observation& observation) const {
    const uint32_t vertex = observation.vertex;
    const Eigen::Vector3d& center = centers_[observation.view].position;
    const Eigen::Vector3d position = tetrahedra_.points[vertex].cast<double>();
    if (observations_.IsEnd(vertex)) {
      return {vertex, 2 * position - center, kNoCell - 1, 0};
    }
    const Eigen::Vector3d direction = (position - center).normalized();
    return {
        vertex,
        position + options_.behind_sigma * options_.distance_sigma * direction,
        kNoCell, near_distance_};
  }

  double NearDistance(uint32_t vertex) const {
    return observations_.IsEnd(vertex) ? 0 : near_distance_;
  }

  // Where flow is pushed along the ray at once (docs/method.md, section 2.3),
  // from both of its ends towards the point.
  void Vote(const Observation& observation, const RayPath& front,
            const RayPath& behind) {
    const uint32_t weight = ToCapacity(observation.alpha);
    const bool is_end = observations_.IsEnd(observation.vertex);
    PushAlong(front, observation.alpha, is_end, &Crossing::exit_arc,
              &graph_->source);
    if (is_end) {
      for (const Crossing& crossing : behind.crossings) {
        AddToArc(weight, crossing.exit_arc);
      }
    } else {
      PushAlong(behind, observation.alpha, is_end, &Crossing::entry_arc,
                &graph_->sink);
    }
    if (free_support_ != nullptr) {
      AddFreeSupport(weight, front);
    }
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
  void PushAlong(const RayPath& path, float alpha, bool is_end,
                 uint32_t Crossing::*reverse_arc,
                 std::vector<uint32_t>* terminal) {
    const uint32_t whole = ToCapacity(alpha);
    uint32_t before = 0;
    for (const Crossing& crossing : path.crossings) {
      uint32_t weight = whole;
      if (!is_end && crossing.distance < near_distance_) {
        weight = std::max(before, SoftWeight(alpha, crossing.distance));
      }
      AddToArc(weight, crossing.*reverse_arc);
      AddToTerminal(weight - before, crossing.exit_arc / 4, terminal);
      before = weight;
    }
    AddToTerminal(whole - before, path.end, terminal);
  }

  uint32_t SoftWeight(double alpha, double distance) const {
    return ToCapacity(alpha *
                      (1 - std::exp(distance * distance * normalization_)));
  }

  void AddToArc(uint32_t weight, uint32_t arc) {
    AddCapacity(weight, &graph_->capacities[arc / 4][arc % 4]);
  }

  static void AddToTerminal(uint32_t weight, uint32_t cell,
                            std::vector<uint32_t>* terminal) {
    if (weight > 0) {
      AddCapacity(weight, &(*terminal)[cell]);
    }
  }

  const Tetrahedralization& tetrahedra_;
  const Observations& observations_;
  const std::vector<Center>& centers_;
  const VisibilityWeightOptions& options_;
  const double near_distance_;
  const double normalization_;
  FlowCapacities* graph_;
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
  const std::vector<Center> located =
      LocateCenters(tetrahedra, centers, options.distance_sigma);
  const auto num_vertices =
      static_cast<uint32_t>(observations.offsets.size() - 1);
  const uint32_t num_blocks = (num_vertices + kBlock - 1) / kBlock;
  std::mutex mutex;
  size_t num_done = 0;
  RayReport report;
  tbb::parallel_for(uint32_t{0}, num_blocks, [&](uint32_t block) {
    Voter voter(tetrahedra, observations, located, options, graph,
                free_support);
    voter.VoteBlock(block * kBlock,
                    std::min(num_vertices, (block + 1) * kBlock));
    const std::lock_guard lock(mutex);
    report.num_rays += voter.report().num_rays;
    report.num_lost_rays += voter.report().num_lost_rays;
    report.num_steps += voter.report().num_steps;
    Report(progress, kStage, static_cast<double>(++num_done) / num_blocks);
  });
  return report;
}

}  // namespace colmap_ext
