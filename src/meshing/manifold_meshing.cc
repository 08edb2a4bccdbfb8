#include "meshing/manifold_meshing.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <span>
#include <stdexcept>
#include <utility>

#include "base/heap.h"
#include "base/percentile.h"
#include "meshing/finish_surface.h"
#include "meshing/singular_vertices.h"
#include "meshing/wall_layers.h"

namespace colmap_ext {
namespace {

// The points that vote, and the ends of rays.
WeightedCloud Prepare(const ManifoldMeshingOptions& options, PointCloud cloud,
                      const std::vector<View>& views, const RayEnds& ends,
                      const Progress& progress, ManifoldMeshingReport* report) {
  report->num_points = cloud.size();
  report->num_observations = cloud.views.values.size();
  std::vector<float> weights = ObservationWeights(options, cloud);
  WeightedCloud weighted{std::move(cloud), std::move(weights),
                         report->num_points};
  RayEnds cropped;
  if (options.region) {
    cropped = CropCloud(*options.region, views, &weighted);
    report->num_outside_points = report->num_points - weighted.num_points;
    if (weighted.num_points == 0) {
      throw std::invalid_argument("no point lies in the region: enlarge it");
    }
  }
  if (options.drop_weaker_layers) {
    Report(progress, "Looking for double walls", 0);
    report->num_weaker_points = DropWeakerLayers(views, &weighted);
  }
  report->num_ray_ends = ends.size() + cropped.size();
  AppendEnds(ends, &weighted);
  AppendEnds(cropped, &weighted);
  return weighted;
}

Observations ObserveDepths(PointCloud ends) {
  Observations observations;
  for (const uint32_t view : ends.views.values) {
    observations.AddRow(std::array{Observation{view, kDepthRayWeight}});
  }
  observations.points = std::move(ends.positions);
  observations.are_free = true;
  return observations;
}

// The graph whose minimum cut is the surface [Romanoni2020, section IV].
// \param is_end [V] see MarkEnds()
FlowCapacities MakeGraph(const ManifoldMeshingOptions& options,
                         const WeightedCloud& weighted,
                         const std::vector<uint8_t>& is_end,
                         const std::vector<View>& views,
                         const std::vector<uint32_t>& point_vertices,
                         const Tetrahedralization& tetrahedra,
                         PointCloud depth_ends, const Progress& progress,
                         ManifoldMeshingReport* report) {
  Report(progress, "Weighing facets", 0);
  FlowCapacities graph = ZeroCapacities(tetrahedra);
  AddQualityWeights(tetrahedra, options.quality_regularization, &graph);
  std::vector<float> lengths = EdgeLengths(tetrahedra, is_end);
  report->distance_sigma = lengths.empty()
                               ? 0
                               : options.distance_sigma_factor *
                                     Percentile(kSigmaPercentile, &lengths);
  if (!(report->distance_sigma > 0)) {
    throw std::invalid_argument(
        "too few points to mesh in the region, or left by the masks: take a "
        "larger region, or mask less");
  }
  std::vector<Eigen::Vector3d> centers;
  for (const View& view : views) {
    centers.push_back(view.Center());
  }
  Observations observations =
      ObserveVertices(weighted.cloud, tetrahedra.points.size(), point_vertices,
                      weighted.weights);
  observations.is_end = is_end;
  const VisibilityWeightOptions rays = {report->distance_sigma,
                                        options.behind_sigma};
  report->rays = AddVisibilityWeights(tetrahedra, observations, centers, rays,
                                      &graph, progress);
  if (depth_ends.size() > 0) {
    report->rays +=
        AddVisibilityWeights(tetrahedra, ObserveDepths(std::move(depth_ends)),
                             centers, rays, &graph, progress);
  }
  return graph;
}

std::vector<uint8_t> CutGraph(const Tetrahedralization& tetrahedra,
                              const FlowCapacities& graph,
                              const Progress& progress,
                              ManifoldMeshingReport* report) {
  Report(progress, "Cutting the graph", 0);
  MinCut cut = ComputeMinCut(NeighborsOf(tetrahedra), graph);
  report->flow = cut.flow;
  report->cut = CutValue(NeighborsOf(tetrahedra), graph, cut.on_source_side);
  report->num_free_cells =
      static_cast<size_t>(std::ranges::count(cut.on_source_side, 1));
  if (report->flow != report->cut) {
    throw std::logic_error("the minimum cut differs from the maximum flow");
  }
  return std::move(cut.on_source_side);
}

FixingReport Fix(const ManifoldMeshingOptions& options,
                 Tetrahedralization* tetrahedra, FlowCapacities* graph,
                 std::vector<uint8_t>* is_free, const Progress& progress) {
  Report(progress, "Fixing singular vertices", 0);
  if (options.preemptive_fixing) {
    return FixSingularVertices(options.fixing_rule, tetrahedra, graph, is_free);
  }
  const size_t num = SingularVertices(*tetrahedra, *is_free).size();
  return {.num_singular_raw = num, .num_singular_fixed = num};
}

// The surface between free space and matter. What else it is made from is freed
// when it returns.
// \param points  gets what the vertices stand for
ExtractedSurface CutSurface(const ManifoldMeshingOptions& options,
                            PointCloud cloud, const std::vector<View>& views,
                            const Progress& progress, const RayEnds& ends,
                            PointCloud depth_ends, SurfacePoints* points,
                            ManifoldMeshingReport* report) {
  WeightedCloud weighted =
      Prepare(options, std::move(cloud), views, ends, progress, report);
  Report(progress, "Thinning points", 0);
  ThinnedPoints thinned = ThinPoints(weighted.cloud, views, options.thinning);
  Tetrahedralization tetrahedra =
      Tetrahedralize(std::move(thinned.positions), progress);
  report->num_duplicate_points = thinned.num_duplicate_points;
  report->num_vertices = tetrahedra.points.size();
  report->num_cells = tetrahedra.cells.size();
  points->is_end = MarkEnds(thinned, &weighted);
  points->supports = SupportOfVertices(
      report->num_vertices, thinned.point_vertices, weighted.weights);
  if (options.smoothing > 0) {
    Report(progress, "Measuring the noise", 0);
    points->noises = LocalNoise(
        std::span(weighted.cloud.positions).first(weighted.num_points),
        tetrahedra.points);
  }
  FlowCapacities graph = MakeGraph(options, weighted, points->is_end, views,
                                   thinned.point_vertices, tetrahedra,
                                   std::move(depth_ends), progress, report);
  // The cut needs most memory: what is no longer needed is freed first.
  points->attributes =
      AttributesOfPoints(weighted.cloud, thinned.vertex_points);
  thinned = {};
  weighted = {};
  ReturnFreedMemory();
  std::vector<uint8_t> is_free = CutGraph(tetrahedra, graph, progress, report);
  report->fixing = Fix(options, &tetrahedra, &graph, &is_free, progress);
  FlowCapacities().swap(graph);
  Report(progress, "Extracting the surface", 0);
  return ExtractSurface(tetrahedra, is_free);
}

}  // namespace

std::vector<float> ObservationWeights(const ManifoldMeshingOptions& options,
                                      const PointCloud& cloud) {
  std::vector<float> alphas(cloud.size(),
                            static_cast<float>(options.alpha_vis));
  if (options.alpha_kind == ObservationWeight::kTracks) {
    for (size_t point = 0; point < cloud.size(); ++point) {
      const double ratio = static_cast<double>(cloud.views[point].size()) /
                           options.visibility_sigma;
      alphas[point] = static_cast<float>(1 - std::exp(-0.5 * ratio * ratio));
    }
  }
  return alphas;
}

ManifoldMesh MeshManifold(const ManifoldMeshingOptions& options,
                          PointCloud cloud, const std::vector<View>& views,
                          const Progress& progress, const RayEnds& ends,
                          PointCloud depth_ends) {
  if (cloud.views.values.empty()) {
    throw std::invalid_argument("no view sees any point: nothing to mesh");
  }
  ManifoldMesh result;
  result.report.num_depth_rays = depth_ends.size();
  SurfacePoints points;
  ExtractedSurface extracted =
      CutSurface(options, std::move(cloud), views, progress, ends,
                 std::move(depth_ends), &points, &result.report);
  FinishSurface(options, std::move(extracted), std::move(points), views,
                progress, &result);
  return result;
}

}  // namespace colmap_ext
