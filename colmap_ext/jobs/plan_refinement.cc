#include "colmap_ext/jobs/refine_tiles.h"

#include <algorithm>
#include <iostream>
#include <string>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "colmap_ext/jobs/plan_files.h"
#include "colmap_ext/jobs/refinement_estimate.h"
#include "colmap_ext/terminal/terminal.h"
#include "formats/write_mesh.h"
#include "mesh/mesh_in_image.h"
#include "mesh/space_filling_curve.h"
#include "photometry/image_pyramid.h"

namespace colmap_ext {
namespace {

namespace fs = std::filesystem;

// Margin that a job refines around its tile, so that the fixed surface beyond
// does not influence the tile: twenty edges of the refined facets, px of the
// images.
constexpr double kMarginPixels = 80;

// How far tiles of one colour keep apart, in margins: a job may move what it
// makes a little farther.
constexpr float kReach = 1.5F;

constexpr VisibilityOwner kMergedMesh = {
    "mesh", "merge the tiles again by mesh_merger", std::nullopt};

// Whether a mesh lies where the vertices of a plan do: most of it in the boxes
// of its blocks.
bool IsOfPlan(const PlanBlocks& blocks, const TriangleMesh& mesh) {
  constexpr size_t kNumSamples = 200;
  const size_t stride = mesh.vertices.size() / kNumSamples + 1;
  size_t num_samples = 0;
  size_t num_planned = 0;
  for (size_t i = 0; i < mesh.vertices.size(); i += stride) {
    ++num_samples;
    num_planned += std::ranges::any_of(blocks.boxes, [&](const auto& box) {
      return box.contains(mesh.vertices[i]);
    });
  }
  return 2 * num_planned >= num_samples;
}

Surface ReadMerged(const fs::path& path, const Plan& plan) {
  Surface surface = ReadSurface(path, true, kMergedMesh);
  ExpectViews(surface, plan.views.size(), path, "plan", kMergedMesh);
  if (const MeshReport report = Analyze(surface.mesh); !report.IsManifold()) {
    throw FileError(path, "not 2-manifold (" + report.Defects() +
                              "): take the mesh that mesh_merger has written");
  }
  const VertexAttributes before = std::exchange(surface.attributes, {});
  for (const uint32_t vertex : SortAlongCurve(&surface.mesh)) {
    AddAttributes(before, vertex, &surface.attributes);
  }
  return surface;
}

// [tiles] scene units
std::vector<double> Margins(const Surface& surface, const TileCells& cells,
                            const std::vector<View>& views) {
  std::vector<Surface> parts(cells.size());
  for (size_t i = 0; i < surface.mesh.vertices.size(); ++i) {
    Surface& part = parts[CellOf(cells, surface.mesh.vertices[i])];
    part.mesh.vertices.push_back(surface.mesh.vertices[i]);
    part.attributes.views.AddRow(surface.attributes.views[i]);
  }
  std::vector<double> margins;
  margins.reserve(parts.size());
  for (const Surface& part : parts) {
    margins.push_back(kMarginPixels *
                      MedianFootprint(part.mesh, part.attributes.views, views));
  }
  return margins;
}

std::vector<RefinementTile> PlanTiles(const Surface& surface, const Plan& plan,
                                      const RefinerOptions& options) {
  const TileCells cells = plan.Cells();
  std::vector<RefinementTile> tiles(cells.size());
  std::vector<float> reaches;
  const std::vector<double> margins = Margins(surface, cells, plan.views);
  for (size_t tile = 0; tile < cells.size(); ++tile) {
    tiles[tile].margin = margins[tile];
    reaches.push_back(kReach * static_cast<float>(margins[tile]));
  }
  const std::vector<uint32_t> colors = ColorTiles(cells, reaches, surface.mesh);
  for (size_t tile = 0; tile < cells.size(); ++tile) {
    tiles[tile].color = colors[tile];
  }
  std::vector<View> views = plan.views;
  for (View& view : views) {
    view = ViewAtScale(view, options.image_scale);
  }
  EstimateJobs(surface, cells, views, options, kBoundGbPerFacet, &tiles);
  return tiles;
}

void Identify(const fs::path& mesh_path, const RefinerOptions& options,
              const Plan& plan, RefinementPlan* refinement) {
  std::vector<fs::path> inputs = {mesh_path, VisibilityPath(mesh_path)};
  for (const View& view : plan.views) {
    inputs.push_back(ImagesPath(plan) / view.name);
  }
  const fs::path masks = plan.Options().mesher.scene.mask_path;
  if (MasksOf(plan, {})) {  // throws if there are none
    for (const View& view : plan.views) {
      inputs.push_back(FindMask(masks, view.name));
    }
  }
  refinement->inputs.AddFiles(inputs);
  refinement->inputs.AddOptions(&AddResultOptions, options);
  refinement->Identify(plan);
}

// One that cannot be read is made again.
bool IsThere(const Plan& plan, const RefinementPlan& refinement) {
  try {
    return ReadRefinementPlan(plan).identity == refinement.identity &&
           SurfaceFile(refinement).Exists();
  } catch (const FileError&) {
    return false;
  }
}

// \param refinement  identified
void WriteRefinementPlan(const RefinerOptions& options, const Plan& plan,
                         const PictureDecoder& decoder, Console* console,
                         RefinementPlan* refinement) {
  const fs::path mesh_path = options.input_path;
  const Progress& progress = console->progress;
  Report(progress, "Reading the mesh", 0);
  const Surface surface = ReadMerged(mesh_path, plan);
  if (!IsOfPlan(FilePlan(plan).Blocks(), surface.mesh)) {
    throw FileError(mesh_path,
                    "does not lie where the points of the plan do: it belongs "
                    "to another one");
  }
  fs::remove_all(RefinedSparsePath(plan.folder));
  RefineCameras(options, plan, decoder, console, surface, refinement);
  Report(progress, "Colouring the tiles", 0);
  refinement->tiles = PlanTiles(surface, plan, options);
  Report(progress, "Writing the plan", 0);
  Write(SurfaceFile(*refinement), surface.mesh, surface.attributes);
  WritePlan(*refinement);
}

void PrintCommands(const RefinementPlan& plan) {
  const std::string folder = InShell(plan.folder);
  std::cout << "\nOn Slurm, all at once:\n"
               "  scripts/slurm/refine_tiles "
            << folder << " REFINED.ply\nOn one machine, color after color:\n";
  for (uint32_t color = 0; color < plan.NumColors(); ++color) {
    std::cout << fmt::format(
        "  echo {} | xargs -n 1 -P 2 {} facetwise_refiner --plan_path {} "
        "--tile\n",
        fmt::join(plan.TilesOf(color), " "), ProgramName(), folder);
  }
  std::cout << fmt::format(
      "  {} mesh_merger --plan_path {} --refined 1 --output_path "
      "REFINED.ply\n",
      ProgramName(), folder);
}

void PrintPlan(const RefinementPlan& plan, ReportLog* log) {
  double memory = 0;
  double of_thread = 0;
  double seconds = 0;
  for (const RefinementTile& tile : plan.tiles) {
    memory = std::max(memory, tile.memory_gb);
    of_thread = std::max(of_thread, tile.thread_gb);
    seconds += tile.core_seconds;
  }
  PrintHeading("Refinement in tiles", log);
  Print("tiles", plan.tiles.size(), log);
  Print("colors", plan.NumColors(), log);
  PrintText("memory, largest tile", fmt::format("{:.1f} GB", memory), log);
  PrintText("  and each thread", fmt::format("{:.2f} GB", of_thread), log);
  PrintText("time, all tiles",
            fmt::format("{:.2f} h of a core", seconds / 3600), log);
  PrintText("cameras",
            fs::exists(RefinedSparsePath(plan.folder))
                ? "refined, " + RefinedSparsePath(plan.folder).string()
                : "as they are",
            log);
  PrintCommands(plan);
}

}  // namespace

void PlanRefinement(const RefinerOptions& options,
                    const PictureDecoder& decoder, Console* console) {
  const fs::path folder = options.plan_path;
  const fs::path mesh_path = options.input_path;
  const Plan plan = ReadPlan(folder);
  const FolderLock lock(folder);
  if (!fs::exists(mesh_path)) {
    throw FileError(mesh_path, "no such file; merge the tiles by mesh_merger");
  }
  RefinementPlan refinement;
  Report(console->progress, "Fingerprinting the files", 0);
  Identify(mesh_path, options, plan, &refinement);
  const bool is_kept = IsThere(plan, refinement);
  if (is_kept) {
    refinement = ReadRefinementPlan(plan);
  } else {
    WriteRefinementPlan(options, plan, decoder, console, &refinement);
  }
  console->reporter.Finish();
  if (is_kept) {
    std::cout << "This refinement is planned already: nothing to do"
              << std::endl;
  }
  if (!lock.IsLocked()) {
    PrintWarning(kNoLocks, &console->log);
  }
  PrintPlan(refinement, &console->log);
  console->PrintTime();
  std::cout << "\nPlanned " << RefinementPlanPath(folder).string() << std::endl;
}

void ExpectRefined(const RefinementPlan& plan,
                   const std::vector<uint32_t>& tiles) {
  for (const uint32_t tile : tiles) {
    const JobFile patch = PatchFile(plan, tile);
    if (!patch.Exists()) {
      throw FileError(
          patch.path,
          fmt::format("tile {} of color {} is not refined: run "
                      "facetwise_refiner --plan_path {} --tile {} first",
                      tile, plan.tiles[tile].color, InShell(plan.folder),
                      tile));
    }
  }
}

RefinedMesh MergeRefined(const fs::path& folder, const Progress& progress) {
  const Plan plan = ReadPlan(folder);
  const RefinementPlan refinement = ReadRefinementPlan(plan);
  const std::vector<uint32_t> tiles =
      refinement.TilesBefore(refinement.NumColors());
  ExpectRefined(refinement, tiles);
  RefinerOptions options;
  refinement.SetOptions(&options);
  options.FinishMethod();
  options.refinement.region = plan.region;
  Report(progress, "Putting the tiles together", 0);
  RefinedMesh refined;
  try {
    SurfacePart part =
        GatherSurface(FileSurface(refinement), tiles,
                      [](const Eigen::AlignedBox3f& /*box*/) { return true; });
    refined.mesh = std::move(part.mesh);
    refined.attributes = std::move(part.attributes);
  } catch (const PatchError& error) {
    throw FileError(folder, std::string("the refined tiles do not fit each "
                                        "other (") +
                                error.what() + "): plan larger tiles");
  }
  const MeshReport report = Analyze(refined.mesh);
  if (!report.IsManifold()) {
    throw FileError(folder, "the refined tiles do not fit each other (" +
                                report.Defects() + "): plan larger tiles");
  }
  refined.origins = refined.mesh.vertices;
  refined.labels.labels = Rows<uint32_t>(refined.mesh.facets.size());
  for (const View& view : refinement.views) {
    refined.views.push_back(ViewAtScale(view, options.image_scale));
  }
  FinishRefinement(options.refinement, progress, {}, &refined);
  return refined;
}

}  // namespace colmap_ext
