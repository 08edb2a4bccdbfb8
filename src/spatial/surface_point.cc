#include "spatial/surface_point.h"

namespace colmap_ext {

using Eigen::Vector3d;

SurfacePoint NearestPointOfFacet(const TriangleMesh& mesh, uint32_t facet,
                                 const Eigen::Vector3f& position) {
  const auto corners = CornersOf<double>(mesh, mesh.facets[facet]);
  const Vector3d p = position.cast<double>();
  const Vector3d edge1 = corners[1] - corners[0];
  const Vector3d edge2 = corners[2] - corners[0];
  const Vector3d v = p - corners[0];
  const Vector3d normal = edge1.cross(edge2);
  const double area_squared = normal.squaredNorm();
  if (area_squared > 0) {
    const double weight1 = normal.dot(v.cross(edge2)) / area_squared;
    const double weight2 = normal.dot(edge1.cross(v)) / area_squared;
    if (weight1 >= 0 && weight2 >= 0 && weight1 + weight2 <= 1) {
      return {facet,
              Vector3d(1 - weight1 - weight2, weight1, weight2).cast<float>()};
    }
  }
  Vector3d weights(1, 0, 0);
  double nearest = -1;
  for (int k = 0; k < 3; ++k) {
    const int next = (k + 1) % 3;
    const double t = NearestOnSegment(corners[k], corners[next], p);
    const double distance =
        ((1 - t) * corners[k] + t * corners[next] - p).squaredNorm();
    if (nearest < 0 || distance < nearest) {
      nearest = distance;
      weights.setZero();
      weights[k] = 1 - t;
      weights[next] = t;
    }
  }
  return {facet, weights.cast<float>()};
}

}  // namespace colmap_ext
