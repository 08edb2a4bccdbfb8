#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "mesh/triangle_mesh.h"
#include "photometry/pair_warp.h"
#include "photometry/pair_work.h"
#include "photometry/photometric_energy.h"
#include "photometry/window_correlation.h"

namespace colmap_ext {

// What one direction of a pair adds to a facet; see PhotometricTerms.
struct FacetSums {
  float energy = 0;
  float weight = 0;
  float num_pixels = 0;
  std::array<float, 3> slopes{};      // 1 / scene unit
  std::array<float, 6> curvatures{};  // 1 / scene unit^2
};

// Evaluates one direction of a pair at a time, i <- j. Holds scratch: each
// thread has its own.
class DirectionEvaluator {
 public:
  DirectionEvaluator(const PhotometricOptions& options, size_t num_facets);

  // \param mesh  as it is at present.
  // \param facets  those that the pair refines.
  // \param tiles  of image i, see FindTiles().
  // \return [facets]
  std::vector<FacetSums> Evaluate(const DrawnView& i, const DrawnView& j,
                                  const TriangleMesh& mesh,
                                  std::span<const uint32_t> facets,
                                  const std::vector<PixelRectangle>& tiles);

 private:
  void MarkCenters(const PixelRectangle& rectangle,
                   const FacetIdBuffer& drawn_i);
  void AddTile(std::vector<FacetSums>* sums) const;

  PhotometricOptions options_;
  WindowCorrelation correlation_;
  CorrelationTile tile_;
  TileGeometry geometry_;
  std::vector<uint32_t> places_;  // [F] in the pair's facets, or kNotOfPair
};

}  // namespace colmap_ext
