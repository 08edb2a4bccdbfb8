#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "colmap_ext/options/command_options.h"
#include "colmap_ext/options/scene_options.h"
#include "viewer/shown_scene.h"

namespace colmap_ext {

// Options of mesh_viewer.
struct ViewerOptions {
  std::string workspace_path;
  std::vector<std::string> mesh_paths;  // empty: those of the workspace
  std::string labels_path;              // of facetwise_refiner
  std::string error_mesh_path;          // of mesh_evaluator
  std::string sparse_path;              // see WorkspaceOptions
  RegionOption region;                  // the meshes are shown inside it
  std::optional<ImageOrderKind> image_order;

  std::string screenshot_path;  // PNG; empty: a window
  std::string image_name;       // the picture is drawn from this image's camera
  int turntable = 0;            // pictures around the scene; 0: one picture
  int width = 0;                // px; 0: the camera's, or 1024
  int height = 0;               // px; 0: from the width and the aspect ratio
  double zoom = 1;
  std::string center_words = "0.5,0.5";
  double center_u = 0.5;  // fractions of the picture's width and height
  double center_v = 0.5;
  int gpu_index = -1;  // see EglContext

  DrawSettings settings;
  double image_opacity = 0;  // 0: no image over the mesh

  // Width and height of the window, and of pictures that are not from a camera
  // of the workspace, px.
  std::array<int, 2> FreeSize() const;

  // Checks the options, and sets those that depend on others.
  // \throw OptionError if something is wrong with any of the options.
  void Finish();
};

// Adds the options to those of a command.
// \param viewer  must outlive the parsing.
void AddViewerOptions(CommandOptions* options, ViewerOptions* viewer);

}  // namespace colmap_ext
