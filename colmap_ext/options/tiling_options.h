#pragma once

#include <cstddef>
#include <string>

#include "colmap_ext/options/command_options.h"
#include "colmap_ext/options/meshing_options.h"

namespace colmap_ext {

// What mesh_planner is asked for.
struct PlannerOptions {
  MesherOptions mesher;
  std::string output_path;    // the plan's folder
  double max_memory_gb = 8;   // of a tile's job
  int num_tiles = 0;          // 0: as many as the memory asks for
  double distance_sigma = 0;  // scene units; 0: from the edges' lengths
  int seam_rings = 4;         // TileCutOptions

  // \throw OptionError if something is wrong with any of the options.
  void Finish();
};

// What mesh_merger is asked for.
struct MergerOptions {
  std::string plan_path;
  std::string output_path;
  bool is_refined = false;  // of the tiles that are refined
  int num_threads = -1;

  // \throw OptionError
  void Finish() const;
};

// Add them to those of a command.
void AddPlannerOptions(CommandOptions* manager, PlannerOptions* planner);
void AddMergerOptions(CommandOptions* manager, MergerOptions* merger);

}  // namespace colmap_ext
