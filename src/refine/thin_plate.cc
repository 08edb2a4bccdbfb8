#include "refine/thin_plate.h"

#include <algorithm>
#include <cstddef>

#include <tbb/parallel_for.h>

namespace colmap_ext {

namespace {

// Shorter edges count as this long, in footprints: they can not stiffen the
// surface within a pixel, which the images average over.
constexpr double kMinEdge = 0.5;

// Fills one vertex.
// \pre it has neighbors and a footprint
void AddVertex(const PlateSurface& surface, double weight, double relief,
               size_t vertex, ThinPlate* plate) {
  const auto ring = surface.rings.neighbors[vertex];
  float* shares =
      plate->shares.data() + surface.rings.neighbors.offsets[vertex];
  const double min_edge = kMinEdge * surface.footprints[vertex];
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  double sum_length = 0;
  double sum_inverse = 0;
  for (size_t k = 0; k < ring.size(); ++k) {
    const Eigen::Vector3d edge =
        (surface.vertices[ring[k]] - surface.vertices[vertex]).cast<double>();
    const double length = std::max(edge.norm(), min_edge);
    sum += edge / length;
    sum_length += length;
    sum_inverse += 1 / length;
    shares[k] = static_cast<float>(1 / length);
  }
  for (size_t k = 0; k < ring.size(); ++k) {
    shares[k] = static_cast<float>(shares[k] / sum_inverse);
  }
  const double scale =
      4 * surface.footprints[vertex] * sum_inverse / sum_length;
  plate->residuals[vertex] =
      sum.dot(surface.normals[vertex].cast<double>()) / sum_inverse - relief;
  plate->coefficients[vertex] =
      weight * (1 + surface.num_pixels[vertex]) * scale * scale;
}

}  // namespace

double ThinPlate::Energy() const {
  double energy = 0;
  for (size_t i = 0; i < residuals.size(); ++i) {
    energy += 0.5 * coefficients[i] * residuals[i] * residuals[i];
  }
  return energy;
}

ThinPlate MakeThinPlate(const PlateSurface& surface,
                        const std::vector<double>& weights,
                        const std::vector<double>& relief) {
  const size_t size = surface.vertices.size();
  ThinPlate plate;
  plate.residuals.assign(size, 0);
  plate.coefficients.assign(size, 0);
  plate.shares.assign(surface.rings.neighbors.values.size(), 0);
  tbb::parallel_for(size_t{0}, size, [&](size_t i) {
    if (!surface.rings.neighbors[i].empty() && surface.footprints[i] > 0) {
      AddVertex(surface, weights[i], relief[i], i, &plate);
    }
  });
  return plate;
}

}  // namespace colmap_ext
