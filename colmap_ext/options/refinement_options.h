#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "colmap_ext/options/scene_options.h"
#include "refine/facetwise_refinement.h"
#include "workspace/image_order.h"

namespace colmap_ext {

// What computes the photometric energy.
enum class Backend {
  kAuto,  // OpenGL on a graphics card, or else the processor
  kCpu,
  kGl,
};

// Trims only what fused points can tell of.
inline constexpr double kAutoTrim = -1;

// Options of facetwise_refiner.
struct RefinerOptions {
  std::string workspace_path;
  std::string input_path;   // the mesh; empty: kMesherOutput of the workspace
  std::string output_path;  // empty: meshed-refined.ply in the workspace
  std::string fused_path;   // empty: fused.ply in the workspace
  std::string sparse_path;  // see WorkspaceOptions
  std::string report_path;  // a CSV, or the page beside it; see below
  std::string labels_path;  // a PLY; its picture lies beside it
  std::string plan_path;    // a plan's folder, instead of a workspace
  int tile = -1;            // of the plan; -1: the refinement is planned
  SceneOptions scene;
  bool resume = false;
  bool viewer = false;  // shows the mesh in a window meanwhile

  FacetwiseRefinementOptions refinement;
  double trim = kAutoTrim;  // see BorderOptions
  int window = 5;           // px
  Backend backend = Backend::kAuto;
  std::optional<ImageOrderKind> image_order;  // see WorkspaceOptions
  int gpu_index = -1;                         // see EglContext
  double max_memory_gb = 4;
  bool skip_missing_images = false;
  int snapshot_interval = 0;  // iterations; 0: none
  int num_threads = -1;

  // As the command line has them, for what Finish() makes of them.
  struct Words {
    std::string pair_selection = "facetwise";  // or "classical"
    std::string solver = "gauss_newton";       // or "descent"
    // or "none", "poses", "poses_intrinsics"
    std::string refine_cameras = "auto";
    std::string backend = "auto";      // or "cpu" or "gl"
    std::string image_order = "auto";  // or NameOf() an order
  };
  Words words;

  // Passes words, and the window, on to the options that they stand for.
  // \throw OptionError if something is wrong with any of the options.
  void Finish();

  // The same of those that AddResultOptions() adds alone.
  void FinishMethod();

  // Whether cameras that can not be refined are taken as they are.
  bool AllowsFixedCameras() const { return words.refine_cameras == "auto"; }

  // Sets the trimming of the refinement.
  // \param has_fused_points  whether the workspace has a fused.ply.
  void ChooseTrim(bool has_fused_points);

  // Files that are written beside others, or by default.
  std::filesystem::path OutputPath(const std::filesystem::path& folder) const;
  std::filesystem::path StepsPath() const;  // CSV
  std::filesystem::path PlotPath() const;   // SVG
  std::filesystem::path PagePath() const;   // HTML
  std::filesystem::path LabelsPicturePath() const;

  // Of memory, for the images at a level, and for what is drawn into them.
  // Bytes, the first two together max_memory_gb; the third is of the second.
  size_t MaxImageMemory() const;
  size_t MaxDrawingMemory() const;
  size_t MaxMemoryLentToImages() const;
};

}  // namespace colmap_ext
