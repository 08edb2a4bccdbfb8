#include "refine/confirmed_facets.h"

#include <algorithm>
#include <cstddef>

#include "refine/surroundings.h"

namespace colmap_ext {

std::vector<uint8_t> ConfirmedFacets(const TriangleMesh& mesh,
                                     const VertexRings& rings,
                                     const PhotometricTerms& terms,
                                     const PhotometricOptions& options,
                                     double min_zncc) {
  if (min_zncc <= -1) {
    return std::vector<uint8_t>(mesh.facets.size(), 1);
  }
  std::vector<double> energies(mesh.vertices.size(), 0);
  std::vector<double> weights(mesh.vertices.size(), 0);
  for (size_t i = 0; i < mesh.facets.size(); ++i) {
    for (const uint32_t vertex : mesh.facets[i]) {
      energies[vertex] += terms.facets[i].energy;
      weights[vertex] += terms.facets[i].weight;
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
    // Where nothing is compared nothing speaks against the surface.
    is_confirmed[i] =
        !(weight > 0) || MeanZncc(energy, weight, options) >= min_zncc;
  }
  return is_confirmed;
}

}  // namespace colmap_ext
