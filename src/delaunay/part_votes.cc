#include "delaunay/part_votes.h"

#include <algorithm>
#include <array>
#include <mutex>
#include <optional>
#include <span>
#include <utility>

#include <tbb/parallel_for.h>

#include "delaunay/path_votes.h"
#include "delaunay/ray_entries.h"
#include "delaunay/ray_walk.h"

namespace colmap_ext {
namespace {

// Points whose rays are walked by one thread, and rays that are walked
// together. Any other numbers give the same result.
constexpr uint32_t kBlock = 256;
constexpr size_t kBatch = 64;

class PartVoter {
 public:
  PartVoter(const Tetrahedralization& tetrahedra, const CellPart& part,
            const std::vector<RayPlace>& centers, const PartPoints& points,
            const VisibilityWeightOptions& options, FlowCapacities* graph)
      : tetrahedra_(tetrahedra),
        part_(part),
        centers_(centers),
        points_(points),
        sigma_(options.distance_sigma),
        near_distance_(kNearSigmas * sigma_),
        behind_distance_(options.behind_sigma * sigma_),
        votes_(tetrahedra, options, graph),
        hint_(tetrahedra.vertex_cells.front()) {}

  // \param begin, end  points
  void VoteBlock(uint32_t begin, uint32_t end) {
    first_ = begin;
    places_.assign(end - begin, {});
    const std::vector<Observation> block =
        ObservationsByView(points_.observations, begin, end);
    for (size_t i = 0; i < block.size(); i += kBatch) {
      VoteBatch({block.data() + i, std::min(kBatch, block.size() - i)});
    }
  }

  const RayReport& report() const { return report_; }

 private:
  // A piece of a ray within the part.
  struct Entry {
    uint32_t observation;  // of the batch
    uint32_t arc;
  };

  // \param batch  kBatch observations at most
  void VoteBatch(std::span<const Observation> batch) {
    own_.clear();
    near_.clear();
    entries_.clear();
    for (uint32_t i = 0; i < batch.size(); ++i) {
      Enter(batch[i], i);
    }
    WalkFromPoints(batch, own_, nullptr);
    WalkFromPoints(batch, near_, &part_);
    WalkEntries(batch);
  }

  // Finds out where a ray comes in. One of a corner of the part would come in
  // again so seldom that its walk to the end takes less.
  void Enter(const Observation& observation, uint32_t i) {
    const uint32_t vertex = points_.vertices[observation.vertex];
    if (vertex != kNoVertex && part_.IsCorner(vertex)) {
      own_.push_back(i);
      ++report_.num_rays;
      return;
    }
    const RayLine line = {points_.positions[observation.vertex].cast<double>(),
                          centers_[observation.view].position, near_distance_,
                          behind_distance_};
    const bool is_far = FindEntries(tetrahedra_, part_, line, &arcs_);
    if (!is_far) {
      near_.push_back(i);
    }
    for (const uint32_t arc : arcs_) {
      entries_.push_back({i, arc});
    }
    report_.num_rays += !is_far || !arcs_.empty();
  }

  // \param observations  of the batch
  // \param part  where rays end that are not near their points any more
  void WalkFromPoints(std::span<const Observation> batch,
                      const std::vector<uint32_t>& observations,
                      const CellPart* part) {
    observers_.clear();
    rays_.clear();
    for (const uint32_t i : observations) {
      observers_.push_back(ObserverOf(batch[i]));
      const RayPlace& center = centers_[batch[i].view];
      rays_.push_back(RayOf(batch[i].vertex, center.position, center.cell));
    }
    WalkRays(tetrahedra_, rays_, front_, part);
    for (size_t k = 0; k < observations.size(); ++k) {
      const Observer& observer = observers_[k];
      const Eigen::Vector3d direction =
          (observer.position - observer.center).normalized();
      rays_[k] =
          RayOf(batch[observations[k]].vertex,
                observer.position + behind_distance_ * direction, kNoCell);
    }
    WalkRays(tetrahedra_, rays_, behind_);
    for (size_t k = 0; k < observations.size(); ++k) {
      if (front_[k].end == kNoCell || behind_[k].end == kNoCell) {
        ++report_.num_lost_rays;
        continue;
      }
      DropCrossed(observations[k], front_[k]);
      report_.num_steps +=
          front_[k].crossings.size() + behind_[k].crossings.size();
      votes_.AddFront(observers_[k], front_[k]);
      votes_.AddBehind(observers_[k], behind_[k]);
    }
  }

  Observer ObserverOf(const Observation& observation) {
    const uint32_t vertex = points_.vertices[observation.vertex];
    return {vertex,
            vertex != kNoVertex ? tetrahedra_.points[vertex].cast<double>()
                                : PlaceOf(observation.vertex).position,
            centers_[observation.view].position, observation.alpha, false};
  }

  Ray RayOf(uint32_t point, const Eigen::Vector3d& target, uint32_t end) {
    const uint32_t vertex = points_.vertices[point];
    if (vertex != kNoVertex) {
      return {vertex, target, end, near_distance_};
    }
    const RayPlace& place = PlaceOf(point);
    return {kNoVertex, target, end, near_distance_, place.position, place.cell};
  }

  // Of a point that is no vertex.
  const RayPlace& PlaceOf(uint32_t point) {
    std::optional<RayPlace>& place = places_[point - first_];
    if (!place) {
      place = FindPlace(tetrahedra_, points_.positions[point].cast<double>(),
                        sigma_, hint_);
      if (place->cell != kNoCell && !tetrahedra_.IsInfinite(place->cell)) {
        hint_ = place->cell;
      }
    }
    return *place;
  }

  // Entries of a ray that its walk from the point has passed.
  void DropCrossed(uint32_t i, const RayPath& path) {
    std::erase_if(entries_, [&](const Entry& entry) {
      return entry.observation == i &&
             std::ranges::find(path.crossings, entry.arc,
                               &Crossing::exit_arc) != path.crossings.end();
    });
  }

  void WalkEntries(std::span<const Observation> batch) {
    for (size_t begin = 0; begin < entries_.size(); begin += kBatch) {
      const size_t count = std::min(kBatch, entries_.size() - begin);
      const std::span<const Entry> entries(entries_.data() + begin, count);
      rays_.clear();
      for (const Entry& entry : entries) {
        const Observation& observation = batch[entry.observation];
        const RayPlace& center = centers_[observation.view];
        Ray ray = {kNoVertex, center.position, center.cell};
        ray.position = points_.positions[observation.vertex].cast<double>();
        ray.start_arc = entry.arc;
        rays_.push_back(ray);
      }
      WalkRays(tetrahedra_, rays_, front_, &part_);
      for (size_t k = 0; k < count; ++k) {
        report_.num_steps += front_[k].crossings.size();
        votes_.AddFar(batch[entries[k].observation].alpha, front_[k]);
      }
    }
  }

  const Tetrahedralization& tetrahedra_;
  const CellPart& part_;
  const std::vector<RayPlace>& centers_;
  const PartPoints& points_;
  const double sigma_;
  const double near_distance_;
  const double behind_distance_;
  PathVotes votes_;
  RayReport report_;
  uint32_t hint_;
  uint32_t first_ = 0;                           // point of the block
  std::vector<std::optional<RayPlace>> places_;  // [points of the block]
  // Of a batch.
  std::vector<uint32_t> own_;   // observations of corners of the part
  std::vector<uint32_t> near_;  // others that are walked from their points
  std::vector<Entry> entries_;
  std::vector<Observer> observers_;
  std::vector<uint32_t> arcs_;
  std::vector<Ray> rays_;
  std::array<RayPath, kBatch> front_;
  std::array<RayPath, kBatch> behind_;
};

}  // namespace

RayReport PartVotes::Add(const PartPoints& points) {
  const auto num_points = static_cast<uint32_t>(points.size());
  const uint32_t num_blocks = (num_points + kBlock - 1) / kBlock;
  std::mutex mutex;
  RayReport report;
  tbb::parallel_for(uint32_t{0}, num_blocks, [&](uint32_t block) {
    PartVoter voter(tetrahedra_, part_, centers_, points, options_, graph_);
    voter.VoteBlock(block * kBlock, std::min(num_points, (block + 1) * kBlock));
    const std::lock_guard lock(mutex);
    report += voter.report();
  });
  return report;
}

}  // namespace colmap_ext
