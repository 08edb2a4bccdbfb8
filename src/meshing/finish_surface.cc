#include "meshing/finish_surface.h"

#include <array>
#include <stdexcept>
#include <utility>

#include "mesh/confidences.h"
#include "mesh/manifold_repair.h"
#include "meshing/filter_surface.h"
#include "meshing/inherit_attributes.h"
#include "meshing/point_support.h"
#include "remesh/isotropic_remeshing.h"
#include "repair/self_intersection_repair.h"

namespace colmap_ext {
namespace {

// The fused points that the surface's vertices come from.
std::vector<std::array<uint32_t, 2>> PointsOf(
    const std::vector<std::array<uint32_t, 2>>& vertices,
    const std::vector<uint32_t>& vertex_points) {
  const auto point = [&](uint32_t vertex) {
    // Centroids of split cells come after the vertices that are points.
    return vertex < vertex_points.size() ? vertex_points[vertex] : kNone;
  };
  std::vector<std::array<uint32_t, 2>> points;
  points.reserve(vertices.size());
  for (const auto& [a, b] : vertices) {
    points.push_back({point(a), point(b)});
  }
  return points;
}

// Trims the mesh, closes its holes, and gives confidences to the vertices of
// what comes out.
// \param result  with facet_confidences
void FinishBorders(const BorderOptions& options, const Progress& progress,
                   ManifoldMesh* result) {
  Report(progress, "Finishing the borders", 0);
  if (options.trim > 0 || options.close_holes != 0) {
    const Provenance from = EditBorders(options, result->facet_confidences,
                                        result, &result->report.borders);
    std::vector<float> facet_confidences;
    facet_confidences.reserve(from.facets.size());
    for (const uint32_t source : from.facets) {
      facet_confidences.push_back(
          source == kNone ? 0.0f : result->facet_confidences[source]);
    }
    result->facet_confidences = std::move(facet_confidences);
  }
  result->attributes.confidences =
      VertexConfidences(result->mesh, result->facet_confidences);
}

}  // namespace

void SplitSurface(const ManifoldMeshingOptions& options,
                  ExtractedSurface extracted, SurfacePoints points,
                  const std::vector<View>& views, ManifoldMesh* result) {
  FanSplit surface = SplitAndFilter(options, std::move(extracted),
                                    points.is_end, &result->report);
  if (surface.mesh.facets.empty()) {
    throw std::invalid_argument(
        "the points and views enclose no surface: nothing to mesh");
  }
  result->mesh = std::move(surface.mesh);
  result->attributes =
      InheritAttributes(result->mesh, points.cloud,
                        PointsOf(surface.from.vertices, points.vertex_points));
  const std::vector<float> supports =
      SupportOfSurface(points.supports, surface.from.vertices);
  // What has served goes before more memory is needed.
  points = {};
  surface = {};
  result->facet_confidences =
      FacetConfidences(result->mesh, supports, result->attributes.views, views);
}

void FinishSurface(const ManifoldMeshingOptions& options,
                   const Progress& progress, ManifoldMesh* result) {
  ManifoldMeshingReport& report = result->report;
  FinishBorders(options.borders, progress, result);
  if (options.remeshing) {
    Report(progress, "Remeshing", 0);
    RemeshEvenly(result);
    result->facet_confidences =
        MeanOfCorners(result->mesh.facets, result->attributes.confidences);
  }
  Report(progress, "Repairing self-intersections", 0);
  report.self_intersections = RepairSelfIntersections(&result->mesh);
  Report(progress, "Checking the mesh", 0);
  report.mesh = Analyze(result->mesh);
  if (!report.mesh.IsManifold()) {
    throw std::logic_error("the mesh is not manifold: " +
                           report.mesh.Defects());
  }
}

}  // namespace colmap_ext
