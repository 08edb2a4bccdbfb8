#include "refine/relief.h"

#include <cmath>
#include <cstddef>

#include <tbb/parallel_for.h>

#include "mesh/vertex_normals.h"
#include "refine/thin_plate.h"

namespace colmap_ext {

namespace {

ThinPlate PlateOf(const TriangleMesh& mesh, const VertexRings& rings,
                  const std::vector<float>& footprints) {
  const size_t size = mesh.vertices.size();
  return MakeThinPlate(std::vector<double>(size, 1), mesh.vertices,
                       VertexNormals(mesh, rings), rings, footprints,
                       std::vector<float>(size, 0),
                       std::vector<double>(size, 0));
}

}  // namespace

std::vector<double> Relief(const TriangleMesh& mesh, const VertexRings& rings,
                           const std::vector<float>& footprints) {
  return PlateOf(mesh, rings, footprints).residuals;
}

std::vector<double> TrustedRelief(const TriangleMesh& mesh,
                                  const VertexRings& rings,
                                  const std::vector<float>& footprints) {
  constexpr double kMaxCurvature = 0.25;  // 1 / px
  const ThinPlate plate = PlateOf(mesh, rings, footprints);
  std::vector<double> curvatures(plate.residuals.size());  // 1 / px
  for (size_t i = 0; i < curvatures.size(); ++i) {
    const double curvature =
        plate.residuals[i] * std::sqrt(plate.coefficients[i]);
    curvatures[i] = std::abs(curvature) <= kMaxCurvature ? curvature : 0;
  }
  std::vector<double> relief(curvatures.size(), 0);
  tbb::parallel_for(size_t{0}, relief.size(), [&](size_t i) {
    if (!(plate.coefficients[i] > 0)) {
      return;
    }
    const auto ring = rings.Neighbors(i);
    double sum = 0;
    for (const uint32_t neighbor : ring) {
      sum += curvatures[neighbor];
    }
    const double mean = sum / static_cast<double>(ring.size());
    relief[i] = (curvatures[i] + mean) / 2 / std::sqrt(plate.coefficients[i]);
  });
  return relief;
}

}  // namespace colmap_ext
