#include "delaunay/ray_walk.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <unordered_set>
#include <utility>

#include <Eigen/Geometry>

#include "spatial/predicates.h"

namespace colmap_ext {
namespace {

using Eigen::Vector3d;
using FacetPoints = std::array<Vector3d, 3>;

// The corners of a cell's facet i, see kFacetCorners.
// \pre they are finite
FacetPoints PointsOfFacet(const Tetrahedralization& tetrahedra, uint32_t cell,
                          int i) {
  const auto [a, b, c] = FacetVertices(tetrahedra.cells[cell], i);
  return {tetrahedra.PositionOf(a), tetrahedra.PositionOf(b),
          tetrahedra.PositionOf(c)};
}

// Whether a point lies on a facet's inner side: 1, in its plane: 0, or
// outside: -1.
int InnerSide(const FacetPoints& facet, const Vector3d& point) {
  return Orientation(facet[0], facet[1], facet[2], point);
}

// A ray on its way: the cell where it is, and the facet through which it
// leaves.
class Walk {
 public:
  Walk(const Tetrahedralization& tetrahedra, const Ray& ray, RayPath* path)
      : tetrahedra_(&tetrahedra),
        origin_(ray.origin != kNone ? tetrahedra.PositionOf(ray.origin)
                                    : ray.position),
        ray_(&ray),
        path_(path),
        direction_(ray.target - origin_),
        length_(direction_.norm()) {
    path_->crossings.clear();
    path_->end = kNone;
  }

  // Finds the first cell.
  // \return false where the walk has ended
  bool Start() {
    if (!(length_ > 0)) {
      return false;
    }
    // Right-handed: axis_x x axis_y is the direction.
    direction_ /= length_;
    axis_x_ = direction_.unitOrthogonal();
    axis_y_ = direction_.cross(axis_x_);
    const bool is_started = ray_->origin != kNone
                                ? StartAtVertex(ray_->origin)
                                : StartInCell(ray_->start_cell);
    if (!is_started) {
      path_->end = cell_;
    }
    return is_started;
  }

  // A step has three parts. Between them others may take theirs, while memory
  // that the next part needs is fetched.

  // The first part: finds the next cell.
  // \return false where the walk has ended
  bool Leave() {
    if (cell_ == ray_->end) {
      path_->end = cell_;
      return false;
    }
    // A line crosses a cell once; more crossings would be a bug of ours, which
    // must not hang.
    if (path_->crossings.size() > tetrahedra_->cells.size()) {
      return false;
    }
    distance_ = std::numeric_limits<float>::infinity();
    if (is_near_ && !MeasureExit()) {
      path_->end = cell_;
      return false;
    }
    next_ = tetrahedra_->cells[cell_].neighbors[exit_];
    __builtin_prefetch(&tetrahedra_->cells[next_]);
    return true;
  }

  // The second part: crosses the facet.
  void Enter() {
    const uint32_t entry = tetrahedra_->FacetTo(next_, cell_);
    path_->crossings.push_back(
        {4 * cell_ + exit_, 4 * next_ + entry, distance_});
    cell_ = next_;
    apex_ = tetrahedra_->cells[cell_].vertices[entry];
    if (apex_ != kInfiniteVertex) {
      __builtin_prefetch(&tetrahedra_->points[apex_]);
    }
  }

  // The third part: finds the facet through which the ray leaves the cell that
  // it just entered. Its corners turn counter-clockwise around the ray, as
  // those of the entry do: the apex takes the place of the corner that the exit
  // does not have.
  // \return false where the walk has ended
  bool FindExit() {
    if (apex_ == kInfiniteVertex) {
      path_->end = cell_;
      return false;
    }
    const Across apex = AcrossRay(apex_);
    const unsigned turns = TurnsTo(apex);
    // The exit is opposite to the corner whose successor's edge does not turn
    // and whose predecessor's does. All or none is no line in general position.
    constexpr std::array<uint8_t, 8> kLeftCorner = {0, 1, 2, 1, 0, 0, 2, 0};
    const unsigned left = kLeftCorner[turns];
    exit_ = tetrahedra_->IndexOf(cell_, corners_[left]);
    corners_[left] = apex_;
    across_[left] = apex;
    return true;
  }

 private:
  // A corner's offset from the ray's origin: across the ray, and the sum of the
  // absolute components.
  struct Across {
    double x;
    double y;
    double size;
  };

  // Finds the facet through which the ray leaves the cell that it starts in.
  // \return false where it misses the hull
  bool StartInCell(uint32_t cell) {
    cell_ = cell;
    if (tetrahedra_->IsInfinite(cell)) {
      return StartBeyondHull();
    }
    SetExit(cell, 0);
    // A ray that enters the cell leaves it through one facet.
    while (FirstEdgePassedOutside() >= 0 && exit_ < 3) {
      SetExit(cell, exit_ + 1);
    }
    return true;
  }

  // Finds the facet of the hull through which the ray comes in, among those
  // that its origin sees, which are connected.
  bool StartBeyondHull() {
    std::vector<uint32_t> queue(1, cell_);
    std::unordered_set<uint32_t> seen(queue.begin(), queue.end());
    for (size_t i = 0; i < queue.size(); ++i) {
      SetExit(queue[i], tetrahedra_->IndexOf(queue[i], kInfiniteVertex));
      if (Orientation(Corner(0), Corner(1), Corner(2), origin_) >= 0) {
        continue;  // The exit turns its inner side to the origin.
      }
      if (FirstEdgePassedOutside() < 0) {
        cell_ = queue[i];
        return ray_->end == kToHull || IsTargetBeyondExit();
      }
      const auto& neighbors = tetrahedra_->cells[queue[i]].neighbors;
      for (uint32_t k = 0; k < 4; ++k) {
        if (k != exit_ && seen.insert(neighbors[k]).second) {
          queue.push_back(neighbors[k]);
        }
      }
    }
    return false;
  }

  Vector3d Corner(int i) const { return tetrahedra_->PositionOf(corners_[i]); }

  // Whether the ray crosses the exit before it reaches the target.
  bool IsTargetBeyondExit() const {
    return RaySideExact(Corner(0), ray_->target, Corner(1), Corner(2)) > 0;
  }

  // Finds the cell around the vertex that the ray enters, by a visibility walk.
  // \return false where the ray leaves the hull at once; the cell is infinite.
  bool StartAtVertex(uint32_t vertex) {
    cell_ = tetrahedra_->vertex_cells[vertex];
    for (;;) {
      SetExit(cell_, tetrahedra_->IndexOf(cell_, vertex));
      const int edge = FirstEdgePassedOutside();
      if (edge < 0) {
        return true;
      }
      const uint32_t opposite = corners_[(edge + 2) % 3];
      cell_ = tetrahedra_->cells[cell_]
                  .neighbors[tetrahedra_->IndexOf(cell_, opposite)];
      if (tetrahedra_->IsInfinite(cell_)) {
        return false;
      }
    }
  }

  // From the origin to the facet through which the ray leaves the cell, scene
  // units. Its rounding depends on the ray and the facet alone and not on the
  // way there.
  double ExitDistance() const {
    const auto [first, second, third] = FromLowest(*tetrahedra_, corners_);
    const Vector3d a = Offset(first);
    const Vector3d ab = Offset(second) - a;
    const Vector3d ac = Offset(third) - a;
    const Vector3d normal = ab.cross(ac);
    const double slope = direction_.dot(normal);
    // Of a facet along the ray, or of hardly an area, rounding leaves little.
    constexpr double kMinSlope = 1e-6;
    if (slope * slope >
        kMinSlope * kMinSlope * ab.squaredNorm() * ac.squaredNorm()) {
      return a.dot(normal) / slope;
    }
    return length_ * CrossingOfPlane(origin_, ray_->target, Corner(0),
                                     Corner(1), Corner(2));
  }

  // Sets the distance of the exit.
  // \return false where the target comes first
  bool MeasureExit() {
    const bool ends_at_target = ray_->end == kNone;
    if (ends_at_target && !IsTargetBeyondExit()) {
      return false;
    }
    const double distance = ExitDistance();
    distance_ = static_cast<float>(distance);
    // Facets that meet where the ray passes have one distance but for rounding:
    // one before must not hide that of one behind it.
    constexpr double kSlack = 1e-6;
    is_near_ = ends_at_target || distance <= (1 + kSlack) * ray_->near_distance;
    return true;
  }

  Vector3d Offset(uint32_t vertex) const {
    return tetrahedra_->PositionOf(vertex) - origin_;
  }

  Across AcrossRay(uint32_t vertex) const {
    const Vector3d offset = Offset(vertex);
    return {offset.dot(axis_x_), offset.dot(axis_y_), offset.lpNorm<1>()};
  }

  void SetExit(uint32_t cell, uint32_t exit) {
    exit_ = exit;
    const auto [a, c, b] = FacetVertices(tetrahedra_->cells[cell], exit);
    corners_ = {a, b, c};  // turned outward
    across_ = {AcrossRay(a), AcrossRay(b), AcrossRay(c)};
  }

  // The edge of the exit facet (from corner i to i + 1) on whose outer side the
  // ray passes, or -1 where it passes within the facet.
  int FirstEdgePassedOutside() const {
    for (int i = 0; i < 3; ++i) {
      const int k = (i + 1) % 3;
      const Across& u = across_[i];
      const Across& v = across_[k];
      const double determinant = u.x * v.y - u.y * v.x;
      const bool is_sure =
          std::abs(determinant) > kErrorBound * u.size * v.size;
      if (is_sure ? determinant < 0 : !TurnsExactly(corners_[i], corners_[k])) {
        return i;
      }
    }
    return -1;
  }

  // Whether the directed edges from the three corners to the apex turn
  // counter-clockwise around the ray (RaySideExact), as bits. In floating point
  // it is the determinant of the offsets across the ray.
  unsigned TurnsTo(const Across& apex) const {
    const auto& [a, b, c] = across_;
    const double d0 = a.x * apex.y - a.y * apex.x;
    const double d1 = b.x * apex.y - b.y * apex.x;
    const double d2 = c.x * apex.y - c.y * apex.x;
    const double largest = std::max(std::max(a.size, b.size), c.size);
    const double least =
        std::min(std::min(std::abs(d0), std::abs(d1)), std::abs(d2));
    if (least > kErrorBound * apex.size * largest) [[likely]] {
      return static_cast<unsigned>(d0 > 0) |
             static_cast<unsigned>(d1 > 0) << 1 |
             static_cast<unsigned>(d2 > 0) << 2;
    }
    return TurnsExactly(corners_[0], apex_) |
           TurnsExactly(corners_[1], apex_) << 1 |
           TurnsExactly(corners_[2], apex_) << 2;
  }

  [[gnu::noinline]] unsigned TurnsExactly(uint32_t u, uint32_t v) const {
    return RaySideExact(origin_, ray_->target, tetrahedra_->PositionOf(u),
                        tetrahedra_->PositionOf(v)) > 0;
  }

  // Each of the four factors of a determinant is off by less than 8 e times the
  // size of its corner (the axes by 4 e, the product's three terms by the
  // rest), e = 2^-53, and so the determinant by less than 40 e times both
  // sizes.
  static constexpr double kErrorBound = 40 * 0x1p-53;

  const Tetrahedralization* tetrahedra_;
  Vector3d origin_;
  const Ray* ray_;
  RayPath* path_;
  Vector3d direction_;  // unit
  double length_;
  Vector3d axis_x_;
  Vector3d axis_y_;

  uint32_t cell_ = kNone;
  uint32_t next_ = kNone;
  uint32_t exit_ = 0;
  uint32_t apex_ = kInfiniteVertex;  // the corner opposite to the entry
  bool is_near_ = true;
  float distance_ = 0;  // of the exit
  // The corners of the exit, normal along the ray, and their offsets.
  std::array<uint32_t, 3> corners_;
  std::array<Across, 3> across_;
};

// How many rays take turns. Tuned on: fountain; by: 4, 8 and 16.
constexpr size_t kNumTurns = 16;

}  // namespace

void WalkRays(const Tetrahedralization& tetrahedra, std::span<const Ray> rays,
              std::span<RayPath> paths) {
  std::vector<Walk> walks;
  walks.reserve(kNumTurns);
  // Drops a walk that has ended; the last one takes its place.
  const auto drop = [&walks](size_t i) {
    walks[i] = walks.back();
    walks.pop_back();
  };
  for (size_t num_started = 0; num_started < rays.size() || !walks.empty();) {
    while (walks.size() < kNumTurns && num_started < rays.size()) {
      walks.emplace_back(tetrahedra, rays[num_started], &paths[num_started]);
      ++num_started;
      if (!walks.back().Start()) {
        walks.pop_back();
      }
    }
    for (size_t i = walks.size(); i-- > 0;) {
      if (!walks[i].Leave()) {
        drop(i);
      }
    }
    for (Walk& walk : walks) {
      walk.Enter();
    }
    for (size_t i = walks.size(); i-- > 0;) {
      if (!walks[i].FindExit()) {
        drop(i);
      }
    }
  }
}

uint32_t Locate(const Tetrahedralization& tetrahedra, const Vector3d& point,
                uint32_t hint) {
  uint32_t cell_index = hint;
  uint32_t previous = kNone;
  for (int i = 0; i < 4 && !tetrahedra.IsInfinite(cell_index);) {
    const uint32_t next = tetrahedra.cells[cell_index].neighbors[i];
    const bool leaves =
        next != previous &&
        InnerSide(PointsOfFacet(tetrahedra, cell_index, i), point) < 0;
    if (leaves) {
      previous = std::exchange(cell_index, next);
    }
    i = leaves ? 0 : i + 1;
  }
  return cell_index;
}

uint32_t EnteredCell(const Tetrahedralization& tetrahedra, uint32_t cell_index,
                     const Vector3d& origin, const Vector3d& target) {
  for (int i = 0; i < 4 && !tetrahedra.IsInfinite(cell_index);) {
    const FacetPoints facet = PointsOfFacet(tetrahedra, cell_index, i);
    const bool leaves = InnerSide(facet, origin) == 0 &&
                        RaySideExact(facet[0], target, facet[1], facet[2]) < 0;
    if (leaves) {
      cell_index = tetrahedra.cells[cell_index].neighbors[i];
    }
    i = leaves ? 0 : i + 1;
  }
  return cell_index;
}

bool IsStrictlyInside(const Tetrahedralization& tetrahedra, uint32_t cell_index,
                      const Vector3d& point) {
  return std::ranges::all_of(std::array{0, 1, 2, 3}, [&](int i) {
    return InnerSide(PointsOfFacet(tetrahedra, cell_index, i), point) > 0;
  });
}

}  // namespace colmap_ext
