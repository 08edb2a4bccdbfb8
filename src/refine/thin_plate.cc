#include "refine/thin_plate.h"

#include <tbb/parallel_for.h>

namespace colmap_ext {

double ThinPlate::Energy() const {
  double energy = 0;
  for (size_t i = 0; i < residuals.size(); ++i) {
    energy += 0.5 * coefficients[i] * residuals[i] * residuals[i];
  }
  return energy;
}

ThinPlate MakeThinPlate(const std::vector<double>& weights,
                        const std::vector<Eigen::Vector3f>& vertices,
                        const std::vector<Eigen::Vector3f>& normals,
                        const VertexRings& rings,
                        const std::vector<float>& footprints,
                        const std::vector<float>& num_pixels,
                        const std::vector<double>& rest) {
  // Of a pixel, so that edges much shorter than one do not stiffen the surface.
  constexpr double kMinEdge = 0.5;
  ThinPlate plate;
  plate.residuals.assign(vertices.size(), 0);
  plate.coefficients.assign(vertices.size(), 0);
  plate.shares.assign(rings.neighbors.values.size(), 0);
  tbb::parallel_for(size_t{0}, vertices.size(), [&](size_t i) {
    const auto ring = rings.neighbors[i];
    if (rings.is_border[i] != 0 || ring.empty()) {
      return;
    }
    float* shares =
        plate.shares.data() + (ring.data() - rings.neighbors.values.data());
    const double min_edge = kMinEdge * footprints[i];
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    double sum_length = 0;
    double sum_inverse = 0;
    for (size_t k = 0; k < ring.size(); ++k) {
      const Eigen::Vector3d edge =
          (vertices[ring[k]] - vertices[i]).cast<double>();
      const double length = std::max(edge.norm(), min_edge);
      sum += edge / length;
      sum_length += length;
      sum_inverse += 1 / length;
      shares[k] = static_cast<float>(1 / length);
    }
    for (size_t k = 0; k < ring.size(); ++k) {
      shares[k] = static_cast<float>(shares[k] / sum_inverse);
    }
    const double scale = 4 * footprints[i] * sum_inverse / sum_length;
    plate.residuals[i] =
        sum.dot(normals[i].cast<double>()) / sum_inverse - rest[i];
    plate.coefficients[i] = weights[i] * (1 + num_pixels[i]) * scale * scale;
  });
  return plate;
}

}  // namespace colmap_ext
