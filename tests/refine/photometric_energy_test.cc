#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include <gtest/gtest.h>

#include "refine/cpu_photometric_energy.h"
#include "refine/facet_frames.h"
#include "refine/view_pairs.h"
#include "tests/refine/refinement_scene.h"

namespace colmap_ext {
namespace {

// Every facet gets every pair.
FacetLabels LabelAll(const std::vector<ViewPair>& pairs, size_t num_facets) {
  FacetLabels labels;
  labels.pairs = pairs;
  for (size_t i = 0; i < num_facets; ++i) {
    for (uint32_t k = 0; k < pairs.size(); ++k) {
      labels.labels.push_back(k);
    }
    labels.offsets.push_back(labels.labels.size());
  }
  return labels;
}

// dE / dV, [V].
std::vector<Eigen::Vector3d> Gradient(const TriangleMesh& mesh,
                                      const PhotometricTerms& terms) {
  const std::vector<FacetFrame> frames = ComputeFacetFrames(mesh);
  std::vector<Eigen::Vector3d> gradient(mesh.vertices.size(),
                                        Eigen::Vector3d::Zero());
  for (size_t i = 0; i < mesh.facets.size(); ++i) {
    for (int k = 0; k < 3; ++k) {
      gradient[mesh.facets[i][k]] += terms.slopes[i][k] * frames[i].normal;
    }
  }
  return gradient;
}

TEST(CpuPhotometricEnergy, GradientIsThatOfFiniteDifferences) {
  const RefinementScene scene = MakeRefinementScene();
  TriangleMesh mesh = scene.Truth();
  std::mt19937 random(1);
  std::normal_distribution<float> noise;
  for (size_t i = 0; i < mesh.vertices.size(); ++i) {
    mesh.vertices[i] += 0.3F * scene.dense.scene.footprint * noise(random) *
                        scene.dense.scene.normals[i];
  }
  const auto energy = MakeCpuPhotometricEnergy({}, scene.Pyramid(), SIZE_MAX);
  energy->Render(mesh);
  const FacetLabels labels = LabelAll({{0, 1}}, mesh.facets.size());
  const PhotometricTerms terms = energy->Evaluate(mesh, labels);
  printf("energy %g, facets %zu pixels %g weight %g\n", terms.energy,
         mesh.facets.size(),
         std::accumulate(terms.num_pixels.begin(), terms.num_pixels.end(), 0.0),
         std::accumulate(terms.weights.begin(), terms.weights.end(), 0.0));
  const std::vector<Eigen::Vector3d> gradient = Gradient(mesh, terms);
  std::vector<size_t> order(mesh.vertices.size());
  for (size_t i = 0; i < order.size(); ++i) order[i] = i;
  std::sort(order.begin(), order.end(), [&](size_t a, size_t b) {
    return gradient[a].norm() > gradient[b].norm();
  });
  double dot = 0, aa = 0, bb = 0;
  for (int n = 0; n < 60; ++n) {
    const size_t vertex = order[n * order.size() / 600];
    Eigen::Vector3d numeric;
    for (int axis = 0; axis < 3; ++axis) {
      const float step = 0.01F * scene.dense.scene.footprint;
      TriangleMesh moved = mesh;
      moved.vertices[vertex][axis] += step;
      const double above = energy->Evaluate(moved, labels).energy;
      const double upper = moved.vertices[vertex][axis];
      moved.vertices[vertex][axis] = mesh.vertices[vertex][axis] - step;
      const double below = energy->Evaluate(moved, labels).energy;
      numeric[axis] = (above - below) / (upper - moved.vertices[vertex][axis]);
    }
    const double cosine = numeric.dot(gradient[vertex]) / numeric.norm() /
                          gradient[vertex].norm();
    printf("%zu %g %g cos %g ratio %g\n", vertex, numeric.norm(),
           gradient[vertex].norm(), cosine,
           gradient[vertex].norm() / numeric.norm());
    dot += numeric.dot(gradient[vertex]);
    aa += numeric.squaredNorm();
    bb += gradient[vertex].squaredNorm();
  }
  printf("all: %g\n", dot / std::sqrt(aa * bb));
}

}  // namespace
}  // namespace colmap_ext
