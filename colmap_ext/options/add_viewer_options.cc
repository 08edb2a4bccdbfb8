#include "colmap_ext/options/add_viewer_options.h"

namespace colmap_ext {

namespace {

void AddPathOptions(CommandOptions* manager, ViewerOptions* viewer) {
  manager->AddDefaultOption(
      "workspace_path", &viewer->workspace_path,
      "A dense workspace: its meshes, points, cameras and images");
  manager->AddDefaultOption(
      "mesh_path", &viewer->mesh_paths,
      "Meshes or point clouds, PLY: one or more. Default: meshed-*.ply of the "
      "workspace");
  manager->AddDefaultOption("labels_path", &viewer->labels_path,
                            "The labels of the faces of one of them, as "
                            "facetwise_refiner --labels_path writes them");
  manager->AddDefaultOption(
      "error_mesh_path", &viewer->error_mesh_path,
      "One of them coloured by its errors, as mesh_evaluator "
      "--error_mesh_path writes it");
  manager->AddDefaultOption(
      "sparse_path", &viewer->sparse_path,
      "The cameras, a sparse model or a folder with one, such as "
      "WORKSPACE/sparse-refined. Default: that of the workspace");
  manager->AddDefaultOption(
      "region", &viewer->region.text,
      "What is shown of the meshes: a file (docs/scripts.md), or two corners "
      "x0,y0,z0,x1,y1,z1 of a box");
  manager->AddDefaultOption(
      "image_order", &viewer->image_order_word,
      "How .vis files count the images: auto, file, image_id, frame, frame_id");
}

void AddPictureOptions(CommandOptions* manager, ViewerOptions* viewer) {
  manager->AddDefaultOption(
      "screenshot", &viewer->screenshot,
      "Write a picture, PNG, and open no window; needs no display");
  manager->AddDefaultOption("camera", &viewer->camera,
                            "... seen by the workspace's image of this name");
  manager->AddNumber(
      "turntable", &viewer->turntable, {0, 1000},
      "... or so many pictures around it, FILE.000.png and on; 0: one picture");
  manager->AddNumber("width", &viewer->width, {0, 8192},
                     "[px] Of the picture or window; 0: the camera's, or 1024");
  manager->AddNumber("height", &viewer->height, {0, 8192},
                     "[px] 0: as the width has it");
  manager->AddNumber("zoom", &viewer->zoom, {1e-4, 1e4}, "... times as large");
  manager->AddDefaultOption("center", &viewer->center_words,
                            "... around this place u,v of the picture, shares "
                            "of its width and height");
  manager->AddNumber("image_opacity", &viewer->image_opacity, {0, 1},
                     "Opacity of the camera's image over the mesh");
  manager->AddNumber("gpu_index", &viewer->gpu_index, kCountOrMinusOne,
                     "Graphics card that draws pictures, as EGL lists "
                     "them; -1: the first");
}

}  // namespace

void AddViewerOptions(CommandOptions* manager, ViewerOptions* viewer) {
  AddPathOptions(manager, viewer);
  AddPictureOptions(manager, viewer);
  DrawSettings* settings = &viewer->settings;
  manager->AddDefaultOption(
      "mode", &viewer->mode_word,
      "shaded, color (of the vertices), normals, labels (the pair of each "
      "face), error or confidence");
  manager->AddDefaultOption("wireframe", &settings->wireframe,
                            "Draw the edges of the faces");
  manager->AddDefaultOption("backfaces", &settings->backfaces,
                            "Draw the backs of faces red");
  manager->AddDefaultOption("points", &settings->points,
                            "Draw the workspace's points");
  manager->AddDefaultOption("cameras", &settings->cameras,
                            "Draw the workspace's cameras with their images");
  manager->AddNumber("point_radius", &settings->point_radius, {0.01, 100},
                     "[px] Of points");
}

}  // namespace colmap_ext
