// make_workspace: writes a synthetic COLMAP dense workspace with known truth.

#include <algorithm>
#include <chrono>
#include <exception>
#include <iomanip>
#include <iostream>
#include <stdexcept>
#include <string>

#include "tests/synthetic/arguments.h"
#include "tests/synthetic/dense_scene.h"
#include "tests/synthetic/write_workspace.h"

namespace {

using colmap_ext::synthetic::Arguments;
using colmap_ext::synthetic::DenseScene;
using colmap_ext::synthetic::DenseSceneOptions;

Arguments Bind(DenseSceneOptions* options, std::string* output_path) {
  Arguments arguments;
  arguments.Add("output_path", output_path, "folder of the workspace");
  arguments.Add("scene", &options->scene.shape, "statue or wall");
  arguments.Add("num_images", &options->scene.num_images, "");
  arguments.Add("width", &options->scene.width, "of the images, px");
  arguments.Add("height", &options->scene.height, "of the images, px");
  arguments.Add("relief", &options->scene.relief, "height of the fine relief");
  arguments.Add("cell_size", &options->scene.cell_size,
                "of the true surface, px");
  arguments.Add("noise", &options->stereo.noise, "of stereo matches, px");
  arguments.Add("outliers", &options->fusion.outliers,
                "as a share of the fused points");
  arguments.Add("dropout", &options->stereo.dropout,
                "share of pixels without depth");
  arguments.Add("min_num_pixels", &options->fusion.min_num_pixels,
                "of a fused point");
  arguments.Add("num_sparse_points", &options->sparse.num_points, "at most");
  arguments.Add("write_depth_maps", &options->keep_depth_maps,
                "stereo/ as well, 0 or 1");
  arguments.Add("seed", &options->scene.seed, "of everything random");
  arguments.Add("num_threads", &options->scene.num_threads, "-1: all");
  return arguments;
}

void PrintSummary(const DenseScene& scene, double seconds) {
  const auto& cloud = scene.fused.cloud;
  std::cout << "Truth: " << scene.scene.surface.vertices.size() << " vertices, "
            << scene.scene.surface.facets.size()
            << " facets\nImages: " << scene.images.size()
            << "\nSparse points: " << scene.sparse_points.size()
            << "\nFused points: " << cloud.size() << ", seen by "
            << std::setprecision(3)
            << cloud.view_indices.size() / std::max<double>(cloud.size(), 1)
            << " images each\nTime: " << seconds << " s\n";
}

}  // namespace

int main(int argc, char** argv) {
  DenseSceneOptions options;
  std::string output_path;
  const Arguments arguments = Bind(&options, &output_path);
  if (Arguments::AsksForHelp(argc, argv)) {
    std::cout << "Writes a synthetic COLMAP dense workspace with known truth.\n"
              << "Usage: make_workspace --output_path DIR [options]\n"
              << arguments.Help();
    return 0;
  }
  try {
    arguments.Read(argc, argv);
    if (output_path.empty()) {
      throw std::invalid_argument("output_path is missing");
    }
    const auto start = std::chrono::steady_clock::now();
    const DenseScene scene = MakeDenseScene(options);
    WriteWorkspace(scene, options.scene.seed, output_path);
    const std::chrono::duration<double> elapsed =
        std::chrono::steady_clock::now() - start;
    PrintSummary(scene, elapsed.count());
    return 0;
  } catch (const std::exception& error) {
    std::cerr << "make_workspace: " << error.what() << "\n";
    return 1;
  }
}
