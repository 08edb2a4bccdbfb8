#pragma once

#include <cstddef>
#include <vector>

#include "evaluation/depth_samples.h"

namespace colmap_ext {

// How many true depths a mesh meets: the protocol of the EPFL data sets
// (Strecha et al. 2008, as Hu and Mordohai 2012 use it).
struct DepthErrors {
  std::vector<double> thresholds;  // [T], scene units, of the absolute error
  std::vector<size_t> num_within;  // [T], strictly below the threshold
  size_t num_depths = 0;           // true ones; those without a depth of the
                                   // mesh are within none
  size_t num_missing = 0;          // of them, without a depth of the mesh

  // NaN if there are no depths.
  double Share(size_t threshold) const;
};

// Counts the pixels of one more view. What is not finite or not positive is no
// depth.
// \pre both maps are of the same size
void AddDepthErrors(const DepthMap& truth, const DepthMap& mesh,
                    DepthErrors* errors);

}  // namespace colmap_ext
