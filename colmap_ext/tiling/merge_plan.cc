#include "colmap_ext/tiling/merge_plan.h"

#include <memory>
#include <utility>
#include <vector>

#include "colmap_ext/tiling/plan.h"
#include "colmap_ext/tiling/plan_files.h"
#include "formats/scratch_file.h"
#include "formats/write_mesh.h"
#include "meshing/finish_surface.h"
#include "tiles/banded_mesh.h"
#include "tiles/merged_surface.h"
#include "tiles/seam_cut.h"
#include "tiles/singular_patch.h"
#include "tiles/vertex_points.h"

namespace colmap_ext {
namespace {

namespace fs = std::filesystem;

// Labels of all cells of a plan's tiles, where these do not tell.
struct Fixed {
  SeamLabels seam;
  SingularPatch patch;
};

Fixed CutAndFix(const FilePlan& plan, const FileParts& parts,
                const ManifoldMeshingOptions& options, const Progress& progress,
                MergeReport* report) {
  Report(progress, "Cutting the seams", 0);
  std::vector<TileSeam> seams;
  for (uint32_t tile = 0; tile < plan.Blocks().NumTiles(); ++tile) {
    seams.push_back(parts.ReadSeam(tile));
  }
  Fixed fixed{CutSeams(seams), {}};
  seams = {};
  report->num_cut_cells = fixed.seam.num_cut_cells;
  Report(progress, "Fixing singular vertices", 0);
  if (options.preemptive_fixing) {
    fixed.patch = FixPatches(plan, parts, fixed.seam, options.fixing_rule);
  }
  report->meshing.fixing = fixed.patch.report;
  return fixed;
}

ReadAttributes Reader(const FilePlan& plan) {
  return [&plan](const std::vector<uint32_t>& ids) {
    return plan.ReadAttributes(ids);
  };
}

void WriteBanded(const fs::path& path,
                 const std::optional<Eigen::Matrix4d>& transform,
                 const BandedMesh& banded) {
  const SectionedMesh& mesh = banded.mesh;
  const bool has_colors = banded.colors.size() > 0;
  MeshWriter writer(path, {mesh.NumVertices(), mesh.NumFacets(), has_colors,
                           true, transform});
  size_t first_view = 0;
  for (size_t section = 0; section < mesh.NumSections(); ++section) {
    const uint32_t begin = mesh.FirstVertex(section);
    const uint32_t end = mesh.FirstVertex(section + 1);
    VertexAttributes attributes;
    if (has_colors) {
      attributes.colors = banded.colors.Read(begin, end);
    }
    attributes.confidences = banded.confidences.Read(begin, end);
    for (const uint32_t count : banded.num_views.Read(begin, end)) {
      attributes.views.offsets.push_back(attributes.views.offsets.back() +
                                         count);
    }
    const size_t last_view = first_view + attributes.views.offsets.back();
    attributes.views.values = banded.views.Read(first_view, last_view);
    first_view = last_view;
    writer.AddVertices(mesh.ReadPositions(begin, end), attributes);
  }
  for (size_t section = 0; section < mesh.NumSections(); ++section) {
    writer.AddFacets(mesh.ReadFacets(mesh.FirstFacet(section),
                                     mesh.FirstFacet(section + 1)));
  }
  writer.Commit();
}

// One band at a time; the mesh is put together in files beside it.
void MergeInBands(const ManifoldMeshingOptions& options,
                  const std::vector<View>& views, const FilePlan& plan,
                  const FileParts& parts, const fs::path& output_path,
                  const std::optional<Eigen::Matrix4d>& transform,
                  const Progress& progress, MergeReport* report) {
  const fs::path folder = fs::absolute(output_path).parent_path();
  const MakeStore make_store = [&] {
    return std::make_unique<ScratchFile>(folder);
  };
  std::unique_ptr<SurfaceBands> bands;
  {
    const Fixed fixed = CutAndFix(plan, parts, options, progress, report);
    Report(progress, "Extracting the surface", 0);
    const PlanSurface surface(plan, parts, fixed.seam, fixed.patch);
    bands = std::make_unique<SurfaceBands>(plan, CentroidsOf(plan, fixed.patch),
                                           make_store);
    for (uint32_t tile = 0; tile < plan.Blocks().NumTiles(); ++tile) {
      bands->Add(surface.Read(tile));
    }
    bands->Finish(surface.PatchFixes());
  }
  Report(progress, "Splitting vertices", 0);
  const BandedMesh banded = FinishBands(options, *bands, Reader(plan), views,
                                        progress, make_store, &report->meshing);
  bands.reset();
  Report(progress, "Writing the mesh", 0);
  WriteBanded(output_path, transform, banded);
}

void MergeWhole(const ManifoldMeshingOptions& options,
                const std::vector<View>& views, const FilePlan& plan,
                const FileParts& parts, const fs::path& output_path,
                const std::optional<Eigen::Matrix4d>& transform,
                const Progress& progress, MergeReport* report) {
  MergedSurface merged;
  {
    const Fixed fixed = CutAndFix(plan, parts, options, progress, report);
    Report(progress, "Extracting the surface", 0);
    merged = MergeSurface(plan, parts, fixed.seam, fixed.patch);
  }
  ManifoldMesh result;
  result.report = report->meshing;
  {
    const VertexPoints points =
        PointsOf(merged.ids, plan.Blocks().NumVertices(), Reader(plan));
    std::vector<uint32_t>().swap(merged.ids);
    SplitSurface(options, std::move(merged.extracted), points.AsSurfacePoints(),
                 views, &result);
  }
  FinishSurface(options, progress, &result);
  report->meshing = result.report;
  Report(progress, "Writing the mesh", 0);
  WriteMesh(output_path, result.mesh, result.attributes, transform);
}

}  // namespace

MergeReport MergePlan(const fs::path& folder, const fs::path& output_path,
                      const std::optional<Eigen::Matrix4d>& transform,
                      const Progress& progress) {
  const Plan plan = ReadPlan(folder);
  ExpectSameInputs(plan);
  ManifoldMeshingOptions options = MeshingOptionsOf(folder, plan).meshing;
  options.region = plan.region;
  MergeReport report;
  if (const auto found = plan.options.find("region");
      found != plan.options.end() && found->second == "auto") {
    report.found_region = plan.region;
  }
  const FilePlan vertices(folder, plan);
  const FileParts parts(folder, plan);
  report.num_tiles = plan.tiles.size();
  report.meshing.num_vertices = vertices.Blocks().NumVertices();
  report.meshing.distance_sigma = plan.distance_sigma;
  report.whole_by = NeedsWholeSurface(options);
  const auto merge = report.whole_by.empty() ? MergeInBands : MergeWhole;
  merge(options, plan.views, vertices, parts, output_path, transform, progress,
        &report);
  return report;
}

}  // namespace colmap_ext
