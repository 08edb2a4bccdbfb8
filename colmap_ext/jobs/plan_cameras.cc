#include <algorithm>
#include <utility>
#include <vector>

#include "colmap_ext/jobs/refine_tiles.h"
#include "colmap_ext/jobs/refinement_input.h"
#include "photometry/photometric_energy.h"
#include "workspace/workspace_paths.h"

namespace colmap_ext {
namespace {

namespace fs = std::filesystem;

// [views] The index of each view's image in the model.
std::vector<size_t> ImagesOf(const std::vector<View>& views,
                             const SparseModel& model, const fs::path& path) {
  std::vector<size_t> of_views;
  for (const View& view : views) {
    const auto found =
        std::ranges::find(model.images, view.name, &SparseImage::name);
    if (found == model.images.end()) {
      throw FileError(path, "has no image " + view.name +
                                ": it is not the model of the plan");
    }
    of_views.push_back(static_cast<size_t>(found - model.images.begin()));
  }
  return of_views;
}

}  // namespace

fs::path ImagesPath(const Plan& plan) {
  return FindUndistortedFolder(plan.workspace_path) / "images";
}

ReadGrayImage MasksOf(const Plan& plan, const PictureDecoder& decoder) {
  const fs::path folder = plan.Options().mesher.scene.mask_path;
  return folder.empty() ? ReadGrayImage()
                        : MaskReader(folder, plan.views, decoder);
}

void RefineCameras(const RefinerOptions& options, const Plan& plan,
                   const PictureDecoder& decoder, Console* console,
                   const Surface& surface, RefinementPlan* refinement) {
  refinement->views = plan.views;
  if (options.refinement.cameras.parts == RefinedParts::kNothing) {
    return;
  }
  const Progress& progress = console->progress;
  Report(progress, "Reading the sparse model", 0);
  ExpectSame(plan);
  SparseModel model = ReadSparseModel(plan.sparse_path, SparseDetail::kAll);
  RefinementInput input;
  input.views = plan.views;
  input.picture_errors.resize(input.views.size());
  input.points = {surface.mesh.vertices, {}, surface.attributes.views};
  input.workspace.sparse_path = plan.sparse_path;
  input.workspace.order.order.images =
      ImagesOf(plan.views, model, plan.sparse_path);
  Report(progress, "Reading the images", 0);
  ReadPictures(options, ImagesPath(plan), MasksOf(plan, decoder), decoder,
               &input);
  SetSparseModel(std::move(model), &input);
  RefinementHooks hooks;
  hooks.progress = progress;
  const CameraAlignment alignment = AlignCameras(
      options.refinement, *input.cameras, surface.mesh, input.points,
      MakeCpuPhotometricEnergy(options.refinement.photometric, input.images,
                               options.MaxDrawingMemory())
          .get(),
      hooks, &input.views);
  console->reporter.Finish();
  PrintReport(alignment, plan.views, &console->log);
  if (!alignment.IsRefined()) {
    return;
  }
  Report(progress, "Writing the cameras", 0);
  WriteRefinedCameras(RefinedSparsePath(plan.folder),
                      options.refinement.cameras.parts, input.views,
                      alignment.track_positions, &input);
  refinement->radial_shifts = alignment.misalignment.radial_shifts;
  for (size_t i = 0; i < plan.views.size(); ++i) {
    refinement->views[i] =
        ResizeView(input.views[i], plan.views[i].width, plan.views[i].height);
  }
}

}  // namespace colmap_ext
