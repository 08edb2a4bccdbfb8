#include "colmap_ext/jobs/refine_tiles.h"

#include <algorithm>
#include <iostream>
#include <set>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "colmap_ext/jobs/plan_files.h"
#include "colmap_ext/jobs/resumable_refinement.h"
#include "spatial/facet_tree.h"

namespace colmap_ext {
namespace {

namespace fs = std::filesystem;

struct TileJob {
  uint32_t tile;
  Plan plan;
  RefinementPlan refinement;
  TileCells cells;
  std::vector<uint32_t> before;  // tiles of lower colours

  uint32_t Color(uint32_t of) const { return refinement.tiles[of].color; }

  // Where vertices are refined.
  Eigen::AlignedBox3f Reach() const {
    return GrowBox(cells[tile],
                   static_cast<float>(refinement.tiles[tile].margin));
  }
  bool IsFree(const Eigen::Vector3f& vertex) const {
    return Reach().contains(vertex) &&
           Color(CellOf(cells, vertex)) >= Color(tile);
  }
};

TileJob MakeTileJob(const fs::path& folder, uint32_t tile) {
  TileJob job{tile, ReadPlan(folder, tile), {}, {}, {}};
  job.refinement = ReadRefinementPlan(job.plan);
  job.cells = job.plan.Cells();
  job.before = job.refinement.TilesBefore(job.Color(tile));
  return job;
}

// The tile, and all around it that may hide it.
struct TileInput {
  SurfacePart part;             // its mesh is manifold
  FixedVertices fixed;          // [V] of the part
  std::vector<uint32_t> views;  // of the plan, ascending, that see the tile
  RefinementInput input;        // of these views
  JobInputs inputs;             // what the result depends on

  // Too few views leave the tile as it is; nothing else is read then.
  bool HasViews() const { return views.size() > 1; }
};

// A vertex of the whole may have several fans in a part.
SurfacePart SplitPart(SurfacePart part) {
  const FanSplit split = SplitFans(part.mesh);
  SurfacePart result;
  result.mesh = split.mesh;
  result.facet_ids = std::move(part.facet_ids);
  for (const auto& source : split.from.vertices) {
    result.ids.push_back(part.ids[source[0]]);
    AddAttributes(part.attributes, source[0], &result.attributes);
  }
  return result;
}

// Rows of the plan's views by their numbers among some of them, ascending;
// others are left out.
Rows<uint32_t> RowsAmong(const std::vector<uint32_t>& views,
                         const Rows<uint32_t>& rows) {
  Rows<uint32_t> among;
  for (size_t i = 0; i < rows.size(); ++i) {
    for (const uint32_t view : rows[i]) {
      if (const uint32_t number = IndexOf(views, view); number != kNone) {
        among.values.push_back(number);
      }
    }
    among.EndRow();
  }
  return among;
}

// \param views [out] that see the target
// \return box of the facets that change
Eigen::AlignedBox3f FindTarget(const TileJob& job, const SurfaceStore& store,
                               std::vector<uint32_t>* views) {
  const Eigen::AlignedBox3f reach = job.Reach();
  const SurfacePart part = GatherSurface(
      store, job.before,
      [&](const Eigen::AlignedBox3f& box) { return reach.intersects(box); });
  std::set<uint32_t> seen_by;
  std::vector<uint8_t> is_free;
  for (size_t i = 0; i < part.ids.size(); ++i) {
    is_free.push_back(job.IsFree(part.mesh.vertices[i]) ? 1 : 0);
    if (is_free[i] != 0) {
      const auto row = part.attributes.views[i];
      seen_by.insert(row.begin(), row.end());
    }
  }
  views->assign(seen_by.begin(), seen_by.end());
  Eigen::AlignedBox3f target;
  for (const Facet& facet : part.mesh.facets) {
    if (is_free[facet[0]] + is_free[facet[1]] + is_free[facet[2]] > 0) {
      target.extend(BoxOf(part.mesh, facet));
    }
  }
  return target;
}

// The target, and all that is fixed and may hide it; its mesh is manifold.
SurfacePart GatherPart(const TileJob& job, const Eigen::AlignedBox3f& target,
                       const std::vector<uint32_t>& views,
                       const SurfaceStore& store) {
  std::vector<Eigen::Vector3f> centers;
  for (const uint32_t view : views) {
    centers.emplace_back(job.refinement.views[view].Center().cast<float>());
  }
  return SplitPart(
      GatherSurface(store, job.before, [&](const Eigen::AlignedBox3f& box) {
        return box.intersects(target) ||
               std::ranges::any_of(centers, [&](const Eigen::Vector3f& center) {
                 return MayHide(box, center, target);
               });
      }));
}

// \return nothing if the plan has no masks
ReadGrayImage TileMasks(const TileJob& job, const std::vector<uint32_t>& views,
                        const PictureDecoder& decoder) {
  const fs::path folder = job.plan.Options().mesher.scene.mask_path;
  if (folder.empty()) {
    return {};
  }
  for (const uint32_t view : views) {
    const fs::path mask = FindMask(folder, job.plan.views[view].name);
    if (!mask.empty()) {
      ExpectSame(job.refinement, mask);
    }
  }
  return [read = MasksOf(job.plan, decoder), views](size_t view) {
    return read(views[view]);
  };
}

// Of what the job starts from: lower colours may have been refined again, by
// another backend.
uint64_t HashOf(const SurfacePart& part) {
  uint64_t hash = HashValues(part.ids);
  hash = HashValues(part.facet_ids, hash);
  hash = HashValues(part.mesh.vertices, hash);
  return HashValues(part.mesh.facets, hash);
}

TileInput ReadTileInput(const TileJob& job, const RefinerOptions& options,
                        const PictureDecoder& decoder,
                        const Progress& progress) {
  Report(progress, "Reading the surface", 0);
  const FileSurface store(job.refinement);
  TileInput tile;
  const Eigen::AlignedBox3f box = FindTarget(job, store, &tile.views);
  if (!tile.HasViews()) {
    return tile;
  }
  tile.part = GatherPart(job, box, tile.views, store);
  RefinementInput& input = tile.input;
  for (const uint32_t view : tile.views) {
    input.views.push_back(job.refinement.views[view]);
  }
  input.mesh = tile.part.mesh;
  input.attributes = tile.part.attributes;
  input.attributes.views = RowsAmong(tile.views, tile.part.attributes.views);
  input.has_fused_points = false;
  input.is_part = true;
  for (uint32_t i = 0; i < input.mesh.vertices.size(); ++i) {
    const Eigen::Vector3f& vertex = input.mesh.vertices[i];
    tile.fixed.push_back(job.IsFree(vertex) ? 0 : 1);
    if (tile.fixed[i] == 0) {
      input.points.positions.push_back(vertex);
      input.points.views.AddRow(input.attributes.views[i]);
    }
  }
  input.fixed_sources = SourcesOf(tile.fixed, tile.fixed.size());
  Report(progress, "Reading the images", 0);
  const fs::path images_path = ImagesPath(job.plan);
  for (const View& view : input.views) {
    ExpectSame(job.refinement, images_path / view.name);
  }
  input.picture_errors.resize(input.views.size());
  ReadPictures(options, input, images_path, TileMasks(job, tile.views, decoder),
               decoder, &input);
  std::vector<RadialShifts> shifts;
  for (const uint32_t view : tile.views) {
    AppendIfAny(job.refinement.radial_shifts, view, &shifts);
  }
  input.images->CorrectLenses(std::move(shifts));
  tile.inputs.options = {
      {"refinement", fmt::format("{}", job.refinement.identity)},
      {"tile", fmt::format("{}", job.tile)},
      {"surface", fmt::format("{:016x}", HashOf(tile.part))},
      {"pictures", fmt::format("{}", fmt::join(input.picture_errors, "\n"))}};
  return tile;
}

void PrintTile(const TileJob& job, const TileInput& tile, ReportLog* log) {
  PrintHeading("Tile", log);
  Print("color", job.Color(job.tile), log);
  Print("images read", tile.views.size(), log);
  PrintReport(tile.input.masks, log);
  Print("faces read", tile.part.mesh.facets.size(), log);
}

// What the job makes of its tile.
// \throw Interruption if it is stopped
TilePatch MakeTile(const TileJob& job, const RefinerOptions& options,
                   const PictureDecoder& decoder, Console* console,
                   ResumableRefinement* run) {
  TileInput tile = ReadTileInput(job, options, decoder, console->progress);
  console->reporter.Finish();
  PrintTile(job, tile, &console->log);
  if (!tile.HasViews()) {
    return {};
  }
  run->inputs = tile.inputs;
  try {
    run->Resume(&tile.input);
    PrintText("continues after", LevelName(run->Level()), &console->log);
  } catch (const FileError&) {
    // Damaged, or of another run: the job starts from its first level.
  }
  RefinedMesh refined = run->Run(&tile.input);
  console->reporter.Finish();
  if (refined.report.is_stopped) {
    throw Interruption(run->Signal(),
                       run->Level() > 0 ? "the tile is refined up to " +
                                              LevelName(run->Level()) +
                                              "; the next job continues from it"
                                        : "the tile is not refined");
  }
  Print("self-intersections", refined.report.num_self_intersections,
        &console->log);
  for (uint32_t& view : refined.attributes.views.values) {
    view = tile.views[view];
  }
  return MakePatch(job.tile, tile.part, tile.fixed, refined.mesh,
                   refined.attributes, refined.fixed_sources);
}

}  // namespace

void RefineTile(RefinerOptions options, const PictureDecoder& decoder,
                Console* console) {
  const TileJob job =
      MakeTileJob(options.plan_path, static_cast<uint32_t>(options.tile));
  job.refinement.SetOptions(&options);
  options.FinishMethod();
  const JobFile patch_file = PatchFile(job.refinement, job.tile);
  if (patch_file.Exists()) {
    RemoveState(patch_file.path);
    std::cout << "Tile " << job.tile << " is refined already: nothing to do"
              << std::endl;
    return;
  }
  ExpectRefined(job.refinement, job.before);
  ResumableRefinement run(options, patch_file.path, console, nullptr);
  const TilePatch patch = MakeTile(job, options, decoder, console, &run);
  Write(patch_file, patch);
  RemoveState(patch_file.path);
  Print("faces refined", patch.removed.size(), &console->log);
  Print("faces that they become", patch.part.mesh.facets.size(), &console->log);
  console->PrintTime();
  std::cout << "\nTile " << job.tile << " is refined" << std::endl;
}

}  // namespace colmap_ext
