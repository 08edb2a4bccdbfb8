#include "refine/smoothness_model.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numeric>

#include <tbb/parallel_for.h>

#include "mesh/normals.h"

namespace colmap_ext {
namespace {

// Shorter edges count as this long, in footprints: they cannot stiffen the
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

// Of weight 1, each vertex for one pixel: its coefficient is the square of what
// turns a residual into a curvature in 1 / px.
ThinPlate UnitPlate(const TriangleMesh& mesh, const VertexRings& rings,
                    const std::vector<float>& footprints) {
  const size_t size = mesh.vertices.size();
  return MakeThinPlate({mesh.vertices, VertexNormals(mesh, rings), rings,
                        footprints, std::vector<float>(size, 0)},
                       std::vector<double>(size, 1),
                       std::vector<double>(size, 0));
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

std::vector<double> Relief(const TriangleMesh& mesh, const VertexRings& rings,
                           const std::vector<float>& footprints) {
  return UnitPlate(mesh, rings, footprints).residuals;
}

std::vector<double> TrustedRelief(const TriangleMesh& mesh,
                                  const VertexRings& rings,
                                  const std::vector<float>& footprints) {
  // Sum of the principal curvatures, 1 / px: that of a sphere of 8 px radius.
  // What is curved more is one of the spikes of a mesh that points make.
  constexpr double kMaxCurvature = 0.25;
  const ThinPlate plate = UnitPlate(mesh, rings, footprints);
  std::vector<double> curvatures(plate.residuals.size());  // 1 / px
  for (size_t i = 0; i < curvatures.size(); ++i) {
    const double curvature =
        plate.residuals[i] * std::sqrt(plate.coefficients[i]);
    curvatures[i] = std::abs(curvature) <= kMaxCurvature ? curvature : 0;
  }
  std::vector<double> relief(curvatures.size(), 0);
  tbb::parallel_for(size_t{0}, relief.size(), [&](size_t i) {
    if (!(plate.coefficients[i] > 0) || rings.is_border[i] != 0) {
      return;
    }
    const auto ring = rings.neighbors[i];
    double sum = 0;
    for (const uint32_t neighbor : ring) {
      sum += curvatures[neighbor];
    }
    const double mean = sum / static_cast<double>(ring.size());
    relief[i] = (curvatures[i] + mean) / 2 / std::sqrt(plate.coefficients[i]);
  });
  return relief;
}

std::vector<double> ReliefShares(const VertexRings& rings,
                                 const std::vector<double>& importance,
                                 const std::vector<double>& relief,
                                 const std::vector<double>& surface) {
  // Share of the relief that a vertex has on average. So much more counts as
  // not confirmed, or surroundings with hardly any relief would confirm all of
  // it by chance.
  constexpr double kPrior = 0.1;
  std::vector<double> products(relief.size());
  std::vector<double> squares(relief.size());
  for (size_t i = 0; i < relief.size(); ++i) {
    products[i] = importance[i] * surface[i] * relief[i];
    squares[i] = importance[i] * relief[i] * relief[i];
  }
  const double prior = kPrior / static_cast<double>(relief.size()) *
                       std::accumulate(squares.begin(), squares.end(), 0.0);
  AverageOverSurroundings(rings, &products);
  AverageOverSurroundings(rings, &squares);
  std::vector<double> shares(relief.size(), 0);
  for (size_t i = 0; i < shares.size(); ++i) {
    if (products[i] > 0) {
      shares[i] = std::min(products[i] / (squares[i] + prior), 1.0);
    }
  }
  return shares;
}

}  // namespace colmap_ext
