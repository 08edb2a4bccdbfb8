#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "colmap_ext/options/scene_options.h"
#include "meshing/manifold_meshing.h"
#include "workspace/workspace.h"

namespace colmap_ext {

// Options of delaunay_manifold_mesher.
struct MesherOptions {
  std::string workspace_path;  // either this
  std::string input_path;      // or, as delaunay_mesher has it, this
  std::string output_path;
  std::string sparse_path;  // see WorkspaceOptions
  std::string report_path;  // a page, .html
  std::string plan_path;    // a plan's folder, instead of a workspace
  int tile = -1;            // of the plan
  SceneOptions scene;
  bool mask_background = false;  // nothing is there where masks leave it out
  WorkspaceOptions workspace;
  ManifoldMeshingOptions meshing;

  // meshing.max_proj_dist counts the pixels of the cameras, as COLMAP's
  // DelaunayMeshing.max_proj_dist does, and not those of the images.
  bool has_camera_pixels = false;

  // Add HalfPixelOffsets to fused points (scene/half_pixel.h) ...
  bool half_pixel_correction = true;
  // ... times what the sparse points show them to be off.
  bool half_pixel_calibration = true;

  int num_threads = -1;  // -1 for all

  // As the command line has them, for what Finish() makes of them.
  struct Words {
    std::string input_type = "dense";    // or "sparse", in any case
    std::string fused_path;              // empty: fused.ply
    std::string image_order = "auto";    // or NameOf() an order
    std::string alpha_kind = "tracks";   // or "constant"
    std::string fixing_rule = "energy";  // or "paper"
  };
  Words words;

  // Where to read, and where the mesh goes.
  std::filesystem::path InputPath() const;
  std::filesystem::path OutputPath(
      const std::filesystem::path& dense_path) const;

  // Passes the words on to the options that they stand for.
  // \throw OptionError if something is wrong with any of the options.
  void Finish();

 private:
  void FinishTile() const;
};

}  // namespace colmap_ext
