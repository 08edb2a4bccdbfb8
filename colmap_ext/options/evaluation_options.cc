#include "colmap_ext/options/evaluation_options.h"

#include <algorithm>
#include <utility>
#include <vector>

#include "colmap_ext/errors.h"
#include "colmap_ext/options/number_list.h"
#include "formats/read_npy_mask.h"

namespace colmap_ext {

void EvaluatorOptions::Finish() {
  if (mesh_path.empty() || truth_path.empty()) {
    throw OptionError("--mesh_path and --truth_path are required");
  }
  region.Finish();
  if (region.is_auto && workspace_path.empty()) {
    throw OptionError("--region auto needs --workspace_path");
  }
  if (observability_mask.empty() != observability_box.empty()) {
    throw OptionError(
        "--observability_mask and --observability_box go together");
  }
  if (!picture_image.empty() &&
      (workspace_path.empty() || picture_path.empty())) {
    throw OptionError(
        "--picture_image needs --picture_path and --workspace_path");
  }
  if (!sparse_path.empty() && workspace_path.empty()) {
    throw OptionError("--sparse_path needs --workspace_path");
  }
  evaluation.depth_thresholds =
      ParseNumberList("depth_thresholds", depth_thresholds, 0);
  if (!(std::ranges::min(evaluation.depth_thresholds) > 0)) {
    throw OptionError("depth_thresholds must be positive lengths");
  }
}

Observability EvaluatorOptions::ReadObservability() const {
  Observability observability;
  if (!observability_mask.empty()) {
    const std::vector<double> box =
        ParseNumberList("observability_box", observability_box, 4);
    if (!(box[3] > 0)) {
      throw OptionError("observability_box: the resolution must be positive");
    }
    VoxelGrid grid = ReadNpyMask(observability_mask);
    observability.mask = ObservabilityMask{
        grid.size, std::move(grid.voxels), {box[0], box[1], box[2]}, box[3]};
  }
  if (!ground_plane.empty()) {
    observability.ground_plane = Eigen::Vector4d(
        ParseNumberList("ground_plane", ground_plane, 4).data());
  }
  return observability;
}

}  // namespace colmap_ext
