#include "colmap_ext/tiling/plan.h"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <limits>
#include <utility>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "colmap_ext/options/add_meshing_options.h"
#include "colmap_ext/refinement/file_fingerprint.h"
#include "formats/atomic_file.h"
#include "formats/errors.h"

namespace colmap_ext {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

Json ToJson(const View& view) {
  std::vector<double> rotation(9);
  std::vector<double> translation(3);
  Eigen::Map<Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(rotation.data()) =
      view.cam_from_world_rotation;
  Eigen::Map<Eigen::Vector3d>(translation.data()) =
      view.cam_from_world_translation;
  return {{"name", view.name},
          {"width", view.width},
          {"height", view.height},
          {"focal", {view.fx, view.fy}},
          {"center", {view.cx, view.cy}},
          {"rotation", rotation},
          {"translation", translation}};
}

View ViewFrom(const Json& json) {
  View view;
  view.name = json.at("name");
  view.width = json.at("width");
  view.height = json.at("height");
  view.fx = json.at("focal").at(0);
  view.fy = json.at("focal").at(1);
  view.cx = json.at("center").at(0);
  view.cy = json.at("center").at(1);
  const std::vector<double> rotation = json.at("rotation");
  const std::vector<double> translation = json.at("translation");
  for (int i = 0; i < 9; ++i) {
    view.cam_from_world_rotation(i / 3, i % 3) =
        rotation.at(static_cast<size_t>(i));
  }
  for (int i = 0; i < 3; ++i) {
    view.cam_from_world_translation[i] = translation.at(static_cast<size_t>(i));
  }
  return view;
}

// As RegionText() has it: axes, centre, half sizes.
Json ToJson(const Region& region) {
  Json json;
  for (int row = 0; row < 3; ++row) {
    for (int col = 0; col < 3; ++col) {
      json.push_back(region.region_from_world(row, col));
    }
  }
  for (const Eigen::Vector3d& vector : {region.center, region.half_sizes}) {
    for (const double value : vector) {
      json.push_back(value);
    }
  }
  return json;
}

Region RegionFrom(const Json& json) {
  Region region;
  for (int i = 0; i < 15; ++i) {
    const double value = json.at(static_cast<size_t>(i));
    if (i < 9) {
      region.region_from_world(i / 3, i % 3) = value;
    } else {
      (i < 12 ? region.center : region.half_sizes)[i % 3] = value;
    }
  }
  return region;
}

// Both corners; what is infinite is null.
Json ToJson(const Eigen::AlignedBox3f& box) {
  Json json;
  for (const Eigen::Vector3f& corner : {box.min(), box.max()}) {
    for (const float value : corner) {
      json.push_back(std::isfinite(value) ? Json(value) : Json());
    }
  }
  return json;
}

Eigen::AlignedBox3f BoxFrom(const Json& json) {
  constexpr float kInfinity = std::numeric_limits<float>::infinity();
  Eigen::AlignedBox3f box;
  for (int axis = 0; axis < 3; ++axis) {
    const auto place = static_cast<size_t>(axis);
    const Json& low = json.at(place);
    const Json& high = json.at(place + 3);
    box.min()[axis] = low.is_null() ? -kInfinity : low.get<float>();
    box.max()[axis] = high.is_null() ? kInfinity : high.get<float>();
  }
  return box;
}

Json ToJson(const PlannedTile& tile) {
  return {{"points", tile.num_points},    {"vertices", tile.num_vertices},
          {"rays", tile.num_rays},        {"memory_gb", tile.memory_gb},
          {"core_seconds", tile.seconds}, {"cell", ToJson(tile.cell)}};
}

PlannedTile TileFrom(const Json& json) {
  return {json.at("points"),       json.at("vertices"),
          json.at("rays"),         json.at("memory_gb"),
          json.at("core_seconds"), BoxFrom(json.at("cell"))};
}

std::string ChecksumOf(const Json& json) {
  return fmt::format("{:016x}", HashBytes(json.dump()));
}

Plan PlanFrom(const Json& json) {
  Plan plan;
  plan.workspace_path = std::string(json.at("workspace"));
  plan.inputs = json.at("inputs");
  plan.options = json.at("options");
  plan.distance_sigma = json.at("distance_sigma");
  plan.half_pixel_scale = json.at("half_pixel_scale");
  plan.has_colors = json.at("has_colors");
  plan.seam_rings = json.at("seam_rings");
  plan.merger_memory_gb = json.at("merger_memory_gb");
  if (json.contains("region")) {
    plan.region = RegionFrom(json.at("region"));
  }
  for (const Json& tile : json.at("tiles")) {
    plan.tiles.push_back(TileFrom(tile));
  }
  for (const Json& view : json.at("views")) {
    plan.views.push_back(ViewFrom(view));
  }
  plan.identity = IdentityOf(plan, plan.tiles.size());
  return plan;
}

}  // namespace

fs::path PlanPath(const fs::path& folder) { return folder / "plan.json"; }

fs::path BlocksPath(const fs::path& folder) { return folder / "blocks.bin"; }

fs::path VerticesPath(const fs::path& folder, size_t tile) {
  return folder / fmt::format("tile{:05}.vertices.bin", tile);
}

fs::path CutPath(const fs::path& folder, size_t tile) {
  return folder / fmt::format("tile{:05}.cut.bin", tile);
}

uint64_t IdentityOf(const Plan& plan, size_t num_tiles) {
  uint64_t hash = HashBytes(
      fmt::format("{} {} {}\n", kPlanVersion, num_tiles, plan.seam_rings));
  for (const auto* pairs : {&plan.inputs, &plan.options}) {
    for (const auto& [name, value] : *pairs) {
      hash = HashBytes(fmt::format("{}={}\n", name, value), hash);
    }
  }
  return hash;
}

void WritePlan(const fs::path& folder, const Plan& plan) {
  Json json = {{"version", kPlanVersion},
               {"workspace", plan.workspace_path.string()},
               {"inputs", plan.inputs},
               {"options", plan.options},
               {"distance_sigma", plan.distance_sigma},
               {"half_pixel_scale", plan.half_pixel_scale},
               {"has_colors", plan.has_colors},
               {"seam_rings", plan.seam_rings},
               {"merger_memory_gb", plan.merger_memory_gb}};
  if (plan.region) {
    json["region"] = ToJson(*plan.region);
  }
  for (const PlannedTile& tile : plan.tiles) {
    json["tiles"].push_back(ToJson(tile));
  }
  for (const View& view : plan.views) {
    json["views"].push_back(ToJson(view));
  }
  json["checksum"] = ChecksumOf(json);
  WriteText(PlanPath(folder), json.dump(1) + "\n");
}

Plan ReadPlan(const fs::path& folder) {
  const fs::path path = PlanPath(folder);
  std::ifstream file(path);
  if (!file) {
    throw FileError(path, "no plan there: make it by mesh_planner");
  }
  try {
    Json json = Json::parse(file);
    if (json.at("version") != kPlanVersion) {
      throw FileError(path,
                      fmt::format("has the version {}, not {}: plan again by "
                                  "mesh_planner",
                                  json.at("version").dump(), kPlanVersion));
    }
    const std::string checksum = json.at("checksum");
    json.erase("checksum");
    if (checksum != ChecksumOf(json)) {
      throw FileError(path, "damaged or edited: plan again by mesh_planner");
    }
    return PlanFrom(json);
  } catch (const nlohmann::json::exception&) {
    throw FileError(path, "damaged: plan again by mesh_planner");
  } catch (const std::out_of_range&) {
    throw FileError(path, "damaged: plan again by mesh_planner");
  }
}

void ExpectSameInputs(const Plan& plan) {
  for (const auto& [path, fingerprint] : plan.inputs) {
    const std::string now = QuickFingerprint(path);
    if (now != "none" && now != fingerprint) {
      throw FileError(path,
                      "has changed since it was planned: plan again by "
                      "mesh_planner");
    }
  }
}

MesherOptions MeshingOptionsOf(const fs::path& folder, const Plan& plan) {
  MesherOptions options;
  options.workspace_path = plan.workspace_path.string();
  CommandOptions command;
  AddMeshingOptions(&command, &options);
  for (const CommandOptions::Option& option : command.Options()) {
    const auto found = plan.options.find(option.name);
    if (found != plan.options.end() && !SetValue(found->second, option)) {
      throw FileError(PlanPath(folder), "damaged at " + option.name +
                                            ": plan again by "
                                            "mesh_planner");
    }
  }
  options.Finish();
  return options;
}

}  // namespace colmap_ext
