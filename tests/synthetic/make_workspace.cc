// make_workspace: writes a synthetic COLMAP dense workspace with known truth.

#include <algorithm>
#include <chrono>
#include <exception>
#include <functional>
#include <iomanip>
#include <iostream>
#include <map>
#include <sstream>
#include <stdexcept>
#include <string>

#include "tests/synthetic/dense_scene.h"
#include "tests/synthetic/write_workspace.h"

namespace {

using colmap_ext::synthetic::DenseScene;
using colmap_ext::synthetic::DenseSceneOptions;
using colmap_ext::synthetic::SceneOptions;

// The options of the program, `--name value`, each bound to a variable with its
// default.
class Arguments {
 public:
  template <typename T>
  void Add(const std::string& name, T* value, const std::string& help) {
    const std::string usual = Format(*value);
    std::string column = "  --" + name + " ";
    column.resize(std::max<size_t>(column.size(), 27), ' ');
    help_ += column + help + (usual.empty() ? "" : " [" + usual + "]") + "\n";
    setters_["--" + name] = [value](const std::string& text) {
      return Parse(text, value);
    };
  }

  // \throw std::invalid_argument for unknown options and unreadable values.
  void Read(int argc, char** argv) const {
    for (int i = 1; i < argc; i += 2) {
      const auto setter = setters_.find(argv[i]);
      if (setter == setters_.end()) {
        throw std::invalid_argument(std::string("unknown option ") + argv[i]);
      }
      if (i + 1 == argc || !setter->second(argv[i + 1])) {
        throw std::invalid_argument(std::string(argv[i]) +
                                    " lacks a proper value");
      }
    }
  }

  const std::string& Help() const { return help_; }

  static bool AsksForHelp(int argc, char** argv) {
    const std::string first = argc > 1 ? argv[1] : "-h";
    return first == "-h" || first == "--help" || first == "help";
  }

 private:
  template <typename T>
  static std::string Format(const T& value) {
    std::ostringstream stream;
    stream << value;
    return stream.str();
  }

  template <typename T>
  static bool Parse(const std::string& text, T* value) {
    std::istringstream stream(text);
    return stream >> *value && (stream >> std::ws).eof();
  }
  static bool Parse(const std::string& text, std::string* value) {
    *value = text;
    return true;
  }
  std::map<std::string, std::function<bool(const std::string&)>> setters_;
  std::string help_;
};

void AddSceneArguments(SceneOptions* options, Arguments* arguments) {
  arguments->Add("scene", &options->shape,
                 "statue, wall or grid (thin rods before a backdrop)");
  arguments->Add("num_images", &options->num_images, "1 - 10000");
  arguments->Add("width", &options->width, "of the images, px, 16 - 20000");
  arguments->Add("height", &options->height, "of the images, px, 16 - 20000");
  arguments->Add("relief", &options->relief,
                 "height of the fine relief, as a factor, 0 - 2");
  arguments->Add("thickness", &options->thickness,
                 "of the grid's rods and blades, as a factor, 0.2 - 3");
  arguments->Add("untextured", &options->untextured,
                 "how blank a patch of the surface is, 0 - 1");
  arguments->Add("gloss", &options->gloss,
                 "intensity of highlights on another patch, 0 - 2");
  arguments->Add("exposure_change", &options->exposure_change,
                 "at most, between images, as a share, 0 - 0.9");
  arguments->Add("cell_size", &options->cell_size,
                 "of the true surface's lattice, px, 0.5 - 100");
  arguments->Add("seed", &options->seed, "of everything random");
  arguments->Add("num_threads", &options->num_threads, "-1: all");
}

void AddPointArguments(DenseSceneOptions* options, Arguments* arguments) {
  arguments->Add("noise", &options->stereo.noise,
                 "of stereo matches, px, 0 - 10");
  arguments->Add("correlated_share", &options->stereo.correlated_share,
                 "of its variance, between neighbors, 0 - 1");
  arguments->Add("normal_noise", &options->stereo.normal_noise,
                 "degrees, 0 - 45");
  arguments->Add("dropout", &options->stereo.dropout,
                 "share of pixels without depth, 0 - 1");
  arguments->Add("fattening", &options->stereo.fattening,
                 "of the foreground at silhouettes, px, 0 - 20");
  arguments->Add("outliers", &options->fusion.outliers,
                 "as a share of the fused points, 0 - 1");
  arguments->Add("min_num_pixels", &options->fusion.min_num_pixels,
                 "of a fused point, 1 or more");
  arguments->Add("pose_noise", &options->pose_noise.pixels,
                 "of the cameras of sparse/, px RMS in the images, 0 - 100");
  arguments->Add("smooth_pose_noise", &options->pose_noise.is_smooth,
                 "alike in neighboring images, 0 or 1");
  arguments->Add("pose_noise_before_fusion",
                 &options->pose_noise.is_before_fusion,
                 "fuse by these cameras, as in life, 0 or 1");
  arguments->Add("focal_factor", &options->pose_noise.focal_factor,
                 "on the focal lengths of sparse/, 0.5 - 2");
  arguments->Add("num_sparse_points", &options->sparse.num_points,
                 "at most, 0 or more");
  arguments->Add("feature_noise", &options->sparse.noise,
                 "of sparse points, px, 0 - 10");
}

Arguments Bind(DenseSceneOptions* options, std::string* output_path) {
  Arguments arguments;
  arguments.Add("output_path", output_path, "folder of the workspace");
  AddSceneArguments(&options->scene, &arguments);
  arguments.Add("sensor_noise", &options->render.sensor_noise,
                "of the images in the dark, steps of 1/255, 0 - 100");
  arguments.Add("photon_noise", &options->render.photon_noise,
                "added in full light, steps of 1/255, 0 - 100");
  AddPointArguments(options, &arguments);
  arguments.Add("write_depth_maps", &options->keep_depth_maps,
                "the stereo's, with normals, to stereo/, 0 or 1");
  arguments.Add("write_true_depth_maps", &options->keep_true_depths,
                "of the pixels' centers, to truth/depth_maps/, 0 or 1");
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
            << cloud.views.values.size() / std::max<double>(cloud.size(), 1)
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
