#include "delaunay/visibility_weights.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <mutex>
#include <numeric>
#include <utility>

#include <tbb/parallel_for.h>

#include "delaunay/ray_walk.h"

namespace colmap_ext {
namespace {

constexpr char kStage[] = "Walking rays";

// Beyond this many sigmas the soft weight is one to within the weights' unit.
constexpr double kNearSigmas = 5;

// Rays of this many points are walked by one thread, camera after camera, so
// that neighboring rays find their cells in the cache.
constexpr size_t kBlock = 256;

// Adds atomically, up to a little above kMaxCapacity. Whether the sum ends
// above it does not depend on the order, and above it all sums count the same.
void Add(uint32_t weight, uint32_t* sum) {
  std::atomic_ref<uint32_t> atomic(*sum);
  if (atomic.load(std::memory_order_relaxed) <= kMaxCapacity) {
    atomic.fetch_add(weight, std::memory_order_relaxed);
  }
}

// A camera's centre and the cell that holds it.
struct Center {
  Eigen::Vector3d position;
  uint32_t cell = kNoCell;  // kNoCell: beyond the hull
};

// A centre on a facet would lie in no cell, or not in that of the walk, which
// treats it as moved by an infinitesimal step. It is moved by a small one.
std::vector<Center> LocateCenters(const Tetrahedralization& tetrahedra,
                                  const std::vector<Eigen::Vector3d>& centers,
                                  double sigma) {
  std::vector<Center> located(centers.size());
  for (size_t i = 0; i < centers.size(); ++i) {
    constexpr int kMaxTries = 64;
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

// Walks the rays of points and collects their votes.
class Voter {
 public:
  Voter(const Tetrahedralization& tetrahedra, const Observations& observations,
        const std::vector<Center>& centers,
        const VisibilityWeightOptions& options, FlowGraph* graph)
      : tetrahedra_(tetrahedra),
        observations_(observations),
        centers_(centers),
        options_(options),
        near_distance_(kNearSigmas * options.distance_sigma),
        normalization_(-0.5 /
                       (options.distance_sigma * options.distance_sigma)),
        graph_(graph) {}

  void VoteBlock(size_t begin, size_t end) {
    std::vector<std::pair<uint32_t, size_t>> rays;  // view, point
    std::vector<RayOrigin> origins;
    for (size_t point = begin; point < end; ++point) {
      origins.push_back(OriginOf(point));
      for (const uint32_t view : observations_.cloud.Views(point)) {
        rays.emplace_back(view, point);
      }
    }
    std::sort(rays.begin(), rays.end());
    for (const auto& [view, point] : rays) {
      Vote(origins[point - begin], centers_[view], observations_.alphas[point]);
    }
  }

  const RayReport& report() const { return report_; }

 private:
  // A point that was thinned out has to lie strictly within its cell for the
  // walk: from a facet it is moved inwards, and to a vertex where even that
  // fails.
  RayOrigin OriginOf(size_t point) const {
    RayOrigin origin;
    origin.position = observations_.cloud.positions[point].cast<double>();
    const uint32_t near = observations_.point_vertices[point];
    if (tetrahedra_.points[near] == observations_.cloud.positions[point]) {
      origin.vertex = near;
      return origin;
    }
    origin.cell =
        Locate(tetrahedra_, origin.position, tetrahedra_.vertex_cells[near]);
    if (!tetrahedra_.IsInfinite(origin.cell)) {
      Eigen::Vector3d centroid = Eigen::Vector3d::Zero();
      for (const uint32_t vertex : tetrahedra_.cells[origin.cell].vertices) {
        centroid += 0.25 * tetrahedra_.points[vertex].cast<double>();
      }
      const Eigen::Vector3d position = origin.position;
      for (const double share : {0.0, 1e-6, 1e-3, 1e-1}) {
        origin.position = position + share * (centroid - position);
        if (IsStrictlyInside(tetrahedra_, origin.cell, origin.position)) {
          return origin;
        }
      }
    }
    origin.position = tetrahedra_.points[near].cast<double>();
    origin.vertex = near;
    return origin;
  }

  void Vote(const RayOrigin& origin, const Center& center, double alpha) {
    ++report_.num_rays;
    // The end of a front walk is never kNoCell, which would stop it at its
    // target: an index that no cell has lets it go on to the hull.
    const uint32_t end = center.cell == kNoCell
                             ? static_cast<uint32_t>(tetrahedra_.cells.size())
                             : center.cell;
    const uint32_t source_cell = WalkRay(tetrahedra_, origin, center.position,
                                         end, near_distance_, &front_);
    const Eigen::Vector3d direction =
        (origin.position - center.position).normalized();
    const Eigen::Vector3d target =
        origin.position +
        options_.behind_sigma * options_.distance_sigma * direction;
    const uint32_t sink_cell =
        options_.behind_sigma > 0 && source_cell != kNoCell
            ? WalkRay(tetrahedra_, origin, target, kNoCell, near_distance_,
                      &behind_)
            : kNoCell;
    if (sink_cell == kNoCell) {
      ++report_.num_lost_rays;
      return;
    }
    report_.num_steps += front_.size() + behind_.size();
    Add(Quantize(alpha), &graph_->source[source_cell]);
    for (const Crossing& crossing : front_) {
      AddSoft(alpha, crossing.distance, crossing.entry_arc);
    }
    for (const Crossing& crossing : behind_) {
      AddSoft(alpha, crossing.distance, crossing.exit_arc);
    }
    Add(Quantize(alpha), &graph_->sink[sink_cell]);
  }

  static uint32_t Quantize(double weight) {
    return static_cast<uint32_t>(kWeightUnit * weight + 0.5);
  }

  void AddSoft(double alpha, double distance, uint32_t arc) {
    const double soft = distance < near_distance_
                            ? 1 - std::exp(distance * distance * normalization_)
                            : 1;
    Add(Quantize(alpha * soft), &graph_->capacities[arc / 4][arc % 4]);
  }

  const Tetrahedralization& tetrahedra_;
  const Observations& observations_;
  const std::vector<Center>& centers_;
  const VisibilityWeightOptions& options_;
  const double near_distance_;
  const double normalization_;
  FlowGraph* graph_;
  RayReport report_;
  std::vector<Crossing> front_;
  std::vector<Crossing> behind_;
};

}  // namespace

RayReport AddVisibilityWeights(const Tetrahedralization& tetrahedra,
                               const Observations& observations,
                               const VisibilityWeightOptions& options,
                               FlowGraph* graph, const Progress& progress) {
  Report(progress, kStage, 0);
  const std::vector<Center> located =
      LocateCenters(tetrahedra, observations.centers, options.distance_sigma);
  const size_t num_points = observations.cloud.size();
  const size_t num_blocks = (num_points + kBlock - 1) / kBlock;
  std::mutex mutex;
  size_t num_done = 0;
  RayReport report;
  tbb::parallel_for(size_t{0}, num_blocks, [&](size_t block) {
    Voter voter(tetrahedra, observations, located, options, graph);
    voter.VoteBlock(block * kBlock, std::min(num_points, (block + 1) * kBlock));
    const std::lock_guard lock(mutex);
    report.num_rays += voter.report().num_rays;
    report.num_lost_rays += voter.report().num_lost_rays;
    report.num_steps += voter.report().num_steps;
    Report(progress, kStage,
           static_cast<double>(++num_done) / static_cast<double>(num_blocks));
  });
  return report;
}

}  // namespace colmap_ext
