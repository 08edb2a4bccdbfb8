#include "colmap_ext/tiling/merge_plan.h"

#include <memory>
#include <utility>
#include <vector>

#include "colmap_ext/tiling/plan.h"
#include "colmap_ext/tiling/plan_files.h"
#include "formats/scratch_file.h"
#include "formats/write_mesh.h"
#include "merging/banded_mesh.h"
#include "merging/fix_plan.h"
#include "merging/labeled_parts.h"
#include "merging/merged_surface.h"
#include "merging/seam_cut.h"
#include "merging/vertex_points.h"
#include "meshing/finish_surface.h"

namespace colmap_ext {
namespace {

namespace fs = std::filesystem;

// The cells of a plan, cut and fixed.
struct MergedCells {
  MergedCells(const FilePlan& vertices, const FileParts& parts)
      : seam(vertices.Blocks(), parts), changes(vertices.Blocks()) {}

  SeamLabels seam;
  CellChanges changes;
};

std::unique_ptr<MergedCells> CutAndFix(const Plan& plan,
                                       const FilePlan& vertices,
                                       const FileParts& parts,
                                       const ManifoldMeshingOptions& options,
                                       const Progress& progress,
                                       MergeReport* report) {
  auto cells = std::make_unique<MergedCells>(vertices, parts);
  report->num_contradictions =
      CutSeams(plan.seam_rings, &cells->seam, progress);
  report->num_cut_cells = cells->seam.NumUnknown();
  if (options.preemptive_fixing) {
    report->meshing.fixing =
        FixPlan(vertices, parts, cells->seam, options.fixing_rule,
                plan.seam_rings == kAllAtOnce, &cells->changes, progress);
  }
  return cells;
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
void MergeInBands(const Plan& plan, const ManifoldMeshingOptions& options,
                  const FilePlan& vertices, const FileParts& parts,
                  const fs::path& output_path,
                  const std::optional<Eigen::Matrix4d>& transform,
                  const Progress& progress, MergeReport* report) {
  const fs::path folder = fs::absolute(output_path).parent_path();
  const MakeStore make_store = [&] {
    return std::make_unique<ScratchFile>(folder);
  };
  std::unique_ptr<SurfaceBands> bands;
  {
    const auto cells =
        CutAndFix(plan, vertices, parts, options, progress, report);
    const LabeledParts labeled(parts, cells->seam, cells->changes);
    bands = std::make_unique<SurfaceBands>(vertices, cells->changes.centroids(),
                                           make_store);
    const size_t num_tiles = vertices.Blocks().NumTiles();
    for (uint32_t tile = 0; tile < num_tiles; ++tile) {
      Report(progress, "Extracting the surface",
             static_cast<double>(tile) / static_cast<double>(num_tiles));
      bands->Add(SurfaceOf(labeled, vertices.Blocks(), tile));
    }
    bands->Finish();
  }
  Report(progress, "Splitting vertices", 0);
  const BandedMesh banded =
      FinishBands(options, *bands, Reader(vertices), plan.views, progress,
                  make_store, &report->meshing);
  bands.reset();
  Report(progress, "Writing the mesh", 0);
  WriteBanded(output_path, transform, banded);
}

void MergeWhole(const Plan& plan, const ManifoldMeshingOptions& options,
                const FilePlan& vertices, const FileParts& parts,
                const fs::path& output_path,
                const std::optional<Eigen::Matrix4d>& transform,
                const Progress& progress, MergeReport* report) {
  MergedSurface merged;
  {
    const auto cells =
        CutAndFix(plan, vertices, parts, options, progress, report);
    Report(progress, "Extracting the surface", 0);
    merged = MergeSurface(vertices, {parts, cells->seam, cells->changes},
                          cells->changes.centroids());
  }
  ManifoldMesh result;
  result.report = report->meshing;
  {
    const VertexPoints points =
        PointsOf(merged.ids, vertices.Blocks().NumVertices(), Reader(vertices));
    std::vector<uint32_t>().swap(merged.ids);
    SplitSurface(options, std::move(merged.extracted), points.AsSurfacePoints(),
                 plan.views, &result);
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
  merge(plan, options, vertices, parts, output_path, transform, progress,
        &report);
  return report;
}

}  // namespace colmap_ext
