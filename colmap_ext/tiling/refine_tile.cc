#include "colmap_ext/tiling/refine_tile.h"

#include <algorithm>
#include <memory>
#include <set>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "colmap_ext/refinement/refinement_backend.h"
#include "colmap_ext/tiling/plan_refinement.h"
#include "colmap_ext/tiling/surface_files.h"
#include "formats/errors.h"
#include "mesh/fan_split.h"
#include "mesh/half_edges.h"
#include "mesh/topology.h"
#include "photometry/image_pyramid.h"
#include "tiles/tile_cells.h"
#include "workspace/usable_pictures.h"

namespace colmap_ext {
namespace {

namespace fs = std::filesystem;

// What a job knows of the plan.
struct TileJob {
  fs::path folder;
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

void ExpectRefined(const fs::path& folder, const RefinementPlan& plan,
                   const std::vector<uint32_t>& tiles) {
  for (const uint32_t tile : tiles) {
    if (!HasPatch(folder, plan.identity, tile)) {
      throw FileError(
          PatchPath(folder, tile),
          fmt::format("tile {} of colour {} is not refined: run "
                      "facetwise_refiner --plan {} --tile {} first",
                      tile, plan.tiles[tile].color, folder.string(), tile));
    }
  }
}

TileJob MakeJob(const fs::path& folder, uint32_t tile) {
  TileJob job{folder, tile, ReadPlan(folder), {}, {}, {}};
  if (tile >= job.plan.tiles.size()) {
    throw FileError(PlanPath(folder),
                    fmt::format("has no tile {}, but those from 0 to {}", tile,
                                job.plan.tiles.size() - 1));
  }
  job.refinement = ReadRefinementPlan(folder, job.plan);
  for (const PlannedTile& planned : job.plan.tiles) {
    job.cells.push_back(planned.cell);
  }
  job.before = job.refinement.TilesBefore(job.Color(tile));
  return job;
}

// What the job refines, and from where it is seen.
struct Target {
  Eigen::AlignedBox3f box;      // of the facets that change
  std::vector<uint32_t> views;  // ascending
};

Target FindTarget(const TileJob& job, const SurfaceStore& store) {
  const Eigen::AlignedBox3f reach = job.Reach();
  const SurfacePart part = GatherSurface(
      store, job.before,
      [&](const Eigen::AlignedBox3f& box) { return reach.intersects(box); });
  Target target;
  std::set<uint32_t> views;
  std::vector<uint8_t> is_free;
  for (size_t i = 0; i < part.ids.size(); ++i) {
    is_free.push_back(job.IsFree(part.mesh.vertices[i]) ? 1 : 0);
    if (is_free[i] != 0) {
      const auto row = part.attributes.views[i];
      views.insert(row.begin(), row.end());
    }
  }
  for (const Facet& facet : part.mesh.facets) {
    if (is_free[facet[0]] + is_free[facet[1]] + is_free[facet[2]] > 0) {
      target.box.extend(BoxOf(part.mesh, facet));
    }
  }
  target.views.assign(views.begin(), views.end());
  return target;
}

// A vertex of the whole may have several fans in a part.
SurfacePart SplitPart(SurfacePart part) {
  const FanSplit split = SplitFans(part.mesh, PairHalfEdges(part.mesh.facets));
  SurfacePart result;
  result.mesh = split.mesh;
  result.facet_ids = std::move(part.facet_ids);
  for (const auto& source : split.sources) {
    result.ids.push_back(part.ids[source[0]]);
    AddAttributes(part.attributes, source[0], &result.attributes);
  }
  return result;
}

// All that is fixed and may hide the target, and the target.
SurfacePart GatherPart(const TileJob& job, const Target& target,
                       const SurfaceStore& store) {
  std::vector<Eigen::Vector3f> centers;
  for (const uint32_t view : target.views) {
    centers.emplace_back(job.plan.views[view].Center().cast<float>());
  }
  return SplitPart(
      GatherSurface(store, job.before, [&](const Eigen::AlignedBox3f& box) {
        return box.intersects(target.box) ||
               std::ranges::any_of(centers, [&](const Eigen::Vector3f& center) {
                 return MayHide(box, center, target.box);
               });
      }));
}

// Rows of views by other numbers; those without one are left out.
Rows<uint32_t> Renumber(const Rows<uint32_t>& rows,
                        const std::vector<uint32_t>& numbers) {
  Rows<uint32_t> renumbered;
  for (size_t i = 0; i < rows.size(); ++i) {
    for (const uint32_t view : rows[i]) {
      if (numbers[view] != kNoSource) {
        renumbered.values.push_back(numbers[view]);
      }
    }
    renumbered.EndRow();
  }
  return renumbered;
}

// The pictures of some of a plan's views.
struct TilePictures {
  std::vector<View> views;
  std::shared_ptr<ImagePyramid> images;
  std::vector<std::string> errors;  // [views] empty: can be used
};

TilePictures ReadPictures(const TileJob& job, const Target& target,
                          const RefinerOptions& options,
                          const PictureDecoder& decoder) {
  const fs::path images_path = ImagesPath(job.plan);
  TilePictures pictures;
  for (const uint32_t view : target.views) {
    pictures.views.push_back(job.plan.views[view]);
    ExpectSameInput(job.refinement, images_path / pictures.views.back().name);
  }
  pictures.errors.resize(pictures.views.size());
  pictures.images = std::make_shared<ImagePyramid>(
      pictures.views, PictureReader(images_path, pictures.views, decoder),
      options.MaxImageMemory());
  FindUnreadable([&](size_t view) { pictures.images->Image(view); },
                 &pictures.errors);
  if (!options.skip_missing_images) {
    ExpectPictures(images_path, pictures.views, pictures.errors);
  }
  return pictures;
}

// The vertices of the target, as the points that tell which views have most in
// common.
PointCloud PointsOf(const SurfacePart& part, const Rows<uint32_t>& views,
                    const FixedVertices& fixed) {
  PointCloud points;
  for (uint32_t i = 0; i < fixed.size(); ++i) {
    if (!IsFixed(fixed, i)) {
      points.positions.push_back(part.mesh.vertices[i]);
      points.views.AddRow(views[i]);
    }
  }
  return points;
}

RefinedMesh Refine(const TileJob& job, const Target& target,
                   const SurfacePart& part, const FixedVertices& fixed,
                   const RefinerOptions& options, const PictureDecoder& decoder,
                   const RefinementHooks& hooks, std::string* computed_by) {
  Report(hooks.progress, "Reading the images", 0);
  const TilePictures pictures = ReadPictures(job, target, options, decoder);
  std::vector<uint32_t> numbers(job.plan.views.size(), kNoSource);
  for (uint32_t i = 0; i < target.views.size(); ++i) {
    numbers[target.views[i]] = i;
  }
  RefinementStart start;
  start.mesh = part.mesh;
  start.attributes = part.attributes;
  start.attributes.views = Renumber(part.attributes.views, numbers);
  start.first_level = options.refinement.levels - 1;
  start.has_fused_points = false;
  start.fixed = fixed;
  start.is_part = true;
  PointCloud points = PointsOf(part, start.attributes.views, fixed);
  RemoveUnusable(ImagesPath(job.plan), pictures.errors, &points);
  const RefinementBackend backend = MakeBackend(options, pictures.images);
  *computed_by = backend.description;
  FacetwiseRefinementOptions method = options.refinement;
  method.cameras.parts = RefinedParts::kNone;
  RefinedMesh refined =
      RefineFacetwise(method, std::move(start), pictures.views, points,
                      backend.energy.get(), hooks);
  refined.attributes.views = Renumber(refined.attributes.views, target.views);
  return refined;
}

// Where too few views see a tile it stays as it is.
constexpr size_t kMinViews = 2;

}  // namespace

RefineTileReport RefineTile(const fs::path& folder, uint32_t tile,
                            RefinerOptions options,
                            const PictureDecoder& decoder,
                            const RefinementHooks& hooks) {
  const TileJob job = MakeJob(folder, tile);
  RefineTileReport report;
  report.color = job.Color(tile);
  if (HasPatch(folder, job.refinement.identity, tile)) {
    report.is_kept = true;
    return report;
  }
  ExpectRefined(folder, job.refinement, job.before);
  ApplyOptions(folder, job.refinement, &options);
  options.FinishMethod();
  Report(hooks.progress, "Reading the surface", 0);
  const FileSurface store(folder, job.refinement.identity);
  const Target target = FindTarget(job, store);
  TilePatch patch;
  if (target.views.size() >= kMinViews) {
    const SurfacePart part = GatherPart(job, target, store);
    FixedVertices fixed;
    for (const Eigen::Vector3f& vertex : part.mesh.vertices) {
      fixed.push_back(job.IsFree(vertex) ? 0 : 1);
    }
    RefinedMesh refined = Refine(job, target, part, fixed, options, decoder,
                                 hooks, &report.computed_by);
    report.refinement = std::move(refined.report);
    report.num_views = target.views.size();
    report.num_facets = part.mesh.facets.size();
    if (report.refinement.is_stopped) {
      return report;
    }
    patch = MakePatch(tile, part, fixed, refined.mesh, refined.attributes,
                      refined.fixed_sources);
  }
  report.num_removed = patch.removed.size();
  report.num_added = patch.part.mesh.facets.size();
  Report(hooks.progress, "Writing the tile", 0);
  WritePatch(folder, job.refinement.identity, tile, patch);
  return report;
}

RefinedMesh MergeRefined(const fs::path& folder, const Progress& progress) {
  const Plan plan = ReadPlan(folder);
  const RefinementPlan refinement = ReadRefinementPlan(folder, plan);
  const std::vector<uint32_t> tiles =
      refinement.TilesBefore(refinement.NumColors());
  ExpectRefined(folder, refinement, tiles);
  RefinerOptions options;
  ApplyOptions(folder, refinement, &options);
  options.FinishMethod();
  Report(progress, "Putting the tiles together", 0);
  RefinedMesh refined;
  try {
    SurfacePart part =
        GatherSurface(FileSurface(folder, refinement.identity), tiles,
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
  refined.views = plan.views;
  FinishRefinement(options.refinement, progress, &refined);
  return refined;
}

}  // namespace colmap_ext
