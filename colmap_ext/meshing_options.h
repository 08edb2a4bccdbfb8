#pragma once

#include <filesystem>
#include <string>

#include "colmap_ext/colmap_compat.h"
#include "colmap_ext/workspace.h"
#include "delaunay/manifold_meshing.h"

namespace colmap_ext {

// What delaunay_manifold_mesher is asked for.
struct MesherOptions {
  std::string workspace_path;  // either this
  std::string input_path;      // or, as delaunay_mesher has it, this
  std::string output_path;
  WorkspaceOptions workspace;
  ManifoldMeshingOptions meshing;

  // Add HalfPixelOffsets to fused points (scene/half_pixel.h) ...
  bool half_pixel_correction = true;
  // ... times what the sparse points show them to be off.
  bool half_pixel_calibration = true;

  // Where to read, and where the mesh goes.
  std::filesystem::path InputPath() const;
  std::filesystem::path OutputPath(
      const std::filesystem::path& dense_path) const;

  // What is wrong with the options, in one line; empty when all is well.
  std::string Check() const;
};

// Adds them to those of a command, with COLMAP's names where the meaning is
// COLMAP's.
// \param mesher  has to outlive the manager's parsing.
void AddMesherOptions(colmap::OptionManager* manager, MesherOptions* mesher);

}  // namespace colmap_ext
