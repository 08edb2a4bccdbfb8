#include "refine/refined_confidences.h"

#include <algorithm>
#include <cstddef>

namespace colmap_ext {
namespace {

// Of what is compared on the facets at a vertex.
struct VertexTerms {
  double energy = 0;
  double weight = 0;
  double num_pixels = 0;
};

}  // namespace

std::vector<float> RefinedConfidences(const TriangleMesh& mesh,
                                      const PhotometricTerms& terms,
                                      const PhotometricOptions& options,
                                      const std::vector<float>& before) {
  std::vector<VertexTerms> sums(mesh.vertices.size());
  for (size_t i = 0; i < mesh.facets.size(); ++i) {
    for (const uint32_t vertex : mesh.facets[i]) {
      sums[vertex].energy += terms.facets[i].energy;
      sums[vertex].weight += terms.facets[i].weight;
      sums[vertex].num_pixels += terms.facets[i].num_pixels;
    }
  }
  std::vector<float> confidences = before;
  confidences.resize(mesh.vertices.size(), 0);
  for (size_t i = 0; i < sums.size(); ++i) {
    const auto& [energy, weight, num_pixels] = sums[i];
    if (weight > 0 && num_pixels > 0) {
      const double texture = std::min(weight / num_pixels, 1.0);
      const double correlation =
          std::clamp(MeanZncc(energy, weight, options), 0.0, 1.0);
      confidences[i] = static_cast<float>((1 - texture) * confidences[i] +
                                          texture * correlation);
    }
  }
  return confidences;
}

}  // namespace colmap_ext
