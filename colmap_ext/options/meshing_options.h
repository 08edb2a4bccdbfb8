#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include <Eigen/Core>

#include "colmap_ext/options/command_options.h"
#include "colmap_ext/options/scene_options.h"
#include "meshing/manifold_meshing.h"
#include "workspace/workspace.h"

namespace colmap_ext {

// The correction of fused points by HalfPixelOffsets (scene/half_pixel.h).
enum class HalfPixelCorrection {
  kAuto,  // times the factor that the sparse points show
  kFull,  // by half a pixel
  kOff,
};

// Options of delaunay_manifold_mesher.
struct MesherOptions {
  std::string workspace_path;  // either this
  std::string input_path;      // or, as for delaunay_mesher, this
  std::string output_path;
  std::string report_path;  // a page, .html
  std::string plan_path;    // a plan's folder, instead of a workspace
  int tile = -1;            // of the plan
  SceneOptions scene;
  bool mask_background = false;  // rays through masked pixels are free space
  bool carve_with_depth_maps = false;  // read stereo/depth_maps
  WorkspaceOptions workspace;
  ManifoldMeshingOptions meshing;

  // meshing.thinning.max_proj_dist is in pixels of the cameras, as COLMAP's
  // DelaunayMeshing.max_proj_dist is, not of the images.
  bool has_camera_pixels = false;

  HalfPixelCorrection half_pixel = HalfPixelCorrection::kAuto;
  double alpha_vis = 0;  // see ManifoldMeshingOptions; 0: kTracks

  // Where to read.
  std::filesystem::path InputPath() const;

  // Checks the options, and sets those that depend on others.
  // \throw OptionError if something is wrong with any of the options.
  void Finish();
};

// Adds the options to those of a command, under COLMAP's names where the
// meaning is COLMAP's.
// \param mesher  must outlive the parsing.
void AddMesherOptions(CommandOptions* options, MesherOptions* mesher);

// Options of mesh_planner.
struct PlannerOptions {
  MesherOptions mesher;
  std::string output_path;    // the plan's folder
  double max_memory_gb = 8;   // of a tile's job
  int num_tiles = 0;          // 0: by max_memory_gb
  double distance_sigma = 0;  // scene units; 0: from the edges' lengths
  int seam_rings = 4;         // TileCutOptions

  // \throw OptionError if something is wrong with any of the options.
  void Finish();
};

// Options of mesh_merger.
struct MergerOptions {
  std::string plan_path;
  std::string output_path;
  bool is_refined = false;     // merge the refined tiles
  std::string transform_path;  // of the mesh that is written; empty: none
  std::optional<Eigen::Matrix4d> transform;  // the same, read by Finish()

  // \throw OptionError, or FileError if the transform cannot be read
  void Finish();
};

// Add the options to those of a command.
void AddPlannerOptions(CommandOptions* options, PlannerOptions* planner);
void AddMergerOptions(CommandOptions* options, MergerOptions* merger);

}  // namespace colmap_ext
