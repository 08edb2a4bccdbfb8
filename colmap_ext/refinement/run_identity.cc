#include "colmap_ext/refinement/run_identity.h"

#include <filesystem>
#include <utility>

#include <fmt/format.h>

#include "colmap_ext/refinement/file_fingerprint.h"
#include "formats/read_region.h"
#include "formats/write_mesh.h"
#include "workspace/sparse_model.h"

namespace colmap_ext {

namespace {

namespace fs = std::filesystem;

// "{}" of a double is the shortest text that is read back as the same number.
RunIdentity IdentifyOptions(const RefinerOptions& options,
                            const std::string& image_order,
                            const std::string& region) {
  const FacetwiseRefinementOptions& refinement = options.refinement;
  const PhotometricOptions& photometric = refinement.photometric;
  const FacetLabelingOptions& labeling = refinement.labeling;
  return {
      {"image_order", image_order},
      {"region", region},
      {"levels", fmt::format("{}", refinement.levels)},
      {"iterations", fmt::format("{}", refinement.iterations)},
      {"window", fmt::format("{}", options.window)},
      {"noise_variance", fmt::format("{}", photometric.noise_variance)},
      {"residual_floor", fmt::format("{}", photometric.residual_floor)},
      {"min_cosine", fmt::format("{}", photometric.min_cosine)},
      {"smoothness_weight", fmt::format("{}", refinement.smoothness_weight)},
      {"refine_cameras", options.words.refine_cameras},
      {"remeshing", fmt::format("{:d}", refinement.remeshing)},
      {"max_face_area", fmt::format("{}", refinement.max_face_area)},
      {"min_zncc", fmt::format("{}", refinement.min_zncc)},
      {"pairs_per_image", fmt::format("{}", refinement.pairs_per_image)},
      {"pairs_per_facet", fmt::format("{}", labeling.pairs_per_facet)},
      {"final_pairs_per_facet",
       fmt::format("{}", labeling.final_pairs_per_facet)},
      {"potts_weight", fmt::format("{}", labeling.potts_weight)},
      {"pair_selection", options.words.pair_selection},
      {"occlusion_masking", fmt::format("{:d}", photometric.occlusion_masking)},
      {"solver", options.words.solver},
      {"trim", fmt::format("{}", refinement.borders.trim)},
      {"close_holes", fmt::format("{}", refinement.borders.close_holes)},
      {"skip_missing_images", fmt::format("{:d}", options.skip_missing_images)},
  };
}

}  // namespace

RunIdentity IdentifyRun(const RefinerOptions& options,
                        const RefinementPaths& paths,
                        const RefinementInput& input) {
  std::vector<std::pair<std::string, fs::path>> files = {
      {"--input_path", paths.mesh},
      {"--input_path.vis", VisibilityPath(paths.mesh)}};
  files.emplace_back("fused.ply", paths.fused);
  files.emplace_back("fused.ply.vis", VisibilityPath(paths.fused));
  for (const fs::path& path : SparseModelFiles(input.workspace.sparse_path)) {
    files.emplace_back("sparse/" + path.filename().string(), path);
  }
  for (const View& view : input.views) {
    files.emplace_back("images/" + view.name,
                       paths.folder / "images" / view.name);
  }
  if (input.masks) {
    for (const View& view : input.views) {
      files.emplace_back("masks/" + view.name,
                         FindMask(options.scene.mask_path, view.name));
    }
  }
  std::vector<fs::path> file_paths;
  for (const auto& [name, path] : files) {
    file_paths.push_back(path);
  }
  const std::vector<std::string> fingerprints = Fingerprints(file_paths);
  RunIdentity identity =
      IdentifyOptions(options, NameOf(input.workspace.order.order.kind),
                      input.region ? RegionText(*input.region) : "");
  for (size_t i = 0; i < files.size(); ++i) {
    identity.emplace_back(files[i].first, fingerprints[i]);
  }
  return identity;
}

}  // namespace colmap_ext
