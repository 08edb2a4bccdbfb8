#include "colmap_ext/jobs/plan.h"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <limits>
#include <string>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "base/indices.h"
#include "tiles/tile_cut.h"

namespace nlohmann {

// By rows. Infinite numbers are "inf" and "-inf".
template <typename T, int kRows, int kCols>
struct adl_serializer<Eigen::Matrix<T, kRows, kCols>> {
  static void to_json(json& list, const Eigen::Matrix<T, kRows, kCols>& from) {
    for (const T value : from.template reshaped<Eigen::RowMajor>()) {
      list.push_back(std::isfinite(value) ? json(value)
                                          : json(value > 0 ? "inf" : "-inf"));
    }
  }
  static void from_json(const json& list, Eigen::Matrix<T, kRows, kCols>& to) {
    constexpr T kInfinity = std::numeric_limits<T>::infinity();
    size_t i = 0;
    for (T& value : to.template reshaped<Eigen::RowMajor>()) {
      const json& from = list.at(i++);
      value = !from.is_string() ? from.get<T>()
              : from == "inf"   ? kInfinity
                                : -kInfinity;
    }
  }
};

template <>
struct adl_serializer<Eigen::AlignedBox3f> {
  static void to_json(json& corners, const Eigen::AlignedBox3f& box) {
    corners = {box.min(), box.max()};
  }
  static void from_json(const json& corners, Eigen::AlignedBox3f& box) {
    box = {corners.at(0).get<Eigen::Vector3f>(),
           corners.at(1).get<Eigen::Vector3f>()};
  }
};

}  // namespace nlohmann

namespace colmap_ext {

NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(View, name, width, height, fx, fy, cx, cy,
                                   cam_from_world_rotation,
                                   cam_from_world_translation)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(Region, region_from_world, center,
                                   half_sizes)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(JobInputs, options, files)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(PlannedTile, num_points, num_vertices,
                                   num_rays, memory_gb, core_seconds, cell)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(RefinementTile, color, margin, facets,
                                   cache_gb, memory_gb, thread_gb, core_seconds)

namespace {

namespace fs = std::filesystem;
using PlanJson = nlohmann::json;

constexpr int kVersion = 8;  // of both files

constexpr char kPlanAgain[] = "run mesh_planner";
constexpr char kPlanRefinementAgain[] =
    "run facetwise_refiner --plan_path PLAN --input_path MESH";

std::string ChecksumOf(const PlanJson& json) {
  return fmt::format("{:016x}", HashBytes(json.dump()));
}

void WriteJson(const fs::path& path, PlanJson json) {
  json["version"] = kVersion;
  json["checksum"] = ChecksumOf(json);
  WriteText(path, json.dump(1) + "\n");
}

// Reads what WriteJson() wrote, and makes something of it.
template <typename Make>
auto ReadJson(const fs::path& path, const std::string& what_to_do,
              const Make& make) {
  std::error_code error;
  std::ifstream file(path);
  if (!fs::is_regular_file(path, error) || !file) {
    throw FileError(path,
                    (fs::exists(path, error) ? "not a file: " : "not there: ") +
                        what_to_do);
  }
  try {
    PlanJson json = PlanJson::parse(file);
    if (json.at("version") != kVersion) {
      throw FileError(
          path, fmt::format("has the version {}, not {}: {}",
                            json.at("version").dump(), kVersion, what_to_do));
    }
    const std::string checksum = json.at("checksum");
    json.erase("checksum");
    if (checksum == ChecksumOf(json)) {
      return make(json);
    }
  } catch (const PlanJson::exception&) {
  }
  throw FileError(path, "damaged or edited: " + what_to_do);
}

void ExpectSameFile(const fs::path& path, const std::string& fingerprint,
                    const std::string& what_to_do) {
  const std::string now = Fingerprint(path);
  if (now != "none" && now != fingerprint) {
    throw FileError(path, "has changed since " + what_to_do);
  }
}

// Of a tile within others, its own vertices and those of others that its job
// holds, which lie along the borders.
double NumHeld(size_t num_vertices) {
  const auto own = static_cast<double>(num_vertices);
  return own + 640 * std::sqrt(own);
}

}  // namespace

double TileMemoryGb(size_t num_vertices) {
  return 0.06 + 830e-9 * NumHeld(num_vertices);
}

size_t NumTilesForMemory(const PlannerOptions& options, size_t num_points) {
  // How many of the points are vertices after the usual thinning. Measured on
  // fountain, bunny, sceaux and south: 0.17 to 0.27.
  constexpr double kThinnedShare = 0.25;
  const double num_vertices =
      (options.mesher.meshing.thinning.max_proj_dist > 0 ? kThinnedShare : 1) *
      static_cast<double>(num_points);
  size_t num_tiles = 1;
  while (num_tiles < num_points &&
         TileMemoryGb(static_cast<size_t>(num_vertices /
                                          static_cast<double>(num_tiles))) >
             options.max_memory_gb) {
    ++num_tiles;
  }
  return num_tiles;
}

double TileSeconds(size_t num_vertices) {
  return 1 + 60e-6 * NumHeld(num_vertices);
}

double MergerMemoryGb(const Plan& plan, const PlannerOptions& options) {
  // The cells of one tile, without its rays, and the seams read last.
  constexpr double kSeamsGb = 0.07;
  double num_vertices = 0;
  double largest = 0;
  for (const PlannedTile& tile : plan.tiles) {
    num_vertices += static_cast<double>(tile.num_vertices);
    largest = std::max(largest, static_cast<double>(tile.num_vertices));
  }
  // Borders and remeshing take the adjacency of the whole surface.
  const ManifoldMeshingOptions& meshing = options.mesher.meshing;
  const bool takes_adjacency = meshing.borders.trim > 0 ||
                               meshing.borders.close_holes != 0 ||
                               meshing.remeshing;
  const double bytes_a_vertex = takes_adjacency ? 390 : 150;
  const double all_seams =
      options.seam_rings == kAllAtOnce ? 600e-9 * num_vertices : 0;
  return std::max(
      kSeamsGb + TileMemoryGb(static_cast<size_t>(largest)) + all_seams,
      0.06 + 1e-9 * bytes_a_vertex * num_vertices);
}

void Plan::Identify() { identity = inputs.Hash(kVersion); }

PlannerOptions Plan::Options() const {
  PlannerOptions options;
  CommandOptions command;
  AddPlannerOptions(&command, &options);
  inputs.SetOptions(command, PlanPath(folder), kPlanAgain);
  options.output_path = folder.string();
  options.mesher.workspace_path = workspace_path.string();
  RegionOption& region_option = options.mesher.scene.region;
  if (region_option.text != "auto") {
    region_option.text.clear();  // jobs may run where its file is not
  }
  options.Finish();
  return options;
}

TileCells Plan::Cells() const {
  TileCells cells;
  for (const PlannedTile& tile : tiles) {
    cells.push_back(tile.cell);
  }
  return cells;
}

void RefinementPlan::Identify(const Plan& plan) {
  folder = plan.folder;
  inputs.options["plan"] = fmt::format("{:016x}", plan.identity);
  identity = inputs.Hash(kVersion);
}

uint32_t RefinementPlan::NumColors() const {
  return std::ranges::max(tiles, {}, &RefinementTile::color).color + 1;
}

std::vector<uint32_t> RefinementPlan::TilesBefore(uint32_t color) const {
  std::vector<uint32_t> before;
  for (uint32_t other = 0; other < color; ++other) {
    Append(TilesOf(other), &before);
  }
  return before;
}

std::vector<uint32_t> RefinementPlan::TilesOf(uint32_t color) const {
  std::vector<uint32_t> of_color;
  for (uint32_t tile = 0; tile < tiles.size(); ++tile) {
    if (tiles[tile].color == color) {
      of_color.push_back(tile);
    }
  }
  return of_color;
}

void RefinementPlan::SetOptions(RefinerOptions* options) const {
  CommandOptions command;
  AddResultOptions(&command, options);
  inputs.SetOptions(command, RefinementPlanPath(folder), kPlanRefinementAgain);
}

fs::path PlanPath(const fs::path& folder) { return folder / "plan.json"; }

fs::path RefinementPlanPath(const fs::path& folder) {
  return folder / "refine.json";
}

fs::path RefinedSparsePath(const fs::path& folder) {
  return folder / "sparse-refined";
}

void WritePlan(const Plan& plan) {
  PlanJson json = {{"workspace", plan.workspace_path.string()},
                   {"sparse", plan.sparse_path.string()},
                   {"inputs", plan.inputs},
                   {"distance_sigma", plan.distance_sigma},
                   {"views", plan.views},
                   {"tiles", plan.tiles},
                   {"merger_memory_gb", plan.merger_memory_gb}};
  if (plan.region) {
    json["region"] = *plan.region;
  }
  WriteJson(PlanPath(plan.folder), std::move(json));
}

void WritePlan(const RefinementPlan& plan) {
  WriteJson(RefinementPlanPath(plan.folder),
            {{"inputs", plan.inputs},
             {"views", plan.views},
             {"radial_shifts", plan.radial_shifts},
             {"tiles", plan.tiles}});
}

Plan ReadPlan(const fs::path& folder) {
  return ReadJson(PlanPath(folder), kPlanAgain, [&](const PlanJson& json) {
    Plan plan;
    plan.folder = folder;
    plan.workspace_path = std::string(json.at("workspace"));
    plan.sparse_path = std::string(json.at("sparse"));
    plan.inputs = json.at("inputs");
    plan.Identify();
    plan.distance_sigma = json.at("distance_sigma");
    plan.views = json.at("views").get<std::vector<View>>();
    plan.tiles = json.at("tiles").get<std::vector<PlannedTile>>();
    plan.merger_memory_gb = json.at("merger_memory_gb");
    if (json.contains("region")) {
      plan.region = json.at("region").get<Region>();
    }
    return plan;
  });
}

Plan ReadPlan(const fs::path& folder, uint32_t tile) {
  Plan plan = ReadPlan(folder);
  if (tile >= plan.tiles.size()) {
    throw FileError(PlanPath(folder),
                    fmt::format("has no tile {}, but those from 0 to {}", tile,
                                plan.tiles.size() - 1));
  }
  return plan;
}

RefinementPlan ReadRefinementPlan(const Plan& plan) {
  const fs::path path = RefinementPlanPath(plan.folder);
  RefinementPlan read =
      ReadJson(path, kPlanRefinementAgain, [&](const PlanJson& json) {
        RefinementPlan refinement;
        refinement.inputs = json.at("inputs");
        refinement.views = json.at("views").get<std::vector<View>>();
        refinement.radial_shifts =
            json.at("radial_shifts").get<std::vector<RadialShifts>>();
        refinement.tiles = json.at("tiles").get<std::vector<RefinementTile>>();
        return refinement;
      });
  const JobInputs inputs = read.inputs;
  read.Identify(plan);
  if (read.tiles.size() != plan.tiles.size() ||
      !read.inputs.DifferenceTo(inputs).empty()) {
    throw FileError(path,
                    std::string("of another plan: ") + kPlanRefinementAgain);
  }
  return read;
}

void ExpectSame(const Plan& plan) {
  for (const auto& [path, fingerprint] : plan.inputs.files) {
    ExpectSameFile(path, fingerprint,
                   std::string("it was planned: ") + kPlanAgain);
  }
}

void ExpectSame(const RefinementPlan& plan, const fs::path& path) {
  const auto found = plan.inputs.files.find(fs::absolute(path).string());
  if (found != plan.inputs.files.end()) {
    ExpectSameFile(
        path, found->second,
        std::string("its refinement was planned: ") + kPlanRefinementAgain);
  }
}

}  // namespace colmap_ext
