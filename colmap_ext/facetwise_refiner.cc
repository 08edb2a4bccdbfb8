#include <string>
#include <vector>

#include "colmap_ext/colmap_compat.h"
#include "colmap_ext/commands.h"
#include "colmap_ext/errors.h"
#include "colmap_ext/jobs/refinement_input.h"
#include "colmap_ext/options/refinement_options.h"
#include "colmap_ext/refinement_run.h"
#include "colmap_ext/report/html_page.h"
#include "colmap_ext/run_command.h"
#include "colmap_ext/viewing/live_view.h"
#include "colmap_ext/viewing/scene_loader.h"
#include "formats/encode_png.h"
#include "viewer/viewer_session.h"

namespace colmap_ext {

namespace {

CommandAdvice Advice() {
  return {
      "a smaller --image_cache_gb keeps fewer images, and a "
      "larger --FacetwiseRefinement.max_face_area makes fewer faces",
      "the mesh, fused.ply.vis, sparse/ and images/",
      {{Alternative::kSayImageOrder, "; say it with --image_order"},
       {Alternative::kOtherImageOrder, "; choose another --image_order"},
       {Alternative::kLeavePicturesOut,
        ", or go on without them with "
        "--FacetwiseRefinement.skip_missing_images 1"}}};
}

void RefineInWindow(const RefinerOptions& options, const RefinementPaths& paths,
                    const std::vector<PageOption>& page_options) {
  try {
    RunWithViewer(
        "facetwise_refiner " + paths.mesh.string(), paths.folder,
        ColmapPictureDecoder(),
        [](const ColorImage& picture) {
          return SaveNumbered(picture, &WritePng);
        },
        [&](LiveView* live) {
          RunRefinement(options, paths, page_options, live);
        });
  } catch (const NoWindowError& error) {
    throw OptionError(error.what() +
                      std::string("; leave --viewer out, and look at the "
                                  "result by mesh_viewer --screenshot_path"));
  }
}

void RefineWorkspace(RefinerOptions options,
                     const std::vector<PageOption>& page_options) {
  const RefinementPaths paths = FindRefinementPaths(options);
  options.ChooseTrim(paths.HasFusedPoints());
  CheckOutputs(options, paths);
  if (options.viewer) {
    RefineInWindow(options, paths, page_options);
  } else {
    RunRefinement(options, paths, page_options, nullptr);
  }
}

}  // namespace

int RunFacetwiseRefiner(int argc, char** argv) {
  // Images and drawings come and go for hours. What is less than a large image,
  // such as values of all faces of most meshes, comes and goes faster on the
  // heap.
  ReturnBlocksFrom(1 << 24);
  RefinerOptions options;
  CommandOptions command;
  AddRefinerOptions(&command, &options);
  const CommandSteps steps = {
      [&options] { options.Finish(); }, &options.num_threads,
      [&options, &command] {
        if (options.plan_path.empty()) {
          RefineWorkspace(options, PageOptions(command));
        } else {
          RunTiledRefinement(options);
        }
      }};
  return RunCommand(argc, argv, command, steps, Advice());
}

}  // namespace colmap_ext
