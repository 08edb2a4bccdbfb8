#include "delaunay/path_votes.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "delaunay/predicates.h"

namespace colmap_ext {

void PathVotes::AddFront(const Observer& observer, const RayPath& path) {
  PushAlong(path, observer, &Crossing::exit_arc, &graph_->source);
}

void PathVotes::AddBehind(const Observer& observer, const RayPath& path) {
  if (observer.is_end) {
    AddFar(observer.alpha, path);
  } else {
    PushAlong(path, observer, &Crossing::entry_arc, &graph_->sink);
  }
}

void PathVotes::AddFar(float alpha, const RayPath& path) {
  const uint32_t weight = ToCapacity(alpha);
  for (const Crossing& crossing : path.crossings) {
    AddToArc(weight, crossing.exit_arc);
  }
}

// Adds to the cell where a ray ends. Where that is beyond the hull, which a
// part of all vertices has another one of, it is all that may be the one.
void PathVotes::AddAtEnds(uint32_t weight, const Observer& observer,
                          const RayPath& path, std::vector<uint32_t>* sums) {
  if (!inner_place_ || observer.vertex == kNoVertex ||
      !path.crossings.empty() || !tetrahedra_.IsInfinite(path.end)) {
    AddCapacity(weight, &(*sums)[path.end]);
    return;
  }
  const bool is_front = sums == &graph_->source;
  const Eigen::Vector3d target =
      is_front ? observer.center : 2 * observer.position - observer.center;
  IncidentCells(tetrahedra_, observer.vertex, &star_);
  for (const uint32_t cell : star_) {
    if (tetrahedra_.IsInfinite(cell) && GoesOver(cell, observer, target)) {
      AddCapacity(weight, &(*sums)[cell]);
    }
  }
}

// Whether the ray from a vertex goes over the facet of an infinite cell, as
// seen from the inner place.
bool PathVotes::GoesOver(uint32_t cell, const Observer& observer,
                         const Eigen::Vector3d& target) const {
  const auto& vertices = tetrahedra_.cells[cell].vertices;
  // Counter-clockwise seen from outside.
  std::array<uint32_t, 3> facet;
  const uint32_t infinite = tetrahedra_.IndexOf(cell, kInfiniteVertex);
  for (int i = 0; i < 3; ++i) {
    facet[i] = vertices[kFacetCorners[infinite][i]];
  }
  const auto at = static_cast<size_t>(
      std::ranges::find(facet, observer.vertex) - facet.begin());
  const auto side = [&](size_t next) {
    return RaySideExact(
        observer.position, target,
        tetrahedra_.points[facet[(at + next) % 3]].cast<double>(),
        *inner_place_);
  };
  return side(1) > 0 && side(2) < 0;
}

// A path of arcs whose weights do not fall from the point outwards, to a
// terminal arc of the whole weight. As much flow as each arc takes leaves its
// reverse with the capacity, and the cells with what the next arc did not take.
// \param reverse_arc  of each arc
// \param terminal [cells] source or sink
void PathVotes::PushAlong(const RayPath& path, const Observer& observer,
                          uint32_t Crossing::*reverse_arc,
                          std::vector<uint32_t>* terminal) {
  const uint32_t whole = ToCapacity(observer.alpha);
  uint32_t before = 0;
  for (const Crossing& crossing : path.crossings) {
    uint32_t weight = whole;
    if (!observer.is_end && crossing.distance < near_distance_) {
      weight = SoftWeight(observer.alpha, crossing.distance);
    }
    AddToArc(weight, crossing.*reverse_arc);
    if (weight > before) {  // Distances fall by a rounding at most.
      AddCapacity(weight - before, &(*terminal)[crossing.exit_arc / 4]);
    }
    before = weight;
  }
  if (whole > before) {
    AddAtEnds(whole - before, observer, path, terminal);
  }
}

uint32_t PathVotes::SoftWeight(double alpha, double distance) const {
  return ToCapacity(alpha *
                    (1 - std::exp(distance * distance * normalization_)));
}

}  // namespace colmap_ext
