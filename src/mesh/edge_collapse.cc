#include "mesh/edge_collapse.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <numeric>
#include <optional>
#include <vector>

#include <Eigen/Geometry>

#include "mesh/collapsible_facets.h"
#include "mesh/quadric.h"
#include "mesh/short_edge_queue.h"

namespace colmap_ext {
namespace {

using Eigen::Vector3d;
using Eigen::Vector3f;
using Star = CollapsibleFacets::Star;

constexpr uint32_t kNone = CollapsibleFacets::kNone;
constexpr double kMinCosine = 0.5;    // of the angle that a facet may turn by
constexpr double kMaxLength = 1.5;    // of an edge that grows, targets
constexpr double kMaxOffset = 0.1;    // of an end from the planes, targets
constexpr size_t kMaxNeighbors = 12;  // of a vertex that gets more of them
// Of a facet, twice its area over its longest side squared: its height over its
// base.
constexpr double kMinHeight = 0.1;         // of one that gets flatter
constexpr double kMinNormalHeight = 1e-3;  // below, its normal says nothing

// Height over base, of twice a facet's area and its sides.
double Height(double area, const Vector3d& a, const Vector3d& b,
              const Vector3d& c) {
  const double longest = std::max(
      {(b - a).squaredNorm(), (c - b).squaredNorm(), (a - c).squaredNorm()});
  return longest > 0 ? area / longest : 0;
}

// A facet that stays, whose corner at the collapsed edge moves.
struct MovingFacet {
  Vector3d b, c;    // its corners that stay, after the one that moves
  Vector3d normal;  // as it was
  double height;    // as it was
};

// An edge that stays, whose end at the collapsed edge moves.
struct MovingEdge {
  Vector3d end;   // that stays
  double length;  // as it was
  double target;  // of the end
};

class Collapser {
 public:
  Collapser(const TriangleMesh& mesh, const std::vector<float>& targets)
      : positions_(mesh.vertices),
        targets_(targets),
        facets_(mesh.facets, mesh.vertices.size()),
        quadrics_(mesh.vertices.size()),
        sources_(mesh.vertices.size()),
        has_changed_(mesh.vertices.size(), 1) {
    std::iota(sources_.begin(), sources_.end(), 0);
    AddQuadrics();
  }

  EdgeCollapse Run() {
    while (CollapseAll() > 0) {
    }
    return Result();
  }

 private:
  Vector3d Position(uint32_t vertex) const {
    return positions_[vertex].cast<double>();
  }

  // Weighted by areas, an edge's as a square on it.
  void AddQuadrics() {
    for (const Facet& facet : facets_.Facets()) {
      const Vector3d a = Position(facet[0]);
      const Vector3d area =
          (Position(facet[1]) - a).cross(Position(facet[2]) - a) / 2;
      const double norm = area.norm();
      if (!(norm > 0)) {
        continue;
      }
      Quadric plane;
      plane.AddPlane(area / std::sqrt(norm), a);
      const auto half =
          static_cast<uint32_t>(3 * (&facet - facets_.Facets().data()));
      for (int k = 0; k < 3; ++k) {
        quadrics_[facet[k]] += plane;
        if (facets_.Partner(half + k) == kNone) {
          const Vector3d from = Position(facet[k]);
          const Vector3d side = Position(facet[(k + 1) % 3]) - from;
          Quadric upright;
          upright.AddPlane(side.cross(area / norm), from);
          quadrics_[facet[k]] += upright;
          quadrics_[facet[(k + 1) % 3]] += upright;
        }
      }
    }
  }

  int BinOf(uint32_t half) const {
    const uint32_t from = facets_.From(half);
    const uint32_t to = facets_.To(half);
    return ShortEdgeQueue::BinOf((Position(to) - Position(from)).norm() /
                                 std::min(targets_[from], targets_[to]));
  }

  // Queues the edges around which something has changed since the last time,
  // one half-edge each.
  void PushChanged() {
    for (uint32_t half = 0; half < 3 * facets_.Facets().size(); ++half) {
      if (facets_.IsFacet(half / 3) && half < facets_.Partner(half) &&
          (has_changed_[facets_.From(half)] ||
           has_changed_[facets_.To(half)])) {
        queue_.Push(BinOf(half), half);
      }
    }
    std::fill(has_changed_.begin(), has_changed_.end(), 0);
  }

  // \return how many edges
  size_t CollapseAll() {
    PushChanged();
    size_t num_collapsed = 0;
    for (;;) {
      const auto [bin, half] = queue_.Pop();
      if (half == kNone) {
        return num_collapsed;
      }
      // Else its length has changed, and it is in another bin as well.
      if (facets_.IsFacet(half / 3) && BinOf(half) == bin) {
        num_collapsed += TryToCollapse(half);
      }
    }
  }

  bool TryToCollapse(uint32_t half) {
    const uint32_t from = facets_.From(half);
    const uint32_t to = facets_.To(half);
    facets_.GetStar(from, &from_star_);
    facets_.GetStar(to, &to_star_);
    if (!facets_.IsCollapsible(half, from_star_, to_star_) ||
        !KeepsNeighborsFew(half)) {
      return false;
    }
    CollectWhatMoves(half);
    const std::optional<Vector3f> place = Place(from, to);
    if (!place.has_value()) {
      return false;
    }
    facets_.Collapse(half, to_star_);
    if (IsCloserToSecond(*place, from, to)) {
      targets_[from] = targets_[to];
      sources_[from] = sources_[to];
    }
    positions_[from] = *place;
    quadrics_[from] += quadrics_[to];
    PushAround(from);
    return true;
  }

  bool IsCloserToSecond(const Vector3f& place, uint32_t first,
                        uint32_t second) const {
    return (place - positions_[second]).squaredNorm() <
           (place - positions_[first]).squaredNorm();
  }

  bool KeepsNeighborsFew(uint32_t half) const {
    const size_t num_from = from_star_.neighbors.size();
    const size_t num_to = to_star_.neighbors.size();
    const size_t num_common = facets_.Partner(half) == kNone ? 1 : 2;
    return num_from + num_to - 2 - num_common <=
           std::max({kMaxNeighbors, num_from, num_to});
  }

  // Gathers the facets and edges that are changed by a collapse.
  void CollectWhatMoves(uint32_t half) {
    moving_facets_.clear();
    moving_edges_.clear();
    mean_normal_.setZero();
    CollectWhatMoves(half, facets_.From(half), facets_.To(half), from_star_);
    CollectWhatMoves(half, facets_.To(half), facets_.From(half), to_star_);
    for (MovingFacet& facet : moving_facets_) {
      if (facet.height < kMinNormalHeight) {
        facet.normal = mean_normal_;
      }
    }
  }

  void CollectWhatMoves(uint32_t half, uint32_t vertex, uint32_t other,
                        const Star& star) {
    const Vector3d a = Position(vertex);
    for (const uint32_t leaving : star.halves) {
      const Vector3d b = Position(facets_.To(leaving));
      const Vector3d c = Position(facets_.Apex(leaving));
      const Vector3d normal = (b - a).cross(c - a);
      mean_normal_ += normal;
      const uint32_t facet = leaving / 3;
      if (facet != half / 3 && (facets_.Partner(half) == kNone ||
                                facet != facets_.Partner(half) / 3)) {
        moving_facets_.push_back(
            {b, c, normal, Height(normal.norm(), a, b, c)});
      }
    }
    for (const uint32_t neighbor : star.neighbors) {
      if (neighbor != other) {
        const Vector3d end = Position(neighbor);
        moving_edges_.push_back({end, (end - a).norm(), targets_[neighbor]});
      }
    }
  }

  // The first place that will do, best first.
  std::optional<Vector3f> Place(uint32_t from, uint32_t to) const {
    const std::array<Vector3f, 2> ends = {positions_[from], positions_[to]};
    if (from_star_.is_border != to_star_.is_border) {
      const Vector3f& end = ends[to_star_.is_border];
      return IsGood(end, from, to) ? std::optional(end) : std::nullopt;
    }
    Quadric quadric = quadrics_[from];
    quadric += quadrics_[to];
    const Vector3d middle = (Position(from) + Position(to)) / 2;
    const Vector3d optimum = quadric.Minimum(middle);
    // One far off is of planes that are nearly parallel.
    if ((optimum - middle).norm() <= (ends[1] - ends[0]).norm() &&
        IsGood(optimum.cast<float>(), from, to)) {
      return optimum.cast<float>();
    }
    if (from_star_.is_border) {
      return std::nullopt;  // an end would cut off the border's corners
    }
    const double limit = kMaxOffset * std::min(targets_[from], targets_[to]);
    for (const Vector3f& end : ends) {
      if (quadric.Growth(optimum, end.cast<double>()) <= limit * limit &&
          IsGood(end, from, to)) {
        return end;
      }
    }
    return std::nullopt;
  }

  // Whether the facets and edges stay good that get a corner at a place.
  bool IsGood(const Vector3f& rounded, uint32_t from, uint32_t to) const {
    const Vector3d place = rounded.cast<double>();
    const double target =
        targets_[IsCloserToSecond(rounded, from, to) ? to : from];
    for (const MovingEdge& edge : moving_edges_) {
      const double limit =
          std::max(edge.length, kMaxLength * std::min(target, edge.target));
      if (!((edge.end - place).squaredNorm() <= limit * limit)) {
        return false;
      }
    }
    for (const MovingFacet& facet : moving_facets_) {
      const Vector3d normal = (facet.b - place).cross(facet.c - place);
      const double area = normal.norm();
      const double height = Height(area, place, facet.b, facet.c);
      if (!(height >= std::min(kMinHeight, facet.height)) ||
          !(normal.dot(facet.normal) >=
            kMinCosine * area * facet.normal.norm())) {
        return false;
      }
    }
    return true;
  }

  void PushAround(uint32_t vertex) {
    facets_.GetStar(vertex, &from_star_);
    for (const uint32_t neighbor : from_star_.neighbors) {
      has_changed_[neighbor] = 1;
    }
    for (const uint32_t half : from_star_.halves) {
      queue_.Push(BinOf(half), half);
    }
    if (from_star_.is_border) {
      const uint32_t last = from_star_.halves.back();
      const uint32_t previous = last % 3 == 0 ? last + 2 : last - 1;
      queue_.Push(BinOf(previous), previous);
    }
  }

  EdgeCollapse Result() const {
    EdgeCollapse result;
    std::vector<uint32_t> numbers(positions_.size(), kNone);
    std::vector<uint32_t> order;
    for (uint32_t vertex = 0; vertex < positions_.size(); ++vertex) {
      if (facets_.IsVertex(vertex)) {
        order.push_back(vertex);
      }
    }
    std::sort(order.begin(), order.end(), [&](uint32_t a, uint32_t b) {
      return sources_[a] < sources_[b];
    });
    for (const uint32_t vertex : order) {
      numbers[vertex] = static_cast<uint32_t>(result.sources.size());
      result.sources.push_back(sources_[vertex]);
      result.mesh.vertices.push_back(positions_[vertex]);
    }
    for (uint32_t facet = 0; facet < facets_.Facets().size(); ++facet) {
      if (facets_.IsFacet(facet)) {
        const auto& [a, b, c] = facets_.Facets()[facet];
        result.mesh.facets.push_back({numbers[a], numbers[b], numbers[c]});
        result.facet_sources.push_back(facet);
      }
    }
    return result;
  }

  std::vector<Vector3f> positions_;  // [V] rounded as they come out
  std::vector<float> targets_;       // [V]
  CollapsibleFacets facets_;
  std::vector<Quadric> quadrics_;  // [V] of all facets that went into it
  std::vector<uint32_t> sources_;  // [V]
  ShortEdgeQueue queue_;
  std::vector<uint8_t> has_changed_;  // [V] its facets have

  // Of the edge at hand.
  Star from_star_;
  Star to_star_;
  std::vector<MovingFacet> moving_facets_;
  std::vector<MovingEdge> moving_edges_;
  Vector3d mean_normal_;  // of all facets at both ends, weighted by area
};

}  // namespace

EdgeCollapse CollapseShortEdges(const TriangleMesh& mesh,
                                const std::vector<float>& target_lengths) {
  assert(target_lengths.size() == mesh.vertices.size());
  return Collapser(mesh, target_lengths).Run();
}

}  // namespace colmap_ext
