// render_mesh: a picture of a PLY mesh or point cloud.

#include <cmath>
#include <exception>
#include <iostream>
#include <map>
#include <stdexcept>
#include <string>
#include <vector>

#include "pictures/picture_views.h"
#include "scene/look_at.h"
#include "tests/synthetic/arguments.h"
#include "tests/synthetic/colmap_workspace.h"
#include "tests/synthetic/draw_ply_mesh.h"
#include "tests/synthetic/ply_mesh.h"

namespace {

using namespace colmap_ext;             // NOLINT: a program
using namespace colmap_ext::synthetic;  // NOLINT: a program

struct Options {
  std::string mesh_path;
  std::string output_path;
  std::string workspace_path;
  std::string image;
  std::vector<double> eye;
  std::vector<double> target = {0, 0, 0};
  std::vector<double> up = {0, 0, 1};
  std::string mode = "shaded";
  double zoom = 1;
  std::vector<double> center = {0.5, 0.5};
  int width = 0;
  int height = 0;
  double point_radius = 1.2;
};

Arguments Bind(Options* options) {
  Arguments arguments;
  arguments.Add("mesh_path", &options->mesh_path, "PLY mesh or point cloud");
  arguments.Add("output_path", &options->output_path, "PNG file");
  arguments.Add("workspace_path", &options->workspace_path,
                "seen by a camera of this workspace's sparse/,");
  arguments.Add("image", &options->image, "that of the image of this name");
  arguments.Add("eye", &options->eye, "seen from x,y,z");
  arguments.Add("target", &options->target, "towards x,y,z, by default 0,0,0");
  arguments.Add("up", &options->up, "with x,y,z upwards, by default 0,0,1");
  arguments.Add("mode", &options->mode,
                "shaded, wireframe, normals, color or labels");
  arguments.Add("zoom", &options->zoom, "times as large");
  arguments.Add("center", &options->center,
                "u,v of the picture to its middle, by default 0.5,0.5");
  arguments.Add("width", &options->width, "px, 0: the camera's, or 1024");
  arguments.Add("height", &options->height, "px, 0: as the width has it");
  arguments.Add("point_radius", &options->point_radius, "of points, px");
  return arguments;
}

DrawMode ModeOf(const std::string& name) {
  const std::map<std::string, DrawMode> modes = {
      {"shaded", DrawMode::kShaded},
      {"wireframe", DrawMode::kWireframe},
      {"normals", DrawMode::kNormals},
      {"color", DrawMode::kColor},
      {"labels", DrawMode::kLabels}};
  const auto mode = modes.find(name);
  if (mode == modes.end()) {
    throw std::invalid_argument("unknown mode " + name);
  }
  return mode->second;
}

Eigen::Vector3d ToVector(const std::vector<double>& values) {
  if (values.size() != 3) {
    throw std::invalid_argument("eye, target and up are three numbers x,y,z");
  }
  return {values[0], values[1], values[2]};
}

View WorkspaceView(const Options& options) {
  for (const View& view : ReadViews(options.workspace_path + "/sparse")) {
    if (view.name == options.image || options.image.empty()) {
      return view;
    }
  }
  throw std::invalid_argument("the workspace has no image " + options.image);
}

View DefaultView(const PlyMesh& ply, int width, int height) {
  if (!ply.mesh.facets.empty()) {
    return AutomaticView(ply.mesh, width, height);
  }
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (const Eigen::Vector3f& normal : ply.normals) {
    sum += normal.cast<double>();
  }
  return AutomaticView(ply.mesh.vertices, sum, width, height);
}

View MakeView(const Options& options, const PlyMesh& ply) {
  const int width = options.width > 0 ? options.width : 1024;
  const int height = options.height > 0 ? options.height : width * 3 / 4;
  View view;
  if (!options.workspace_path.empty()) {
    view = WorkspaceView(options);
  } else if (!options.eye.empty()) {
    constexpr double kFocalLength = 1.5;  // widths of the picture
    view =
        LookAtView(ToVector(options.eye), ToVector(options.target),
                   ToVector(options.up), width, height, kFocalLength * width);
  } else {
    view = DefaultView(ply, width, height);
  }
  if (options.center.size() != 2) {
    throw std::invalid_argument("center is two numbers u,v");
  }
  const int crop_width = options.width > 0 ? options.width : view.width;
  const int crop_height =
      options.height > 0 ? options.height
                         : static_cast<int>(std::lround(
                               1.0 * crop_width * view.height / view.width));
  return CropView(view, options.zoom, options.center[0], options.center[1],
                  crop_width, crop_height);
}

}  // namespace

int main(int argc, char** argv) {
  Options options;
  const Arguments arguments = Bind(&options);
  if (Arguments::AsksForHelp(argc, argv)) {
    std::cout << "Draws a PLY mesh or point cloud; facets seen from behind are "
                 "red.\nUsage: render_mesh --mesh_path M.ply --output_path "
                 "P.png [options]\n"
              << arguments.Help();
    return 0;
  }
  try {
    arguments.Read(argc, argv);
    const DrawMode mode = ModeOf(options.mode);
    const PlyMesh ply = ReadPlyMesh(options.mesh_path);
    WriteImage(options.output_path, DrawPlyMesh(ply, MakeView(options, ply),
                                                mode, options.point_radius));
    return 0;
  } catch (const std::exception& error) {
    std::cerr << "render_mesh: " << error.what() << "\n";
    return 1;
  }
}
