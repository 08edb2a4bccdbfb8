#include "colmap_ext/options/viewer_options.h"

#include "colmap_ext/errors.h"
#include "colmap_ext/options/image_order_option.h"
#include "colmap_ext/options/number_list.h"
#include "colmap_ext/options/words.h"

namespace colmap_ext {

namespace {

MeshMode ParseMode(const std::string& word) {
  return ParseWord<MeshMode>("mode", word,
                             {{"shaded", MeshMode::kShaded},
                              {"color", MeshMode::kColor},
                              {"normals", MeshMode::kNormals},
                              {"labels", MeshMode::kLabels},
                              {"error", MeshMode::kErrors},
                              {"confidence", MeshMode::kConfidence}});
}

void CheckScreenshot(const ViewerOptions& options) {
  if (options.screenshot.empty() &&
      (!options.camera.empty() || options.turntable > 0)) {
    throw OptionError("--camera and --turntable are of --screenshot FILE.png");
  }
  if (!options.camera.empty() && options.turntable > 0) {
    throw OptionError("--camera and --turntable exclude each other");
  }
  if (!options.screenshot.empty() && options.mesh_paths.size() > 1) {
    throw OptionError("--screenshot takes one --mesh_path");
  }
  if (options.camera.empty() && options.image_opacity > 0 &&
      !options.screenshot.empty()) {
    throw OptionError("--image_opacity needs --camera, whose image it is of");
  }
  if ((!options.camera.empty() || options.settings.cameras ||
       options.settings.points) &&
      options.workspace_path.empty()) {
    throw OptionError(
        "--camera, --cameras and --points need --workspace_path, which has "
        "them");
  }
}

}  // namespace

void ViewerOptions::Finish() {
  if (workspace_path.empty() && mesh_paths.empty()) {
    throw OptionError("--workspace_path or --mesh_path is required");
  }
  region.Finish();
  if (region.is_auto) {
    throw OptionError(
        "--region auto is not for mesh_viewer, but the file that it made: "
        "MESH.region.txt");
  }
  image_order = ParseImageOrder(image_order_word);
  settings.mode = ParseMode(mode_word);
  const std::vector<double> center = ParseNumberList("center", center_words, 2);
  center_u = center[0];
  center_v = center[1];
  CheckScreenshot(*this);
}

}  // namespace colmap_ext
