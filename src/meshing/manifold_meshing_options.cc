#include <string>
#include <utility>

#include "meshing/manifold_meshing.h"

namespace colmap_ext {

std::string ManifoldMeshingOptions::Check() const {
  const std::pair<bool, const char*> rules[] = {
      {max_proj_dist >= 0, "max_proj_dist must not be negative"},
      {max_depth_dist >= 0 && max_depth_dist <= 1,
       "max_depth_dist must lie in [0, 1]"},
      {visibility_sigma > 0, "visibility_sigma must be positive"},
      {alpha_vis > 0 && alpha_vis <= 1, "alpha_vis must lie in (0, 1]"},
      {distance_sigma_factor > 0, "distance_sigma_factor must be positive"},
      {behind_sigma > 0, "behind_sigma must be positive"},
      {quality_regularization >= 0 && quality_regularization <= 1e4,
       "quality_regularization must lie in [0, 10000]"},
      {max_side_length_factor >= 0,
       "max_side_length_factor must not be negative"},
      {max_side_length_percentile >= 0 && max_side_length_percentile <= 100,
       "max_side_length_percentile must lie in [0, 100]"},
      {min_component_faces >= 0, "min_component_faces must not be negative"}};
  for (const auto& [holds, message] : rules) {
    if (!holds) {
      return message;
    }
  }
  return borders.Check();
}

}  // namespace colmap_ext
