#include "colmap_ext/jobs/refine_tile.h"

#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "colmap_ext/jobs/plan_refinement.h"
#include "colmap_ext/jobs/refinement_backend.h"
#include "colmap_ext/jobs/refinement_job.h"
#include "colmap_ext/jobs/surface_files.h"
#include "colmap_ext/jobs/tile_state.h"
#include "photometry/image_pyramid.h"
#include "refine/facet_sizes.h"
#include "workspace/masks.h"
#include "workspace/usable_pictures.h"

namespace colmap_ext {
namespace {

namespace fs = std::filesystem;

// Rows of views by other numbers; those without one are left out.
Rows<uint32_t> Renumber(const Rows<uint32_t>& rows,
                        const std::vector<uint32_t>& numbers) {
  Rows<uint32_t> renumbered;
  for (size_t i = 0; i < rows.size(); ++i) {
    for (const uint32_t view : rows[i]) {
      if (numbers[view] != kNone) {
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
  ReadGrayImage read_mask;  // of the views; empty: no masks
  std::shared_ptr<ImagePyramid> images;
  std::vector<std::string> errors;  // [views] empty: can be used
};

// \return nothing if the plan has no masks
ReadGrayImage TileMasks(const RefinementJob& job,
                        const RefinementTarget& target,
                        const PictureDecoder& decoder) {
  const fs::path folder = job.plan.Options(job.folder).mesher.scene.mask_path;
  if (folder.empty()) {
    return {};
  }
  for (const uint32_t view : target.views) {
    const fs::path mask = FindMask(folder, job.plan.views[view].name);
    if (!mask.empty()) {
      ExpectSame(job.refinement, mask);
    }
  }
  return [read = MaskReader(folder, job.plan.views, decoder),
          views = target.views](size_t view) { return read(views[view]); };
}

TilePictures ReadPictures(const RefinementJob& job,
                          const RefinementTarget& target,
                          const RefinerOptions& options,
                          const PictureDecoder& decoder) {
  const fs::path images_path = ImagesPath(job.plan);
  TilePictures pictures;
  for (const uint32_t view : target.views) {
    pictures.views.push_back(job.plan.views[view]);
    ExpectSame(job.refinement, images_path / pictures.views.back().name);
  }
  pictures.errors.resize(pictures.views.size());
  pictures.read_mask = TileMasks(job, target, decoder);
  pictures.images = std::make_shared<ImagePyramid>(
      pictures.views, PictureReader(images_path, pictures.views, decoder),
      options.MaxImageMemory(), pictures.read_mask,
      options.MaxMemoryLentToImages());
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

// [views of the plan] their numbers in the target, or kNone.
std::vector<uint32_t> NumbersOf(const RefinementTarget& target,
                                size_t num_views) {
  std::vector<uint32_t> numbers(num_views, kNone);
  for (uint32_t i = 0; i < target.views.size(); ++i) {
    numbers[target.views[i]] = i;
  }
  return numbers;
}

RefinementStart StartAt(const SurfacePart& part, const FixedVertices& fixed,
                        const std::vector<uint32_t>& numbers, int num_levels) {
  RefinementStart start;
  start.mesh = part.mesh;
  start.attributes = part.attributes;
  start.attributes.views = Renumber(part.attributes.views, numbers);
  start.first_level = num_levels - 1;
  start.has_fused_points = false;
  start.fixed_sources = SourcesOf(fixed, part.mesh.vertices.size());
  start.is_part = true;
  return start;
}

// Goes on from what an earlier job has left, and leaves what it has done.
RefinedMesh Refine(const RefinementJob& job, const RefinementTarget& target,
                   const SurfacePart& part, const FixedVertices& fixed,
                   const RefinerOptions& options, const PictureDecoder& decoder,
                   RefinementHooks hooks, RefineTileReport* report) {
  Report(hooks.progress, "Reading the images", 0);
  const TilePictures pictures = ReadPictures(job, target, options, decoder);
  FacetwiseRefinementOptions method = options.refinement;
  method.cameras.parts = RefinedParts::kNothing;
  RefinementStart start = StartAt(
      part, fixed, NumbersOf(target, job.plan.views.size()), method.levels);
  PointCloud points = PointsOf(part, start.attributes.views, fixed);
  if (pictures.read_mask) {
    report->masks = MaskCloud(pictures.read_mask, pictures.views, &points);
  }
  RemoveUnusable(ImagesPath(job.plan), pictures.errors, &points);
  TileState state(job, part, pictures.errors);
  report->resumed_level = state.GoOn(pictures.views, &start);
  report->last_level = report->resumed_level;
  hooks.on_level = [&](int level, const RefinedMesh& refined) {
    if (level > 0) {
      state.Write(level, refined);
      report->last_level = level;
    }
  };
  const RefinementBackend backend = MakeBackend(
      options, pictures.images,
      ExpectedFacets(method.max_face_area, start.mesh, start.attributes.views,
                     pictures.views),
      [&](const std::string& warning) { report->warnings.push_back(warning); });
  report->computed_by = backend.description;
  RefinedMesh refined =
      RefineFacetwise(method, std::move(start), pictures.views, points,
                      backend.energy.get(), hooks);
  refined.attributes.views = Renumber(refined.attributes.views, target.views);
  return refined;
}

// Where too few views see a tile it stays as it is.
constexpr size_t kMinViews = 2;

// What the job makes of its tile; of no meaning if it is stopped.
TilePatch MakeTile(const RefinementJob& job, const RefinerOptions& options,
                   const PictureDecoder& decoder, const RefinementHooks& hooks,
                   RefineTileReport* report) {
  Report(hooks.progress, "Reading the surface", 0);
  const FileSurface store(job.folder, job.refinement.identity);
  const RefinementTarget target = FindTarget(job, store);
  if (target.views.size() < kMinViews) {
    return {};
  }
  const SurfacePart part = GatherPart(job, target, store);
  const FixedVertices fixed = FixedIn(job, part);
  report->num_views = target.views.size();
  report->num_facets = part.mesh.facets.size();
  RefinedMesh refined =
      Refine(job, target, part, fixed, options, decoder, hooks, report);
  report->refinement = std::move(refined.report);
  if (report->refinement.is_stopped) {
    return {};
  }
  return MakePatch(job.tile, part, fixed, refined.mesh, refined.attributes,
                   refined.fixed_sources);
}

}  // namespace

RefineTileReport RefineTile(const fs::path& folder, uint32_t tile,
                            RefinerOptions options,
                            const PictureDecoder& decoder,
                            const RefinementHooks& hooks) {
  const RefinementJob job = MakeRefinementJob(folder, tile);
  job.refinement.SetOptions(folder, &options);
  options.FinishMethod();
  RefineTileReport report;
  report.color = job.Color(tile);
  report.is_kept = HasPatch(folder, job.refinement.identity, tile);
  if (!report.is_kept) {
    ExpectRefined(folder, job.refinement, job.before);
    const TilePatch patch = MakeTile(job, options, decoder, hooks, &report);
    if (report.refinement.is_stopped) {
      return report;
    }
    report.num_removed = patch.removed.size();
    report.num_added = patch.part.mesh.facets.size();
    Report(hooks.progress, "Writing the tile", 0);
    WritePatch(folder, job.refinement.identity, tile, patch);
  }
  RemoveState(PatchPath(folder, tile));
  return report;
}

}  // namespace colmap_ext
