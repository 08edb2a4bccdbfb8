#include "evaluation/depth_errors.h"

#include <cmath>

namespace colmap_ext {
namespace {

bool IsDepth(float depth) { return std::isfinite(depth) && depth > 0; }

}  // namespace

double DepthErrors::Share(size_t threshold) const {
  return static_cast<double>(num_within[threshold]) /
         static_cast<double>(num_depths);
}

void AddDepthErrors(const DepthMap& truth, const DepthMap& mesh,
                    DepthErrors* errors) {
  errors->num_within.resize(errors->thresholds.size(), 0);
  for (size_t i = 0; i < truth.depths.size(); ++i) {
    if (!IsDepth(truth.depths[i])) {
      continue;
    }
    ++errors->num_depths;
    if (!IsDepth(mesh.depths[i])) {
      ++errors->num_missing;
      continue;
    }
    const double error = std::abs(double{mesh.depths[i]} - truth.depths[i]);
    for (size_t t = 0; t < errors->thresholds.size(); ++t) {
      errors->num_within[t] += error < errors->thresholds[t];
    }
  }
}

}  // namespace colmap_ext
