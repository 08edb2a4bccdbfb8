#include "refine/refined_confidences.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>

#include <tbb/parallel_for.h>
#include <Eigen/Core>

#include "base/indices.h"
#include "mesh/confidences.h"
#include "mesh/mesh_in_image.h"
#include "refine/smoothness_model.h"
#include "spatial/bvh.h"

namespace colmap_ext {

std::vector<uint8_t> ConfirmedFacets(const TriangleMesh& mesh,
                                     const VertexRings& rings,
                                     const PhotometricTerms& terms,
                                     const PhotometricOptions& options,
                                     double min_zncc) {
  if (min_zncc <= -1) {
    return std::vector<uint8_t>(mesh.facets.size(), 1);
  }
  std::vector<double> energies =
      SumsAtVertices(mesh, terms.facets, &FacetTerms::energy);
  std::vector<double> weights =
      SumsAtVertices(mesh, terms.facets, &FacetTerms::weight);
  AverageOverSurroundings(rings, &energies);
  AverageOverSurroundings(rings, &weights);
  std::vector<uint8_t> is_confirmed(mesh.facets.size(), 0);
  for (size_t i = 0; i < mesh.facets.size(); ++i) {
    double energy = 0;
    double weight = 0;
    for (const uint32_t vertex : mesh.facets[i]) {
      energy += energies[vertex];
      weight += weights[vertex];
    }
    // A facet that is not compared counts as confirmed.
    is_confirmed[i] =
        !(weight > 0) || MeanZncc(energy, weight, options) >= min_zncc;
  }
  return is_confirmed;
}

namespace {

// From a point to the views that see it, of any length; 0 if none does.
Eigen::Vector3d DirectionToViews(const PointCloud& points,
                                 const std::vector<View>& views, size_t point) {
  const Eigen::Vector3d position = points.positions[point].cast<double>();
  Eigen::Vector3d direction = Eigen::Vector3d::Zero();
  for (const uint32_t view : points.views[point]) {
    if (views[view].CamFromWorld(position).z() > 0) {
      direction += (views[view].Center() - position).normalized();
    }
  }
  return direction;
}

// [P] the facet that each point supports, or kNone.
std::vector<uint32_t> SupportedFacets(const TriangleMesh& mesh,
                                      const PointCloud& points,
                                      const std::vector<View>& views) {
  // As far as the refinement may have moved the surface: a choice.
  constexpr double kMaxPixels = 4;
  const Bvh bvh(mesh);
  std::vector<uint32_t> facets(points.size(), kNone);
  tbb::parallel_for(size_t{0}, facets.size(), [&](size_t i) {
    const double footprint =
        NearestFootprint(points.positions[i], points.views[i], views);
    if (std::isfinite(footprint)) {
      facets[i] = bvh.NearestFacet(
          points.positions[i], DirectionToViews(points, views, i).cast<float>(),
          kMaxPixels * footprint);
    }
  });
  return facets;
}

}  // namespace

std::vector<float> PointConfidences(const TriangleMesh& mesh,
                                    const Rows<uint32_t>& vertex_views,
                                    const PointCloud& points,
                                    const std::vector<View>& views) {
  std::vector<float> support(mesh.vertices.size(), 0);
  for (const uint32_t facet : SupportedFacets(mesh, points, views)) {
    if (facet != kNone) {
      for (const uint32_t vertex : mesh.facets[facet]) {
        support[vertex] += 1.0F / 3;
      }
    }
  }
  return VertexConfidences(
      mesh, FacetConfidences(mesh, support, vertex_views, views));
}

std::vector<float> RefinedConfidences(const TriangleMesh& mesh,
                                      const PhotometricTerms& terms,
                                      const PhotometricOptions& options,
                                      const std::vector<float>& before) {
  const std::vector<double> energies =
      SumsAtVertices(mesh, terms.facets, &FacetTerms::energy);
  const std::vector<double> weights =
      SumsAtVertices(mesh, terms.facets, &FacetTerms::weight);
  const std::vector<double> num_pixels =
      SumsAtVertices(mesh, terms.facets, &FacetTerms::num_pixels);
  std::vector<float> confidences = before;
  confidences.resize(mesh.vertices.size(), 0);
  for (size_t i = 0; i < confidences.size(); ++i) {
    if (weights[i] > 0 && num_pixels[i] > 0) {
      const double texture = std::min(weights[i] / num_pixels[i], 1.0);
      const double correlation =
          std::clamp(MeanZncc(energies[i], weights[i], options), 0.0, 1.0);
      confidences[i] += static_cast<float>(
          texture * std::max(0.0, correlation - confidences[i]));
    }
  }
  return confidences;
}

std::vector<float> FrontShares(const VisibilityBuffers& buffers) {
  TriangleMesh turned = buffers.Mesh();
  for (Facet& facet : turned.facets) {
    std::swap(facet[1], facet[2]);
  }
  const FacetVisibility fronts = FindVisibleFacets(buffers);
  const FacetVisibility backs =
      FindVisibleParts(buffers, turned, Iota(turned.facets.size()));
  std::vector<float> shares(turned.facets.size(), 1);
  for (size_t i = 0; i < shares.size(); ++i) {
    const auto f = static_cast<float>(fronts[i].size());
    const auto b = static_cast<float>(backs[i].size());
    shares[i] = b > 0 ? std::max(0.0F, (f - b) / (f + b)) : 1;
  }
  return shares;
}

}  // namespace colmap_ext
