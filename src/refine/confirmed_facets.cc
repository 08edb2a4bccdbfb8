#include "refine/confirmed_facets.h"

#include <algorithm>
#include <cstddef>

#include "refine/surroundings.h"

namespace colmap_ext {

std::vector<uint8_t> ConfirmedFacets(const TriangleMesh& mesh,
                                     const VertexRings& rings,
                                     const PhotometricTerms& terms,
                                     const PhotometricOptions& options) {
  // Of windows that show one surface most have more, of others few.
  constexpr double kMinZncc = 0.5;
  std::vector<double> energies(mesh.vertices.size(), 0);
  std::vector<double> weights(mesh.vertices.size(), 0);
  for (size_t i = 0; i < mesh.facets.size(); ++i) {
    for (const uint32_t vertex : mesh.facets[i]) {
      energies[vertex] += terms.energies[i];
      weights[vertex] += terms.weights[i];
    }
  }
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
    is_confirmed[i] =
        weight > 0 && MeanZncc(energy, weight, options) >= kMinZncc;
  }
  return is_confirmed;
}

}  // namespace colmap_ext
