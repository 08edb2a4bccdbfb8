#include "colmap_ext/options/viewer_options.h"

#include <charconv>

#include "colmap_ext/errors.h"
#include "colmap_ext/options/image_order_option.h"
#include "colmap_ext/options/words.h"

namespace colmap_ext {

namespace {

void ParseCenter(const std::string& text, double* u, double* v) {
  const char* const end = text.data() + text.size();
  const auto first = std::from_chars(text.data(), end, *u);
  if (first.ec == std::errc() && first.ptr != end && *first.ptr == ',') {
    const auto second = std::from_chars(first.ptr + 1, end, *v);
    if (second.ec == std::errc() && second.ptr == end) {
      return;
    }
  }
  throw OptionError("center is '" + text +
                    "'; it has to be two numbers u,v, such as 0.5,0.5");
}

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

void CheckNumbers(const ViewerOptions& options) {
  constexpr int kMaxSize = 8192;  // px; OpenGL draws twice as many
  if (options.width < 0 || options.width > kMaxSize || options.height < 0 ||
      options.height > kMaxSize) {
    throw OptionError("width and height must not be negative, or above 8192");
  }
  if (options.turntable < 0 || options.turntable > 1000) {
    throw OptionError("turntable must not be negative, or above 1000");
  }
  if (!(options.zoom > 0 && options.zoom <= 1e4)) {
    throw OptionError("zoom must be positive, and 10000 or less");
  }
  if (!(options.image_opacity >= 0 && options.image_opacity <= 1)) {
    throw OptionError("image_opacity has to lie in [0, 1]");
  }
  if (!(options.settings.point_radius > 0 &&
        options.settings.point_radius <= 100)) {
    throw OptionError("point_radius must be positive, and 100 or less");
  }
  if (options.gpu_index < -1) {
    throw OptionError("gpu_index must not be negative, or -1 for any");
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
  ParseCenter(center_words, &center_u, &center_v);
  CheckNumbers(*this);
  CheckScreenshot(*this);
}

}  // namespace colmap_ext
