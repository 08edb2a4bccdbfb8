#pragma once

#include <cstddef>
#include <vector>

#include "evaluation/depth_samples.h"

namespace colmap_ext {

// How many true depths the depths of a mesh agree with: the protocol of the
// EPFL data sets [Strecha2008] as [HuMordohai2012] have it (docs/method.md,
// section 8.2).
struct DepthErrors {
  std::vector<double> thresholds;  // [T], scene units, of the absolute error
  std::vector<size_t> num_within;  // [T], strictly below the threshold
  size_t num_depths = 0;           // true ones; those without a depth of the
                                   // mesh are within none
  size_t num_missing = 0;          // of them, without a depth of the mesh

  // Returns num_within over num_depths, 0 ... 1; NaN if there are no depths.
  // \param threshold  its index, < T
  double Share(size_t threshold) const;
};

// Adds the pixels of one more view. A value that is not finite or not positive
// is no depth.
// \pre both maps are of the same size
void AddDepthErrors(const DepthMap& truth, const DepthMap& mesh,
                    DepthErrors* errors);

}  // namespace colmap_ext
