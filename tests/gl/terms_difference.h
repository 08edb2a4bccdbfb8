#pragma once

#include <cmath>
#include <numeric>

#include "photometry/photometric_energy.h"

namespace colmap_ext {

// How far two evaluations of the same energy are apart.
struct TermsDifference {
  double relative_energy = 0;
  double gradient_cosine = 0;   // of the slopes, all facets' in one vector
  double gradient_ratio = 0;    // of their lengths
  double curvature_cosine = 0;  // likewise
  double relative_weight = 0;
  double relative_pixels = 0;
};

inline TermsDifference Compare(const PhotometricTerms& terms,
                               const PhotometricTerms& reference) {
  // Over all facets, of the products of a part of them.
  const auto dot = [](const auto& part, const PhotometricTerms& a,
                      const PhotometricTerms& b) {
    double sum = 0;
    for (size_t i = 0; i < a.facets.size(); ++i) {
      const auto& of_a = a.facets[i].*part;
      const auto& of_b = b.facets[i].*part;
      sum += std::inner_product(of_a.begin(), of_a.end(), of_b.begin(), 0.0);
    }
    return sum;
  };
  const auto cosine = [&](const auto& part) {
    return dot(part, terms, reference) /
           std::sqrt(dot(part, terms, terms) * dot(part, reference, reference));
  };
  const auto excess = [&](float FacetTerms::*part) {
    double sum = 0;
    double expected = 0;
    for (size_t i = 0; i < terms.facets.size(); ++i) {
      sum += terms.facets[i].*part;
      expected += reference.facets[i].*part;
    }
    return sum / expected - 1;
  };
  return {terms.energy / reference.energy - 1,
          cosine(&FacetTerms::slopes),
          std::sqrt(dot(&FacetTerms::slopes, terms, terms) /
                    dot(&FacetTerms::slopes, reference, reference)),
          cosine(&FacetTerms::curvatures),
          excess(&FacetTerms::weight),
          excess(&FacetTerms::num_pixels)};
}

}  // namespace colmap_ext
