#pragma once

#include <array>
#include <bit>
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

// The places of some facets of a mesh in a list of them: a bit a facet, and how
// many come before each 64. Each thread has one.
class FacetPlaces {
 public:
  explicit FacetPlaces(size_t num_facets) : words_(num_facets / 64 + 1) {}

  // \param facets  ascending.
  void Set(std::span<const uint32_t> facets);
  // \param facets  those that were set.
  void Clear(std::span<const uint32_t> facets);

  bool Has(uint32_t facet) const {
    return (words_[facet / 64].bits >> facet % 64 & 1) != 0;
  }
  // \pre Has(facet)
  uint32_t operator[](uint32_t facet) const {
    const Word& word = words_[facet / 64];
    const uint64_t before = word.bits & ((uint64_t{1} << facet % 64) - 1);
    return word.num_before + static_cast<uint32_t>(std::popcount(before));
  }

 private:
  struct Word {
    uint64_t bits = 0;
    uint32_t num_before = 0;
  };

  std::vector<Word> words_;
};

// Evaluates one direction of a pair at a time, i <- j. Holds scratch: each
// thread has its own.
class DirectionEvaluator {
 public:
  DirectionEvaluator(const PhotometricOptions& options, size_t num_facets);

  // \param mesh  as it is at present.
  // \param facets  those that the pair refines, ascending.
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
  FacetPlaces places_;  // of the pair's facets
};

}  // namespace colmap_ext
