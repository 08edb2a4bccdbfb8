#include "delaunay/ray_walk.h"

#include <array>
#include <cmath>
#include <utility>

#include <Eigen/Geometry>

#include "delaunay/predicates.h"

namespace colmap_ext {
namespace {

using Cell = Tetrahedralization::Cell;

// A vertex as the ray sees it.
struct Corner {
  uint32_t vertex;
  double x, y;  // its offset from the ray's origin, across the ray
  double size;  // sum of the absolute components of the offset
};

// A ray on its way: the cell where it is, and the facet through which it
// leaves.
class Walk {
 public:
  Walk(const Tetrahedralization& tetrahedra, uint32_t origin,
       const Eigen::Vector3d& target)
      : tetrahedra_(tetrahedra),
        origin_(tetrahedra.points[origin].cast<double>()),
        target_(target),
        direction_(target - origin_),
        length_(direction_.norm()) {
    if (length_ > 0) {
      // Right-handed: axis_x x axis_y is the direction.
      direction_ /= length_;
      axis_x_ = direction_.unitOrthogonal();
      axis_y_ = direction_.cross(axis_x_);
    }
  }

  uint32_t cell() const { return cell_; }
  double length() const { return length_; }

  // Finds the cell around the vertex that the ray enters, by a visibility walk.
  // \return false where the ray leaves the hull at once; the cell is infinite.
  bool StartAtVertex(uint32_t vertex) {
    cell_ = tetrahedra_.vertex_cells[vertex];
    for (;;) {
      const Cell& cell = tetrahedra_.cells[cell_];
      exit_ = tetrahedra_.IndexOf(cell_, vertex);
      SetExitCorners(cell);
      const int edge = FirstEdgePassedOutside();
      if (edge < 0) {
        return true;
      }
      const uint32_t opposite = corners_[(edge + 2) % 3].vertex;
      cell_ = cell.neighbors[tetrahedra_.IndexOf(cell_, opposite)];
      if (tetrahedra_.IsInfinite(cell_)) {
        return false;
      }
    }
  }

  // From the origin to the facet through which the ray leaves the cell, scene
  // units.
  double ExitDistance() const {
    const Eigen::Vector3d a = Offset(corners_[0].vertex);
    const Eigen::Vector3d normal =
        (Offset(corners_[1].vertex) - a).cross(Offset(corners_[2].vertex) - a);
    return a.dot(normal) / direction_.dot(normal);
  }

  // Crosses the facet.
  void Leave(float distance, std::vector<Crossing>* crossings) {
    const uint32_t next = tetrahedra_.cells[cell_].neighbors[exit_];
    entry_ = tetrahedra_.FacetTo(next, cell_);
    crossings->push_back({4 * cell_ + exit_, 4 * next + entry_, distance});
    cell_ = next;
  }

  // Finds the facet through which the ray leaves the cell that it just entered.
  // Its corners turn counter-clockwise around the ray, as those of the entry
  // do: the apex takes the place of the corner that the exit does not have.
  // \return false where the cell is infinite
  bool FindExit() {
    const uint32_t vertex = tetrahedra_.cells[cell_].vertices[entry_];
    if (vertex == kInfiniteVertex) {
      return false;
    }
    const Corner apex = CornerAt(vertex);
    // Of the edges from the entry's corners to the apex: which ones turn
    // counter-clockwise, as bits.
    const unsigned turns = TurnsAround(corners_[0], apex) |
                           TurnsAround(corners_[1], apex) << 1 |
                           TurnsAround(corners_[2], apex) << 2;
    // The exit is opposite to the corner whose successor's edge does not turn
    // and whose predecessor's does. All or none is no line in general position.
    constexpr std::array<uint8_t, 8> kLeftCorner = {0, 1, 2, 1, 0, 0, 2, 0};
    const unsigned left = kLeftCorner[turns];
    exit_ = tetrahedra_.IndexOf(cell_, corners_[left].vertex);
    corners_[left] = apex;
    return true;
  }

 private:
  Eigen::Vector3d Offset(uint32_t vertex) const {
    return tetrahedra_.points[vertex].cast<double>() - origin_;
  }

  Corner CornerAt(uint32_t vertex) const {
    const Eigen::Vector3d offset = Offset(vertex);
    return {vertex, offset.dot(axis_x_), offset.dot(axis_y_),
            offset.lpNorm<1>()};
  }

  void SetExitCorners(const Cell& cell) {
    const auto& inward = kFacetCorners[exit_];
    corners_ = {CornerAt(cell.vertices[inward[0]]),
                CornerAt(cell.vertices[inward[2]]),
                CornerAt(cell.vertices[inward[1]])};
  }

  // The edge of the exit facet (from corner i to i + 1) on whose outer side the
  // ray passes, or -1 where it passes within the facet.
  int FirstEdgePassedOutside() const {
    for (int i = 0; i < 3; ++i) {
      if (!TurnsAround(corners_[i], corners_[(i + 1) % 3])) {
        return i;
      }
    }
    return -1;
  }

  // Whether the directed edge from u to v turns counter-clockwise around the
  // ray (RaySideExact). In floating point it is the determinant of the offsets
  // across the ray. Each of its four factors is off by less than 8 e times the
  // size of its corner (the axes by 4 e, the product's three terms by the
  // rest), e = 2^-53, and so the determinant by less than 40 e times both
  // sizes.
  unsigned TurnsAround(const Corner& u, const Corner& v) const {
    constexpr double kErrorBound = 40 * 0x1p-53;
    const double determinant = u.x * v.y - u.y * v.x;
    if (std::abs(determinant) > kErrorBound * u.size * v.size) [[likely]] {
      return determinant > 0;
    }
    return RaySideExact(origin_, target_,
                        tetrahedra_.points[u.vertex].cast<double>(),
                        tetrahedra_.points[v.vertex].cast<double>()) > 0;
  }

  const Tetrahedralization& tetrahedra_;
  const Eigen::Vector3d origin_;
  const Eigen::Vector3d target_;
  Eigen::Vector3d direction_;  // unit
  const double length_;
  Eigen::Vector3d axis_x_;
  Eigen::Vector3d axis_y_;

  uint32_t cell_ = kNoCell;
  uint32_t entry_ = 0;
  uint32_t exit_ = 0;
  std::array<Corner, 3> corners_;  // of the exit, normal along the ray
};

}  // namespace

uint32_t WalkRay(const Tetrahedralization& tetrahedra, uint32_t origin,
                 const Eigen::Vector3d& target, uint32_t end,
                 double near_distance, std::vector<Crossing>* crossings) {
  crossings->clear();
  Walk walk(tetrahedra, origin, target);
  if (!(walk.length() > 0)) {
    return kNoCell;
  }
  if (!walk.StartAtVertex(origin)) {
    return walk.cell();
  }
  // A line crosses a cell once; more crossings would be a bug of ours, which
  // must not hang.
  const size_t max_crossings = tetrahedra.cells.size();
  bool is_near = true;
  while (walk.cell() != end && crossings->size() <= max_crossings) {
    float distance = std::numeric_limits<float>::infinity();
    if (is_near) {
      const double exit_distance = walk.ExitDistance();
      if (end == kNoCell && exit_distance >= walk.length()) {
        return walk.cell();
      }
      distance = static_cast<float>(exit_distance);
      is_near = end == kNoCell || exit_distance <= near_distance;
    }
    walk.Leave(distance, crossings);
    if (!walk.FindExit()) {
      return walk.cell();
    }
  }
  return walk.cell() == end ? end : kNoCell;
}

uint32_t Locate(const Tetrahedralization& tetrahedra,
                const Eigen::Vector3d& point, uint32_t hint) {
  uint32_t cell_index = hint;
  uint32_t previous = kNoCell;
  while (!tetrahedra.IsInfinite(cell_index)) {
    const Cell& cell = tetrahedra.cells[cell_index];
    uint32_t next = kNoCell;
    for (int i = 0; i < 4 && next == kNoCell; ++i) {
      if (cell.neighbors[i] == previous) {
        continue;
      }
      const auto& corners = kFacetCorners[i];
      const auto corner = [&](int k) -> Eigen::Vector3d {
        return tetrahedra.points[cell.vertices[corners[k]]].cast<double>();
      };
      if (Orientation(corner(0), corner(1), corner(2), point) < 0) {
        next = cell.neighbors[i];
      }
    }
    if (next == kNoCell) {
      break;
    }
    previous = std::exchange(cell_index, next);
  }
  return cell_index;
}

bool IsStrictlyInside(const Tetrahedralization& tetrahedra, uint32_t cell_index,
                      const Eigen::Vector3d& point) {
  const Cell& cell = tetrahedra.cells[cell_index];
  for (const auto& corners : kFacetCorners) {
    const auto corner = [&](int k) -> Eigen::Vector3d {
      return tetrahedra.points[cell.vertices[corners[k]]].cast<double>();
    };
    if (Orientation(corner(0), corner(1), corner(2), point) <= 0) {
      return false;
    }
  }
  return true;
}

}  // namespace colmap_ext
