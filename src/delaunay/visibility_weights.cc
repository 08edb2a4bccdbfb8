#include "delaunay/visibility_weights.h"

#include <algorithm>
#include <cmath>
#include <mutex>
#include <numeric>
#include <utility>

#include <tbb/parallel_for.h>

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
        const VisibilityWeightOptions& options, FlowGraph* graph,
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
    struct Observation {
      uint32_t view;
      uint32_t vertex;
      float alpha;
    };
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
    for (const auto& [view, vertex, alpha] : block) {
      if (observations_.IsEnd(vertex)) {
        VoteFree(vertex, centers_[view], alpha);
      } else {
        Vote(vertex, centers_[view], alpha);
      }
    }
  }

  const RayReport& report() const { return report_; }

 private:
  void Vote(uint32_t vertex, const Center& center, double alpha) {
    ++report_.num_rays;
    const uint32_t source_cell = WalkRay(tetrahedra_, vertex, center.position,
                                         center.cell, near_distance_, &front_);
    const Eigen::Vector3d position = tetrahedra_.points[vertex].cast<double>();
    const Eigen::Vector3d direction = (position - center.position).normalized();
    const Eigen::Vector3d target =
        position + options_.behind_sigma * options_.distance_sigma * direction;
    const uint32_t sink_cell = source_cell != kNoCell
                                   ? WalkRay(tetrahedra_, vertex, target,
                                             kNoCell, near_distance_, &behind_)
                                   : kNoCell;
    if (sink_cell == kNoCell) {
      ++report_.num_lost_rays;
      return;
    }
    report_.num_steps += front_.size() + behind_.size();
    AddCapacity(ToCapacity(alpha), &graph_->source[source_cell]);
    for (const Crossing& crossing : front_) {
      AddSoft(alpha, crossing.distance, crossing.entry_arc);
    }
    for (const Crossing& crossing : behind_) {
      AddSoft(alpha, crossing.distance, crossing.exit_arc);
    }
    AddCapacity(ToCapacity(alpha), &graph_->sink[sink_cell]);
    if (free_support_ != nullptr) {
      AddFreeSupport(ToCapacity(alpha), source_cell);
    }
  }

  // The ray to an end, and on to the hull.
  void VoteFree(uint32_t vertex, const Center& center, double alpha) {
    ++report_.num_rays;
    const Eigen::Vector3d position = tetrahedra_.points[vertex].cast<double>();
    const uint32_t source_cell =
        WalkRay(tetrahedra_, vertex, center.position, center.cell, 0, &front_);
    // No cell is kNoCell - 1, so that the walk ends beyond the hull.
    const uint32_t last_cell =
        source_cell != kNoCell
            ? WalkRay(tetrahedra_, vertex, 2 * position - center.position,
                      kNoCell - 1, 0, &behind_)
            : kNoCell;
    if (last_cell == kNoCell) {
      ++report_.num_lost_rays;
      return;
    }
    report_.num_steps += front_.size() + behind_.size();
    const uint32_t weight = ToCapacity(alpha);
    AddCapacity(weight, &graph_->source[source_cell]);
    for (const Crossing& crossing : front_) {
      AddCapacity(
          weight,
          &graph_->capacities[crossing.entry_arc / 4][crossing.entry_arc % 4]);
    }
    for (const Crossing& crossing : behind_) {
      AddCapacity(
          weight,
          &graph_->capacities[crossing.exit_arc / 4][crossing.exit_arc % 4]);
    }
    if (free_support_ != nullptr) {
      AddFreeSupport(weight, source_cell);
    }
  }

  void AddFreeSupport(uint32_t weight, uint32_t source_cell) {
    for (const Crossing& crossing : front_) {
      AddCapacity(weight, &(*free_support_)[crossing.exit_arc / 4]);
    }
    AddCapacity(weight, &(*free_support_)[source_cell]);
  }

  void AddSoft(double alpha, double distance, uint32_t arc) {
    const double soft = distance < near_distance_
                            ? 1 - std::exp(distance * distance * normalization_)
                            : 1;
    AddCapacity(ToCapacity(alpha * soft),
                &graph_->capacities[arc / 4][arc % 4]);
  }

  const Tetrahedralization& tetrahedra_;
  const Observations& observations_;
  const std::vector<Center>& centers_;
  const VisibilityWeightOptions& options_;
  const double near_distance_;
  const double normalization_;
  FlowGraph* graph_;
  std::vector<uint32_t>* free_support_;  // [cells], or null
  RayReport report_;
  std::vector<Crossing> front_;
  std::vector<Crossing> behind_;
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
                               FlowGraph* graph, const Progress& progress,
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
