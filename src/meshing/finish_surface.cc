#include "meshing/finish_surface.h"

#include <algorithm>
#include <iterator>
#include <limits>
#include <stdexcept>
#include <unordered_map>
#include <utility>

#include "mesh/confidences.h"
#include "mesh/split_fans.h"
#include "remesh/isotropic_remeshing.h"

namespace colmap_ext {
namespace {

// The attributes of one vertex.
struct Attributes {
  Color color{0, 0, 0};
  std::vector<uint32_t> views;
};

// The mean colour of two points, and the views of either.
Attributes OfPoints(const PointCloud& cloud, uint32_t a, uint32_t b) {
  Attributes attributes;
  if (!cloud.colors.empty()) {
    for (int k = 0; k < 3; ++k) {
      attributes.color[k] = static_cast<uint8_t>(
          (cloud.colors[a][k] + cloud.colors[b][k] + 1) / 2);
    }
  }
  const auto views_a = cloud.views[a];
  const auto views_b = cloud.views[b];
  std::set_union(views_a.begin(), views_a.end(), views_b.begin(), views_b.end(),
                 std::back_inserter(attributes.views));
  return attributes;
}

// The mean colour, and the views that at least half of the neighbors have.
Attributes OfNeighbors(const std::vector<Attributes>& neighbors) {
  Attributes attributes;
  const size_t count = neighbors.size();
  std::vector<uint32_t> views;
  for (int k = 0; k < 3; ++k) {
    size_t sum = count / 2;
    for (const Attributes& neighbor : neighbors) {
      sum += neighbor.color[k];
    }
    attributes.color[k] = static_cast<uint8_t>(sum / count);
  }
  for (const Attributes& neighbor : neighbors) {
    Append(neighbor.views, &views);
  }
  std::ranges::sort(views);
  for (auto first = views.begin(); first != views.end();) {
    const auto last = std::upper_bound(first, views.end(), *first);
    if (2 * static_cast<size_t>(last - first) >= count) {
      attributes.views.push_back(*first);
    }
    first = last;
  }
  return attributes;
}

// Gives attributes to all vertices; holds those alone that are inherited.
class Inheritance {
 public:
  Inheritance(const TriangleMesh& mesh, const PointCloud& cloud,
              const std::vector<std::array<uint32_t, 2>>& points)
      : mesh_(mesh), cloud_(cloud), points_(points) {
    for (const Facet& facet : mesh.facets) {
      for (int k = 0; k < 3; ++k) {
        if (!IsOfPoints(facet[k])) {
          neighbors_[facet[k]].push_back(facet[(k + 1) % 3]);
        }
      }
    }
    for (const auto& [vertex, neighbors] : neighbors_) {
      unknown_.push_back(vertex);
    }
    std::ranges::sort(unknown_);
  }

  VertexAttributes Run() {
    // From the known vertices inwards.
    while (InheritOnce()) {
    }
    VertexAttributes result;
    result.views.offsets.reserve(mesh_.vertices.size() + 1);
    for (uint32_t i = 0; i < mesh_.vertices.size(); ++i) {
      const Attributes attributes = IsKnown(i) ? Of(i) : Attributes();
      if (!cloud_.colors.empty()) {
        result.colors.push_back(attributes.color);
      }
      result.views.AddRow(attributes.views);
    }
    return result;
  }

 private:
  bool IsOfPoints(uint32_t vertex) const {
    const auto& [a, b] = points_[vertex];
    return a != kNone && b != kNone;
  }

  bool IsKnown(uint32_t vertex) const {
    return IsOfPoints(vertex) || inherited_.contains(vertex);
  }

  // \pre it is known
  Attributes Of(uint32_t vertex) const {
    return IsOfPoints(vertex)
               ? OfPoints(cloud_, points_[vertex][0], points_[vertex][1])
               : inherited_.at(vertex);
  }

  // A round: gives attributes to the vertices that have known neighbors.
  // \return whether there were any
  bool InheritOnce() {
    std::vector<std::pair<uint32_t, Attributes>> found;
    std::vector<Attributes> known;
    for (const uint32_t vertex : unknown_) {
      known.clear();
      for (const uint32_t neighbor : neighbors_.at(vertex)) {
        if (IsKnown(neighbor)) {
          known.push_back(Of(neighbor));
        }
      }
      if (!known.empty()) {
        found.emplace_back(vertex, OfNeighbors(known));
      }
    }
    for (auto& [vertex, attributes] : found) {
      inherited_[vertex] = std::move(attributes);
    }
    std::erase_if(unknown_,
                  [&](uint32_t vertex) { return inherited_.contains(vertex); });
    return !found.empty();
  }

  const TriangleMesh& mesh_;
  const PointCloud& cloud_;
  const std::vector<std::array<uint32_t, 2>>& points_;
  std::vector<uint32_t> unknown_;  // vertices, ascending
  std::unordered_map<uint32_t, std::vector<uint32_t>> neighbors_;  // of those
  std::unordered_map<uint32_t, Attributes> inherited_;
};

void DropFacetsAtEnds(const std::vector<uint8_t>& is_end, FanSplit* surface) {
  const auto is_at_end = [&](uint32_t vertex) {
    const auto& [a, b] = surface->from.vertices[vertex];
    return (a < is_end.size() && is_end[a] != 0) ||
           (b < is_end.size() && is_end[b] != 0);
  };
  std::erase_if(surface->mesh.facets, [&](const Facet& facet) {
    return std::ranges::any_of(facet, is_at_end);
  });
}

// Makes it manifold again.
void SplitAgain(FanSplit* surface) {
  FanSplit split = SplitFans(std::move(surface->mesh));
  split.from = Compose(surface->from, std::move(split.from));
  split.num_split_vertices += surface->num_split_vertices;
  split.num_midpoints += surface->num_midpoints;
  *surface = std::move(split);
}

// Makes a surface manifold, drops facets that have an end of rays as a corner
// (there is no evidence of a surface) and those that the options exclude,
// smooths it, and makes the remaining surface manifold again. Facets keep the
// order of the input facets that they are parts of; vertices are in the order
// of their use.
// \param report  gets the counts of what is dropped, copied and split
// \return its sources are vertices of the tetrahedralization
FanSplit SplitAndFilter(const ManifoldMeshingOptions& options,
                        ExtractedSurface extracted, const SurfacePoints& points,
                        ManifoldMeshingReport* report) {
  FanSplit surface =
      SplitFans(std::move(extracted.mesh), std::move(extracted.partners));
  surface.from.facets = {};  // not kept in time
  DropFacetsAtEnds(points.is_end, &surface);
  report->num_long_facets =
      DropLongFacets(options.max_side_length_factor,
                     options.max_side_length_percentile, &surface.mesh);
  if (!points.noises.empty()) {
    // Centroids of split cells are not measured.
    constexpr float kUnknown = std::numeric_limits<float>::infinity();
    report->smoothing = SmoothByNoise(
        MeansOfSources(points.noises, surface.from.vertices, kUnknown),
        options.smoothing, &surface.mesh);
  }
  if (options.region) {
    if (auto clipped = ClipMesh(*options.region, &surface.mesh)) {
      surface.from = Compose(surface.from, std::move(*clipped));
    }
  }
  report->small_components = DropSmallComponents(
      static_cast<size_t>(options.min_component_faces), &surface.mesh.facets);
  SplitAgain(&surface);
  report->num_split_vertices = surface.num_split_vertices;
  report->num_midpoints = surface.num_midpoints;
  return surface;
}

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
void FinishBorders(const BorderOptions& options, const std::vector<View>& views,
                   const Progress& progress, ManifoldMesh* result) {
  Report(progress, "Finishing the borders", 0);
  if (options.trim > 0 || options.close_holes != 0) {
    const Provenance from =
        TrimAndCloseHoles(options, result->facet_confidences, views, result,
                          &result->report.borders);
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

VertexAttributes InheritAttributes(
    const TriangleMesh& mesh, const PointCloud& cloud,
    const std::vector<std::array<uint32_t, 2>>& points) {
  return Inheritance(mesh, cloud, points).Run();
}

std::vector<float> SupportOfVertices(
    size_t num_vertices, const std::vector<uint32_t>& point_vertices,
    const std::vector<float>& point_weights) {
  std::vector<float> supports(num_vertices, 0);
  for (size_t point = 0; point < point_vertices.size(); ++point) {
    supports[point_vertices[point]] += point_weights[point];
  }
  return supports;
}

std::vector<float> MeansOfSources(
    const std::vector<float>& values,
    const std::vector<std::array<uint32_t, 2>>& sources, float missing) {
  const auto value = [&](uint32_t vertex) {
    return vertex < values.size() ? values[vertex] : missing;
  };
  std::vector<float> means;
  means.reserve(sources.size());
  for (const auto& [a, b] : sources) {
    means.push_back((value(a) + value(b)) / 2);
  }
  return means;
}

void MakeSurfaceManifold(const ManifoldMeshingOptions& options,
                         ExtractedSurface extracted, SurfacePoints points,
                         const std::vector<View>& views, ManifoldMesh* result) {
  FanSplit surface =
      SplitAndFilter(options, std::move(extracted), points, &result->report);
  if (surface.mesh.facets.empty()) {
    throw std::invalid_argument(
        "the points and views enclose no surface: nothing to mesh");
  }
  result->mesh = std::move(surface.mesh);
  result->attributes =
      InheritAttributes(result->mesh, points.cloud,
                        PointsOf(surface.from.vertices, points.vertex_points));
  const std::vector<float> supports =
      MeansOfSources(points.supports, surface.from.vertices, 0);
  // What has served goes before more memory is needed.
  points = {};
  surface = {};
  result->facet_confidences =
      FacetConfidences(result->mesh, supports, result->attributes.views, views);
}

void FinishSurface(const ManifoldMeshingOptions& options,
                   const std::vector<View>& views, const Progress& progress,
                   ManifoldMesh* result) {
  ManifoldMeshingReport& report = result->report;
  FinishBorders(options.borders, views, progress, result);
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
