#include "delaunay/ray_maker.h"

#include <limits>

#include "delaunay/locate.h"

namespace colmap_ext {
namespace {

// Sigmas. Beyond them the soft weight differs from one by exp(-12.5) at most,
// 0.015 of the weights' unit: less than a weight is rounded by.
constexpr double kNearSigmas = 5;

// A place on a facet lies strictly inside no cell, and a walk may end in
// another one than it does, as it treats the place as moved by an
// infinitesimal step. Such a place is moved, by a millionth of the points'
// noise at each try and in a direction that no simple plane contains.
// \param cell  is set to the one that has it strictly inside, an infinite one,
//        or kNoCell
Eigen::Vector3d MoveOffFacets(const Tetrahedralization& tetrahedra,
                              const Eigen::Vector3d& position, double sigma,
                              uint32_t hint, uint32_t* cell) {
  constexpr int kMaxTries = 64;
  Eigen::Vector3d moved = position;
  for (int k = 0; k < kMaxTries; ++k) {
    moved = position + 1e-6 * sigma * k * Eigen::Vector3d(1, 0.618, 0.382);
    *cell = Locate(tetrahedra, moved, hint);
    if (tetrahedra.IsInfinite(*cell) ||
        IsStrictlyInside(tetrahedra, *cell, moved)) {
      return moved;
    }
  }
  *cell = kNoCell;
  return moved;
}

}  // namespace

std::vector<ViewCenter> LocateCenters(
    const Tetrahedralization& tetrahedra,
    const std::vector<Eigen::Vector3d>& centers, double sigma) {
  std::vector<ViewCenter> located;
  for (const Eigen::Vector3d& center : centers) {
    uint32_t cell = kNoCell;
    const Eigen::Vector3d position = MoveOffFacets(
        tetrahedra, center, sigma, tetrahedra.vertex_cells.front(), &cell);
    const bool is_inside = cell != kNoCell && !tetrahedra.IsInfinite(cell);
    located.push_back(
        {position,
         is_inside ? cell : static_cast<uint32_t>(tetrahedra.cells.size())});
  }
  return located;
}

RayMaker::RayMaker(const Tetrahedralization& tetrahedra,
                   const std::vector<Eigen::Vector3f>* points,
                   const VisibilityWeightOptions& options,
                   const VotingPart* part)
    : tetrahedra_(tetrahedra),
      points_(points),
      options_(options),
      part_(part),
      near_distance_(kNearSigmas * options.distance_sigma),
      point_hint_(tetrahedra.vertex_cells.front()),
      way_hint_(point_hint_) {}

Eigen::Vector3d RayMaker::PositionOf(uint32_t vertex) const {
  return (points_ != nullptr ? (*points_)[vertex] : tetrahedra_.points[vertex])
      .cast<double>();
}

const RayMaker::Place& RayMaker::PlaceOf(uint32_t vertex) {
  const auto [it, is_new] = places_.try_emplace(vertex);
  Place& place = it->second;
  if (is_new) {
    place.position =
        MoveOffFacets(tetrahedra_, PositionOf(vertex), options_.distance_sigma,
                      point_hint_, &place.cell);
    if (place.cell != kNoCell && !tetrahedra_.IsInfinite(place.cell)) {
      point_hint_ = place.cell;
    }
  }
  return place;
}

bool RayMaker::ToCenter(uint32_t vertex, const ViewCenter& center, bool is_end,
                        Ray* ray) {
  *ray = {vertex, center.position, center.cell, is_end ? 0 : near_distance_};
  return Start(vertex, (center.position - PositionOf(vertex)).norm(), ray);
}

bool RayMaker::Behind(uint32_t vertex, const ViewCenter& center, bool is_end,
                      Ray* ray) {
  const Eigen::Vector3d position = PositionOf(vertex);
  const Eigen::Vector3d direction = (position - center.position).normalized();
  const double length = options_.behind_sigma * options_.distance_sigma;
  if (is_end) {
    *ray = {vertex, 2 * position - center.position, kToHull, 0};
    return Start(vertex, std::numeric_limits<double>::infinity(), ray);
  }
  *ray = {vertex, position + length * direction, kNoCell, near_distance_};
  return Start(vertex, length, ray);
}

bool RayMaker::Start(uint32_t vertex, double length, Ray* ray) {
  ray->position = PositionOf(vertex);
  if (points_ != nullptr) {
    ray->origin = kNoVertex;
  }
  if (part_ != nullptr) {
    const Eigen::Vector3d direction =
        (ray->target - ray->position).normalized();
    const RayRange range = part_->range(ray->position, direction, length);
    if (range.IsEmpty()) {
      return false;
    }
    ray->last_distance = range.end;
    if (range.begin > 0) {
      const uint32_t cell = Locate(
          tetrahedra_, ray->position + range.begin * direction, way_hint_);
      if (!tetrahedra_.IsInfinite(cell)) {
        way_hint_ = cell;
        if (part_->is_inside[cell] == 0) {
          ray->start_cell = cell;
          return true;
        }
      }
    }
  }
  StartAtPoint(vertex, ray);
  return true;
}

bool RayMaker::StartAtPoint(uint32_t vertex, Ray* ray) {
  const uint32_t before = ray->start_cell;
  ray->start_cell = kNoCell;
  if (points_ != nullptr) {
    const Place& place = PlaceOf(vertex);
    ray->position = place.position;
    ray->start_cell = place.cell;
  }
  return ray->start_cell != before;
}

}  // namespace colmap_ext
