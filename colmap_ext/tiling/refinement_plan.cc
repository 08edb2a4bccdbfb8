#include "colmap_ext/tiling/refinement_plan.h"

#include <algorithm>
#include <fstream>
#include <stdexcept>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "colmap_ext/options/add_refinement_options.h"
#include "colmap_ext/refinement/file_fingerprint.h"
#include "formats/atomic_file.h"
#include "formats/errors.h"

namespace colmap_ext {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

constexpr int kVersion = 2;
constexpr char kPlanAgain[] =
    "plan the refinement again by facetwise_refiner --plan PLAN --input_path "
    "MESH";

Json ToJson(const RefinementTile& tile) {
  return {{"color", tile.color},         {"margin", tile.margin},
          {"pixels", tile.pixels},       {"memory_gb", tile.memory_gb},
          {"thread_gb", tile.thread_gb}, {"core_seconds", tile.seconds}};
}

RefinementTile TileFrom(const Json& json) {
  return {json.at("color"),     json.at("margin"),    json.at("pixels"),
          json.at("memory_gb"), json.at("thread_gb"), json.at("core_seconds")};
}

RefinementPlan PlanFrom(const Json& json) {
  RefinementPlan plan;
  plan.plan_identity = json.at("plan");
  plan.inputs = json.at("inputs");
  plan.options = json.at("options");
  for (const Json& tile : json.at("tiles")) {
    plan.tiles.push_back(TileFrom(tile));
  }
  plan.identity = IdentityOf(plan);
  return plan;
}

}  // namespace

uint32_t RefinementPlan::NumColors() const {
  uint32_t num_colors = 0;
  for (const RefinementTile& tile : tiles) {
    num_colors = std::max(num_colors, tile.color + 1);
  }
  return num_colors;
}

std::vector<uint32_t> RefinementPlan::TilesBefore(uint32_t color) const {
  std::vector<uint32_t> before;
  for (uint32_t other = 0; other < color; ++other) {
    const std::vector<uint32_t> of_color = TilesOf(other);
    before.insert(before.end(), of_color.begin(), of_color.end());
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

fs::path RefinementPlanPath(const fs::path& folder) {
  return folder / "refine.json";
}

uint64_t IdentityOf(const RefinementPlan& plan) {
  uint64_t hash =
      HashBytes(fmt::format("{} {}\n", kVersion, plan.plan_identity));
  for (const auto* pairs : {&plan.inputs, &plan.options}) {
    for (const auto& [name, value] : *pairs) {
      hash = HashBytes(fmt::format("{}={}\n", name, value), hash);
    }
  }
  return hash;
}

void WriteRefinementPlan(const fs::path& folder, const RefinementPlan& plan) {
  Json json = {{"version", kVersion},
               {"plan", plan.plan_identity},
               {"inputs", plan.inputs},
               {"options", plan.options}};
  for (const RefinementTile& tile : plan.tiles) {
    json["tiles"].push_back(ToJson(tile));
  }
  WriteText(RefinementPlanPath(folder), json.dump(1) + "\n");
}

RefinementPlan ReadRefinementPlan(const fs::path& folder, const Plan& plan) {
  const fs::path path = RefinementPlanPath(folder);
  std::ifstream file(path);
  if (!file) {
    throw FileError(path, std::string("not there: ") + kPlanAgain);
  }
  RefinementPlan read;
  try {
    const Json json = Json::parse(file);
    if (json.at("version") != kVersion) {
      throw FileError(
          path, fmt::format("has the version {}, not {}: {}",
                            json.at("version").dump(), kVersion, kPlanAgain));
    }
    read = PlanFrom(json);
  } catch (const nlohmann::json::exception&) {
    throw FileError(path, std::string("damaged: ") + kPlanAgain);
  }
  if (read.plan_identity != plan.identity ||
      read.tiles.size() != plan.tiles.size()) {
    throw FileError(path, std::string("of another plan: ") + kPlanAgain);
  }
  return read;
}

void ExpectSameInput(const RefinementPlan& plan, const fs::path& path) {
  const auto found = plan.inputs.find(fs::absolute(path).string());
  const std::string now =
      found == plan.inputs.end() ? "none" : QuickFingerprint(path);
  if (now != "none" && now != found->second) {
    throw FileError(path, std::string("has changed since its refinement was "
                                      "planned: ") +
                              kPlanAgain);
  }
}

void ApplyOptions(const fs::path& folder, const RefinementPlan& plan,
                  RefinerOptions* options) {
  CommandOptions command;
  AddResultOptions(&command, options);
  for (const CommandOptions::Option& option : command.Options()) {
    const auto found = plan.options.find(option.name);
    if (found == plan.options.end() || !SetValue(found->second, option)) {
      throw FileError(RefinementPlanPath(folder),
                      "damaged at " + option.name + ": " + kPlanAgain);
    }
  }
}

}  // namespace colmap_ext
