#pragma once

#include <filesystem>
#include <string>

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
  WorkspaceOptions workspace;
  ManifoldMeshingOptions meshing;

  // meshing.max_proj_dist is in pixels of the cameras, as COLMAP's
  // DelaunayMeshing.max_proj_dist is, not of the images.
  bool has_camera_pixels = false;

  HalfPixelCorrection half_pixel = HalfPixelCorrection::kAuto;
  double alpha_vis = 0;  // see ManifoldMeshingOptions; 0: kTracks
  int num_threads = -1;  // -1 for all

  // Options of earlier versions, which Finish() converts.
  bool old_half_pixel_calibration = true;
  ObservationWeight old_alpha_kind = ObservationWeight::kTracks;

  // Where to read, and where the mesh goes.
  std::filesystem::path InputPath() const;
  std::filesystem::path OutputPath(
      const std::filesystem::path& dense_path) const;

  // Checks the options, and sets those that depend on others.
  // \throw OptionError if something is wrong with any of the options.
  void Finish();

 private:
  void FinishTile() const;
};

// Adds the options to those of a command, under COLMAP's names where the
// meaning is COLMAP's.
// \param mesher  must outlive the parsing.
void AddMesherOptions(CommandOptions* options, MesherOptions* mesher);

// Adds only those of the method, DelaunayManifoldMeshing.*.
void AddMeshingOptions(CommandOptions* options, MesherOptions* mesher);

// Adds only those of the input that mesh_planner has too.
void AddMeshingInputOptions(CommandOptions* options, MesherOptions* mesher);

}  // namespace colmap_ext
