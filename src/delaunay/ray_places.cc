#include "delaunay/ray_places.h"

#include "delaunay/locate.h"

namespace colmap_ext {

RayPlace FindPlace(const Tetrahedralization& tetrahedra,
                   const Eigen::Vector3d& position, double sigma,
                   uint32_t hint) {
  constexpr int kMaxTries = 64;
  RayPlace place;
  for (int k = 0; k < kMaxTries; ++k) {
    place.position =
        position + 1e-6 * sigma * k * Eigen::Vector3d(1, 0.618, 0.382);
    const uint32_t cell = Locate(tetrahedra, place.position, hint);
    if (tetrahedra.IsInfinite(cell) ||
        IsStrictlyInside(tetrahedra, cell, place.position)) {
      place.cell = cell;
      break;
    }
  }
  return place;
}

std::vector<RayPlace> LocateCenters(const Tetrahedralization& tetrahedra,
                                    const std::vector<Eigen::Vector3d>& centers,
                                    double sigma) {
  std::vector<RayPlace> located(centers.size());
  for (size_t i = 0; i < centers.size(); ++i) {
    const RayPlace place = FindPlace(tetrahedra, centers[i], sigma,
                                     tetrahedra.vertex_cells.front());
    const bool is_inside =
        place.cell != kNoCell && !tetrahedra.IsInfinite(place.cell);
    located[i] = {place.position,
                  is_inside ? place.cell
                            : static_cast<uint32_t>(tetrahedra.cells.size())};
  }
  return located;
}

}  // namespace colmap_ext
