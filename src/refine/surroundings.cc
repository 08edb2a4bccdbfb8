#include "refine/surroundings.h"

#include <cstddef>

#include <tbb/parallel_for.h>

namespace colmap_ext {

void AverageOverSurroundings(const VertexRings& rings,
                             std::vector<double>* values) {
  // A round spreads a value by 6/7 edge^2, over two axes. Large enough that the
  // noise of one vertex's evidence averages out over some ten others, small
  // enough that a plastered wall and the cornice above it stay apart.
  constexpr int kRounds = 10;
  std::vector<double> means(values->size());
  for (int round = 0; round < kRounds; ++round) {
    tbb::parallel_for(size_t{0}, values->size(), [&](size_t i) {
      const auto ring = rings.neighbors[i];
      double sum = (*values)[i];
      for (const uint32_t neighbor : ring) {
        sum += (*values)[neighbor];
      }
      means[i] = sum / static_cast<double>(1 + ring.size());
    });
    values->swap(means);
  }
}

}  // namespace colmap_ext
