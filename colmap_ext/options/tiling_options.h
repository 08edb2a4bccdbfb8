#pragma once

#include <optional>
#include <string>

#include <Eigen/Core>

#include "colmap_ext/options/command_options.h"
#include "colmap_ext/options/meshing_options.h"

namespace colmap_ext {

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
  int num_threads = -1;

  // \throw OptionError, or FileError if the transform cannot be read
  void Finish();
};

// Add the options to those of a command.
void AddPlannerOptions(CommandOptions* options, PlannerOptions* planner);
void AddMergerOptions(CommandOptions* options, MergerOptions* merger);

}  // namespace colmap_ext
