#include "colmap_ext/jobs/refine_tiles.h"
#include "colmap_ext/jobs/refinement_input.h"
#include "photometry/photometric_energy.h"
#include "workspace/workspace_paths.h"

namespace colmap_ext {

namespace fs = std::filesystem;

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
  ExpectSame(plan);
  RefinementInput input;
  input.views = plan.views;
  input.picture_errors.resize(input.views.size());
  input.points = {surface.mesh.vertices, {}, surface.attributes.views};
  Report(progress, "Reading the images", 0);
  ReadPictures(options, surface, ImagesPath(plan), MasksOf(plan, decoder),
               decoder, &input);
  Report(progress, "Reading the sparse model", 0);
  input.cameras =
      ReadRefinableCameras(plan.sparse_path, input.views, input.images);
  RefinementHooks hooks;
  hooks.progress = progress;
  const CameraAlignment alignment = AlignCameras(
      options.refinement, *input.cameras, surface.mesh, input.points,
      MakeCpuPhotometricEnergy(options.refinement.photometric, input.images,
                               input.MaxDrawingMemory())
          .get(),
      hooks, &input.views);
  console->reporter.Finish();
  PrintReport(alignment, plan.views, &console->log);
  if (!alignment.IsRefined()) {
    return;
  }
  Report(progress, "Writing the cameras", 0);
  WriteRefinedCameras(RefinedSparsePath(plan.folder),
                      options.refinement.cameras.parts, plan.sparse_path,
                      input.views, alignment.track_positions);
  refinement->radial_shifts = alignment.misalignment.radial_shifts;
  for (size_t i = 0; i < plan.views.size(); ++i) {
    refinement->views[i] =
        ResizeView(input.views[i], plan.views[i].width, plan.views[i].height);
  }
}

}  // namespace colmap_ext
