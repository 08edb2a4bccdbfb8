#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "colmap_ext/options/region_option.h"
#include "viewer/draw_settings.h"
#include "workspace/image_order.h"

namespace colmap_ext {

// Options of mesh_viewer.
struct ViewerOptions {
  std::string workspace_path;
  std::vector<std::string> mesh_paths;  // empty: those of the workspace
  std::string labels_path;              // of facetwise_refiner
  std::string error_mesh_path;          // of mesh_evaluator
  std::string sparse_path;              // see WorkspaceOptions
  RegionOption region;                  // what is shown of the meshes
  std::string image_order_word = "auto";
  std::optional<ImageOrderKind> image_order;

  std::string screenshot;  // PNG; empty: a window
  std::string camera;      // name of the image that sees the picture
  int turntable = 0;       // pictures around the scene; 0: one picture
  int width = 0;           // px; 0: the camera's, or kWidth
  int height = 0;          // px; 0: as the width has it
  double zoom = 1;
  std::string center_words = "0.5,0.5";
  double center_u = 0.5;  // shares of the picture's width and height
  double center_v = 0.5;
  int gpu_index = -1;  // see EglContext

  std::string mode_word = "shaded";
  DrawSettings settings;
  double image_opacity = 0;  // 0: no image lies over the mesh

  static constexpr int kWidth = 1024;  // px

  // Passes the words on to the options that they stand for.
  // \throw OptionError if something is wrong with any of the options.
  void Finish();
};

}  // namespace colmap_ext
