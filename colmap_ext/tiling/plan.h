#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Geometry>

#include "colmap_ext/options/meshing_options.h"
#include "scene/region.h"
#include "scene/view.h"

namespace colmap_ext {

// What a tile has, and what its job will take.
struct PlannedTile {
  uint64_t num_points = 0;
  uint64_t num_vertices = 0;
  uint64_t num_rays = 0;
  double memory_gb = 0;
  double seconds = 0;        // of one core
  Eigen::AlignedBox3f cell;  // whose points it has, see SplitTree::Cells()
};

// PLAN/plan.json: all that the jobs of a plan share but the vertices.
struct Plan {
  std::filesystem::path workspace_path;
  // The inputs with their fingerprints, by what they are.
  std::map<std::string, std::string> inputs;
  std::map<std::string, std::string> options;  // as they are typed, by name
  double distance_sigma = 0;                   // scene units
  double half_pixel_scale = 0;
  bool has_colors = false;
  int seam_rings = 0;            // TileCutOptions
  std::optional<Region> region;  // what is meshed
  std::vector<View> views;
  std::vector<PlannedTile> tiles;
  double merger_memory_gb = 0;
  uint64_t identity = 0;  // of inputs and options
};

inline constexpr int kPlanVersion = 5;

// In a plan's folder.
std::filesystem::path PlanPath(const std::filesystem::path& folder);
std::filesystem::path BlocksPath(const std::filesystem::path& folder);
std::filesystem::path VerticesPath(const std::filesystem::path& folder,
                                   size_t tile);
std::filesystem::path CutPath(const std::filesystem::path& folder, size_t tile);

// A hash of a plan's inputs and options, and of how many tiles it has.
uint64_t IdentityOf(const Plan& plan, size_t num_tiles);

// \throw FileError if it can not be written
void WritePlan(const std::filesystem::path& folder, const Plan& plan);

// \throw FileError if there is none, or it is damaged, or of another version
Plan ReadPlan(const std::filesystem::path& folder);

// \throw FileError if an input is not as it was when it was planned. One that
//        is not there any more is not missed.
void ExpectSameInputs(const Plan& plan);

// The meshing's options of a plan.
// \throw FileError if one is not known
MesherOptions MeshingOptionsOf(const std::filesystem::path& folder,
                               const Plan& plan);

}  // namespace colmap_ext
