#include "colmap_ext/options/viewer_options.h"

#include <algorithm>

namespace colmap_ext {

void ViewerOptions::Finish() {
  RefuseIf(workspace_path.empty() && mesh_paths.empty(),
           "--workspace_path or --mesh_path is required");
  region.Finish();
  RefuseIf(region.is_auto,
           "--region auto is not for mesh_viewer: give the file that it made, "
           "MESH.region.txt");
  const std::vector<double> center = ParseNumberList("center", center_words, 2);
  center_u = center[0];
  center_v = center[1];
  const bool has_window = screenshot_path.empty();
  const bool has_image = !image_name.empty();
  RefuseIf(has_window && (has_image || turntable > 0),
           "--image_name and --turntable need --screenshot_path");
  RefuseIf(has_image && turntable > 0,
           "--image_name and --turntable exclude each other");
  RefuseIf(!has_window && mesh_paths.size() > 1,
           "--screenshot_path takes one --mesh_path");
  RefuseIf(!has_window && !has_image && image_opacity > 0,
           "--image_opacity needs --image_name");
  RefuseIf((has_image || settings.cameras || settings.points) &&
               workspace_path.empty(),
           "--image_name, --cameras and --points need --workspace_path");
}

std::array<int, 2> ViewerOptions::FreeSize() const {
  const int free_width = width > 0 ? width : 1024;
  return {free_width, height > 0 ? height : std::max(1, free_width * 3 / 4)};
}

void AddViewerOptions(CommandOptions* options, ViewerOptions* viewer) {
  options->SetSummary(
      "Shows meshes, points and cameras in a window, or draws pictures of "
      "them.",
      {"mesh_viewer --workspace_path DIR",
       "mesh_viewer --mesh_path MESH.ply --screenshot_path FILE.png"});
  DrawSettings* const settings = &viewer->settings;
  options->Add("workspace_path", &viewer->workspace_path,
               "Dense workspace with meshes, points, cameras and images");
  options->Add("mesh_path", &viewer->mesh_paths,
               "Meshes or point clouds, PLY: one or more. Default: "
               "meshed-*.ply of the workspace");
  AddSparsePathOption(&viewer->sparse_path, options);
  AddRegionOption("Show meshes only inside", &viewer->region, "", options);
  options->AddWord("mode", &settings->mode,
                   {{"shaded", MeshMode::kShaded},
                    {"color", MeshMode::kColor},
                    {"normals", MeshMode::kNormals},
                    {"labels", MeshMode::kLabels},
                    {"error", MeshMode::kErrors},
                    {"confidence", MeshMode::kConfidence}},
                   "Shading, vertex colors, normals, the image pair of each "
                   "face, errors, or confidence");
  options->Add("wireframe", &settings->wireframe, "Draw the edges of faces");
  options->Add("backfaces", &settings->backfaces,
               "Draw the back sides of faces red");
  options->Add("points", &settings->points, "Draw the workspace's points");
  options->Add("cameras", &settings->cameras,
               "Draw the workspace's cameras with their images");
  options->Add(
      "screenshot_path", &viewer->screenshot_path,
      "Write a picture, PNG, instead of opening a window; needs no display");
  options->Add("image_name", &viewer->image_name,
               "Draw the picture from the camera of this image");
  options->Add("image_opacity", &viewer->image_opacity, {0, 1},
               "Opacity of that image over the mesh");
  options->Add("turntable", &viewer->turntable, {0, 1000},
               "[pictures] Draw this many pictures around the scene, "
               "FILE.000.png and so on; 0: one picture");
  options->Add("width", &viewer->width, {0, 8192},
               "[px] Width of the picture or window; 0: the camera's, or 1024");
  options->Add("height", &viewer->height, {0, 8192},
               "[px] Height; 0: from the width and aspect ratio");
  options->SetGroup(OptionGroup::kAdvanced);
  options->Add("zoom", &viewer->zoom, {1e-4, 1e4},
               "Magnification of the picture");
  options->Add("center", &viewer->center_words,
               "u,v: center of the magnified part, as fractions of the width "
               "and height of the picture");
  options->Add("point_radius", &settings->point_radius, {0.01, 100},
               "[px] Radius of points");
  options->Add("labels_path", &viewer->labels_path,
               "Mesh of facetwise_refiner --labels_path, for mode labels");
  options->Add("error_mesh_path", &viewer->error_mesh_path,
               "Mesh of mesh_evaluator --error_mesh_path, for mode error");
  AddGpuIndexOption(&viewer->gpu_index, options);
  AddImageOrderOption(&viewer->image_order, options);
}

}  // namespace colmap_ext
