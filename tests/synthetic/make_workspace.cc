// make_workspace: writes a synthetic COLMAP dense workspace with known truth.

#include <algorithm>
#include <chrono>
#include <exception>
#include <iomanip>
#include <iostream>
#include <stdexcept>
#include <string>

#include "colmap_ext/options/command_options.h"
#include "tests/synthetic/write_workspace.h"

namespace {

using colmap_ext::CommandOptions;
using colmap_ext::synthetic::CameraOptions;
using colmap_ext::synthetic::DenseScene;
using colmap_ext::synthetic::DenseSceneOptions;
using colmap_ext::synthetic::SceneOptions;

void AddSceneOptions(SceneOptions* scene, CommandOptions* options) {
  options->Add("scene", &scene->shape,
               "statue, wall or grid (thin rods before a backdrop)");
  options->Add("num_images", &scene->num_images, {1, 10000});
  options->Add("width", &scene->width, {16, 20000}, "[px] Of the images");
  options->Add("height", &scene->height, {16, 20000}, "[px] Of the images");
  options->Add("relief", &scene->relief, {0, 2},
               "Height of the fine relief, as a factor");
  options->Add("thickness", &scene->thickness, {0.2, 3},
               "Of the grid's rods and blades, as a factor");
  options->Add("untextured", &scene->untextured, {0, 1},
               "How blank a patch of the surface is");
  options->Add("gloss", &scene->gloss, {0, 2},
               "Intensity of highlights on another patch");
  options->Add("exposure_change", &scene->exposure_change, {0, 0.9},
               "Maximum between images, as a share");
  options->Add("cell_size", &scene->cell_size, {0.5, 100},
               "[px] Of the true surface's lattice");
  options->AddThreads();
}

void AddCameraOptions(CameraOptions* camera, CommandOptions* options) {
  options->AddPreset("camera",
                     {{"plain", [] {}},
                      {"photo",
                       [camera] {
                         camera->defocus = 0.6;
                         camera->vignetting = 0.3;
                         camera->has_mosaic = true;
                         camera->sharpening = 0.5;
                         camera->jpeg_quality = 90;
                       }}},
                     0,
                     "Preset of defocus, vignetting, has_mosaic, sharpening "
                     "and jpeg_quality; options that are given have priority");
  options->Add("defocus", &camera->defocus, {0, 20},
               "[px] Standard deviation of the lens blur");
  options->Add("vignetting", &camera->vignetting, {0, 1},
               "Share of the light lost at the corners");
  options->Add("sensor_noise", &camera->sensor_noise, {0, 100},
               "[1/255] Of the images in the dark");
  options->Add("photon_noise", &camera->photon_noise, {0, 100},
               "[1/255] Added in full light");
  options->Add("has_mosaic", &camera->has_mosaic,
               "Simulate a Bayer mosaic and its interpolation");
  options->Add("sharpening", &camera->sharpening, {0, 5},
               "Weight of the unsharp mask");
  options->Add("jpeg_quality", &camera->jpeg_quality, {0, 100},
               "Of the JPEG compression; 0: lossless");
}

void AddPointOptions(DenseSceneOptions* scene, CommandOptions* options) {
  options->Add("noise", &scene->stereo.noise, {0, 10},
               "[px] Of stereo matches");
  options->Add("correlated_share", &scene->stereo.correlated_share, {0, 1},
               "Of its variance, between neighbors");
  options->Add("normal_noise", &scene->stereo.normal_noise, {0, 45},
               "[degrees]");
  options->Add("dropout", &scene->stereo.dropout, {0, 1},
               "Share of pixels without depth");
  options->Add("fattening", &scene->stereo.fattening, {0, 20},
               "[px] Of the foreground at silhouettes");
  options->Add("outliers", &scene->fusion.outliers, {0, 1},
               "As a share of the fused points");
  options->Add("min_num_pixels", &scene->fusion.min_num_pixels, {1, 1e9},
               "Of a fused point");
  options->Add("pose_noise", &scene->pose_noise.pixels, {0, 100},
               "[px] Of the cameras of sparse/, RMS in the images");
  options->Add("smooth_pose_noise", &scene->pose_noise.is_smooth,
               "Alike in neighboring images");
  options->Add("pose_noise_before_fusion", &scene->pose_noise.is_before_fusion,
               "Fuse by these cameras, as in life");
  options->Add("focal_factor", &scene->pose_noise.focal_factor, {0.5, 2},
               "On the focal lengths of sparse/");
  options->Add("num_sparse_points", &scene->sparse.num_points, {0, 1e9},
               "Maximum");
  options->Add("feature_noise", &scene->sparse.noise, {0, 10},
               "[px] Of sparse points");
}

// \param seed  of everything random.
CommandOptions Bind(DenseSceneOptions* scene, int* seed,
                    std::string* output_path) {
  CommandOptions options;
  options.SetSummary(
      "Writes a synthetic COLMAP dense workspace with known truth.\n"
      "Usage: make_workspace --output_path DIR [options]");
  options.Add("output_path", output_path, "Folder of the workspace");
  AddSceneOptions(&scene->scene, &options);
  options.Add("seed", seed, {0, 2147483647}, "Of everything random");
  AddCameraOptions(&scene->camera, &options);
  AddPointOptions(scene, &options);
  options.Add("write_depth_maps", &scene->keep_depth_maps,
              "The stereo's, with normals, to stereo/");
  options.Add("write_true_depth_maps", &scene->keep_true_depths,
              "Of the pixels' centers, to truth/depth_maps/");
  return options;
}

void PrintSummary(const DenseScene& scene, double seconds) {
  const auto& cloud = scene.fused.cloud;
  std::cout << "Truth: " << scene.scene.surface.vertices.size() << " vertices, "
            << scene.scene.surface.facets.size()
            << " facets\nImages: " << scene.images.size()
            << "\nSparse points: " << scene.sparse_points.size()
            << "\nFused points: " << cloud.size() << ", seen by "
            << std::setprecision(3)
            << cloud.views.values.size() / std::max<double>(cloud.size(), 1)
            << " images each\nTime: " << seconds << " s\n";
}

}  // namespace

int main(int argc, char** argv) {
  DenseSceneOptions options;
  int seed = 1;
  std::string output_path;
  const CommandOptions command = Bind(&options, &seed, &output_path);
  try {
    if (argc == 1 || colmap_ext::ParseOptions(argc, argv, command).wants_help) {
      colmap_ext::PrintHelp(command, "", std::cout);
      return 0;
    }
    if (output_path.empty()) {
      throw std::invalid_argument("output_path is missing");
    }
    options.scene.num_threads = command.NumThreads();
    options.scene.seed = seed;
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
