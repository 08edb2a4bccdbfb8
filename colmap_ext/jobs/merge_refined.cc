#include "colmap_ext/jobs/merge_plan.h"

#include <string>
#include <utility>
#include <vector>

#include "colmap_ext/jobs/surface_files.h"
#include "colmap_ext/jobs/tile_job.h"
#include "formats/errors.h"
#include "mesh/topology.h"
#include "refine/facetwise_refinement.h"

namespace colmap_ext {

namespace fs = std::filesystem;

RefinedMesh MergeRefined(const fs::path& folder, const Progress& progress) {
  const Plan plan = ReadPlan(folder);
  const RefinementPlan refinement = ReadRefinementPlan(folder, plan);
  const std::vector<uint32_t> tiles =
      refinement.TilesBefore(refinement.NumColors());
  ExpectRefined(folder, refinement, tiles);
  RefinerOptions options;
  refinement.SetOptions(folder, &options);
  options.FinishMethod();
  options.refinement.region = plan.region;
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
