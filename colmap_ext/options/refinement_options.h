#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "colmap_ext/options/command_options.h"
#include "colmap_ext/options/scene_options.h"
#include "refine/facetwise_refinement.h"
#include "workspace/image_order.h"

namespace colmap_ext {

// The device that computes the photometric energy.
enum class Backend {
  kAuto,  // OpenGL on a graphics card, or else the processor
  kCpu,
  kGl,
};

// Trims only where fused points give confidences.
inline constexpr double kAutoTrim = -1;
inline constexpr double kAutoMemory = -1;

// Options of facetwise_refiner.
struct RefinerOptions {
  std::string workspace_path;
  std::string input_path;   // the mesh; empty: kMesherOutput of the workspace
  std::string output_path;  // empty: meshed-refined.ply in the workspace
  std::string fused_path;   // empty: fused.ply in the workspace
  std::string sparse_path;  // see WorkspaceOptions
  std::string report_path;  // the page, or the CSV beside it; see below
  std::string labels_path;  // a PLY; its picture has the same name
  std::string plan_path;    // a plan's folder, instead of a workspace
  int tile = -1;            // of the plan; -1: the refinement is planned
  SceneOptions scene;
  bool resume = false;
  bool viewer = false;  // show the mesh in a window meanwhile

  FacetwiseRefinementOptions refinement;
  double min_confidence = kAutoTrim;  // BorderOptions::trim
  double image_scale = 1;             // of the images that are compared
  int window = 5;                     // px
  Backend backend = Backend::kAuto;
  std::optional<ImageOrderKind> image_order;   // see WorkspaceOptions
  std::optional<RefinedParts> refine_cameras;  // nullopt: if it is needed
  int gpu_index = -1;                          // see EglContext
  double max_memory_gb = kAutoMemory;
  bool skip_missing_images = false;

  // Checks the options, and sets those that depend on others.
  // \throw OptionError if something is wrong with any of the options.
  void Finish();

  // The same for those that AddResultOptions() adds.
  void FinishMethod();

  // Sets the trimming of the refinement.
  // \param has_fused_points  whether the workspace has a fused.ply.
  void ChooseTrim(bool has_fused_points);

  // Paths of written files; empty if the option is.
  std::filesystem::path StepsPath() const;  // CSV
  std::filesystem::path PagePath() const;   // HTML
};

// Adds the options to those of a command.
// \param refiner  must outlive the parsing.
void AddRefinerOptions(CommandOptions* options, RefinerOptions* refiner);

// Adds only those that the refined mesh depends on.
void AddResultOptions(CommandOptions* options, RefinerOptions* refiner);

}  // namespace colmap_ext
