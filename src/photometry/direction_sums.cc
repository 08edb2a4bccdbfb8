#include "photometry/direction_sums.h"

#include <algorithm>

namespace colmap_ext {

namespace {

// \param phi  barycentric coordinates of the pixel on its facet.
void AddDerivatives(const std::array<float, 3>& phi, float slope,
                    float curvature, FacetSums* sum) {
  for (int k = 0, m = 0; k < 3; ++k) {
    sum->slopes[k] += phi[k] * slope;
    for (int l = k; l < 3; ++l, ++m) {
      sum->curvatures[m] += phi[k] * phi[l] * curvature;
    }
  }
}

}  // namespace

void FacetPlaces::Set(std::span<const uint32_t> facets) {
  for (uint32_t k = 0; k < facets.size(); ++k) {
    Word& word = words_[facets[k] / 64];
    if (word.bits == 0) {
      word.num_before = k;
    }
    word.bits |= uint64_t{1} << facets[k] % 64;
  }
}

void FacetPlaces::Clear(std::span<const uint32_t> facets) {
  for (const uint32_t facet : facets) {
    words_[facet / 64].bits = 0;
  }
}

DirectionEvaluator::DirectionEvaluator(const PhotometricOptions& options,
                                       size_t num_facets)
    : options_(options), correlation_(options), places_(num_facets) {}

// Those of the rectangle that show one of the pair's facets.
void DirectionEvaluator::MarkCenters(const PixelRectangle& rectangle,
                                     const FacetIdBuffer& drawn_i) {
  std::fill(tile_.is_center.begin(), tile_.is_center.end(), 0);
  for (int row = rectangle.first_row; row <= rectangle.last_row; ++row) {
    const uint32_t* shown = drawn_i.facets.data() + drawn_i.Index(row, 0);
    for (int col = rectangle.first_col; col <= rectangle.last_col; ++col) {
      tile_.is_center[tile_.Index(row - geometry_.first_row,
                                  col - geometry_.first_col)] =
          shown[col] != kNone && places_.Has(shown[col]);
    }
  }
}

// Adds a tile's sums to the pair's facets. Pixels of other facets are part of
// the windows, but get no derivative.
void DirectionEvaluator::AddTile(std::vector<FacetSums>* sums) const {
  for (int row = 0; row < tile_.height; ++row) {
    for (int col = 0; col < tile_.width; ++col) {
      const size_t at = tile_.Index(row, col);
      const uint32_t facet = geometry_.facets[at];
      if (facet == kNone || !places_.Has(facet)) {
        continue;
      }
      FacetSums& sum = (*sums)[places_[facet]];
      if (tile_.weights[at] > 0) {
        sum.energy += tile_.energies[at];
        sum.weight += tile_.weights[at];
        sum.num_pixels += 1;
      }
      const float motion = geometry_.motion[at];
      AddDerivatives(geometry_.barycentric[at], tile_.derivatives[at] * motion,
                     tile_.curvatures[at] * motion * motion, &sum);
    }
  }
}

std::vector<FacetSums> DirectionEvaluator::Evaluate(
    const DrawnView& i, const DrawnView& j, const TriangleMesh& mesh,
    std::span<const uint32_t> facets,
    const std::vector<PixelRectangle>& tiles) {
  places_.Set(facets);
  const PairWarp warp(i, j, mesh);
  constexpr int kMultiple = 8;  // see WindowRows
  const int radius = options_.window_radius;
  const float max_relative_depth = MaxRelativeDepth(options_, i.view);
  std::vector<FacetSums> sums(facets.size());
  for (const PixelRectangle& rectangle : tiles) {
    const int width = rectangle.last_col - rectangle.first_col + 1 + 2 * radius;
    tile_.Resize((width + kMultiple - 1) / kMultiple * kMultiple,
                 rectangle.last_row - rectangle.first_row + 1 + 2 * radius);
    geometry_.first_row = rectangle.first_row - radius;
    geometry_.first_col = rectangle.first_col - radius;
    MarkCenters(rectangle, i.drawn);
    tile_.FindReached(radius);
    warp.Compute(&tile_, &geometry_);
    correlation_.Compute(max_relative_depth, &tile_);
    AddTile(&sums);
  }
  places_.Clear(facets);
  return sums;
}

}  // namespace colmap_ext
