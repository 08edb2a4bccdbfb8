#include "delaunay/ray_entries.h"

#include <array>
#include <cmath>

#include <Eigen/Geometry>

#include "delaunay/predicates.h"
#include "delaunay/ray_line.h"

namespace colmap_ext {
namespace {

class EntrySearch {
 public:
  EntrySearch(const Tetrahedralization& tetrahedra, const RayLine& line)
      : tetrahedra_(tetrahedra),
        line_(line),
        direction_((line.target - line.origin).normalized()),
        axis_x_(direction_.unitOrthogonal()),
        axis_y_(direction_.cross(axis_x_)) {}

  // \return whether it found none that is near
  bool Run(const CellPart& part, std::vector<uint32_t>* arcs) {
    // Rounding of distances.
    constexpr double kSlack = 1 + 1e-6;
    near_ = kSlack * line_.near_distance;
    behind_ = kSlack * line_.behind_distance;
    part.SearchBorder(line_.origin - behind_ * direction_, line_.target,
                      [&](uint32_t arc) { Visit(arc, arcs); });
    return !is_near_;
  }

 private:
  void Visit(uint32_t arc, std::vector<uint32_t>* arcs) {
    const auto& vertices = tetrahedra_.cells[arc / 4].vertices;
    const auto& inward = kFacetCorners[arc % 4];
    const std::array<uint32_t, 3> corners = {
        vertices[inward[0]], vertices[inward[2]], vertices[inward[1]]};
    const int num_left = NumLeftTurns(corners);
    if (num_left != 0 && num_left != 3) {
      return;
    }
    const double distance =
        FacetDistance(tetrahedra_, corners, line_.origin, direction_);
    if (!(distance > near_)) {
      is_near_ = is_near_ || !(distance < -behind_);
    } else if (num_left == 3 && Passes(corners)) {
      arcs->push_back(arc);
    }
  }

  // How many of a facet's edges turn counter-clockwise around the ray. All: it
  // leaves the cell there; none: it enters.
  int NumLeftTurns(const std::array<uint32_t, 3>& corners) const {
    std::array<double, 3> x;
    std::array<double, 3> y;
    std::array<double, 3> size;
    for (size_t i = 0; i < 3; ++i) {
      const Eigen::Vector3d offset = At(corners[i]) - line_.origin;
      x[i] = offset.dot(axis_x_);
      y[i] = offset.dot(axis_y_);
      size[i] = offset.lpNorm<1>();
    }
    int num_left = 0;
    for (size_t i = 0; i < 3; ++i) {
      const size_t k = (i + 1) % 3;
      const double turn = x[i] * y[k] - y[i] * x[k];
      const bool is_sure = std::abs(turn) > kTurnErrorBound * size[i] * size[k];
      num_left += is_sure ? turn > 0 : TurnsExactly(corners[i], corners[k]);
    }
    return num_left;
  }

  [[gnu::noinline]] bool TurnsExactly(uint32_t u, uint32_t v) const {
    return RaySideExact(line_.origin, line_.target, At(u), At(v)) > 0;
  }

  // Whether the facet lies between the origin and the target.
  bool Passes(const std::array<uint32_t, 3>& corners) const {
    const auto side = [&](const Eigen::Vector3d& place) {
      return Orientation(At(corners[0]), At(corners[1]), At(corners[2]), place);
    };
    return side(line_.origin) < 0 && side(line_.target) > 0;
  }

  Eigen::Vector3d At(uint32_t vertex) const {
    return tetrahedra_.points[vertex].cast<double>();
  }

  const Tetrahedralization& tetrahedra_;
  const RayLine& line_;
  Eigen::Vector3d direction_;
  Eigen::Vector3d axis_x_;
  Eigen::Vector3d axis_y_;
  double near_ = 0;
  double behind_ = 0;
  bool is_near_ = false;
};

}  // namespace

bool FindEntries(const Tetrahedralization& tetrahedra, const CellPart& part,
                 const RayLine& line, std::vector<uint32_t>* arcs) {
  arcs->clear();
  return line.origin != line.target &&
         EntrySearch(tetrahedra, line).Run(part, arcs);
}

}  // namespace colmap_ext
