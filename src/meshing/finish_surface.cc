#include "meshing/finish_surface.h"

#include <algorithm>
#include <limits>
#include <map>
#include <stdexcept>
#include <utility>

#include "mesh/clip_mesh.h"
#include "mesh/confidences.h"
#include "mesh/split_fans.h"
#include "remesh/isotropic_remeshing.h"

namespace colmap_ext {
namespace {

// Appends the mean colour of some vertices, and the views that at least half of
// them have.
void AppendMean(const VertexAttributes& vertices, VertexAttributes* all) {
  const size_t count = vertices.views.size();
  if (!vertices.colors.empty()) {
    Color& mean = all->colors.emplace_back();
    for (int k = 0; k < 3; ++k) {
      size_t sum = count / 2;
      for (const Color& color : vertices.colors) {
        sum += color[k];
      }
      mean[k] = static_cast<uint8_t>(sum / count);
    }
  }
  std::vector<uint32_t> views = vertices.views.values;
  std::ranges::sort(views);
  for (auto first = views.begin(); first != views.end();) {
    const auto last = std::upper_bound(first, views.end(), *first);
    if (2 * static_cast<size_t>(last - first) >= count) {
      all->views.values.push_back(*first);
    }
    first = last;
  }
  all->views.EndRow();
}

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

// Makes a surface manifold, drops facets that have an end of rays as a corner
// (there is no evidence of a surface) and those that the options exclude,
// smooths it, and makes the remaining surface manifold again. Facets keep the
// order of the input facets that they are parts of; vertices are in the order
// of their use.
// \param report  gets the counts of what is dropped, copied and split
// \return its sources are vertices of the tetrahedralization
DerivedMesh SplitAndFilter(const ManifoldMeshingOptions& options,
                           ExtractedSurface extracted,
                           const SurfacePoints& points,
                           const std::vector<View>& views,
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
    std::vector<Eigen::Vector3f> centers;
    for (const View& view : views) {
      centers.emplace_back(view.Center().cast<float>());
    }
    report->smoothing = SmoothByNoise(
        centers, MeansOfSources(points.noises, surface.from.vertices, kUnknown),
        options.smoothing, &surface.mesh);
  }
  if (options.region) {
    if (auto clipped = ClipMesh(*options.region, &surface.mesh)) {
      surface.from = Compose(surface.from, std::move(*clipped));
    }
  }
  report->num_small_components = DropSmallComponents(
      static_cast<size_t>(options.min_component_faces), &surface.mesh.facets);
  FanSplit split = SplitFans(std::move(surface.mesh));
  split.from = Compose(surface.from, std::move(split.from));
  report->num_split_vertices =
      surface.num_split_vertices + split.num_split_vertices;
  report->num_midpoints = surface.num_midpoints + split.num_midpoints;
  return split;
}

// Confidences of a mesh's facets after a change; those of new ones are 0.
void Inherit(const Provenance& from, std::vector<float>* facet_confidences) {
  std::vector<float> inherited;
  inherited.reserve(from.facets.size());
  for (const uint32_t source : from.facets) {
    inherited.push_back(source == kNone ? 0.0f : (*facet_confidences)[source]);
  }
  facet_confidences->swap(inherited);
}

// Trims the mesh, closes its holes, and gives confidences to the vertices of
// what comes out.
// \param result  with facet_confidences
void FinishBorders(const BorderOptions& options, const std::vector<View>& views,
                   const Progress& progress, ManifoldMesh* result) {
  Report(progress, "Finishing the borders", 0);
  if (options.trim > 0 || options.close_holes != 0) {
    Inherit(TrimAndCloseHoles(options, result->facet_confidences, views, result,
                              &result->report.borders),
            &result->facet_confidences);
  }
  result->attributes.confidences =
      VertexConfidences(result->mesh, result->facet_confidences);
}

// The manifold surface with the attributes and confidences of its points.
void MakeManifold(const ManifoldMeshingOptions& options,
                  ExtractedSurface extracted, SurfacePoints points,
                  const std::vector<View>& views, ManifoldMesh* result) {
  DerivedMesh surface = SplitAndFilter(options, std::move(extracted), points,
                                       views, &result->report);
  if (surface.mesh.facets.empty()) {
    throw std::invalid_argument(
        "the points and views enclose no surface to mesh: enlarge the region");
  }
  const std::vector<float> supports =
      MeansOfSources(points.supports, surface.from.vertices, 0);
  result->mesh = std::move(surface.mesh);
  result->attributes =
      InheritAttributes(result->mesh, std::move(surface.from.vertices),
                        std::move(points.attributes));
  points = {};  // before more memory is needed
  result->facet_confidences =
      FacetConfidences(result->mesh, supports, result->attributes.views, views);
}

}  // namespace

VertexAttributes AttributesOfPoints(
    const PointCloud& cloud, const std::vector<uint32_t>& vertex_points) {
  VertexAttributes attributes;
  attributes.views = MakeRows<uint32_t>(
      vertex_points.size(), [&](size_t i, std::vector<uint32_t>* views) {
        Append(cloud.views[vertex_points[i]], views);
      });
  for (const uint32_t point : vertex_points) {
    AppendIfAny(cloud.colors, point, &attributes.colors);
  }
  return attributes;
}

VertexAttributes InheritAttributes(const TriangleMesh& mesh,
                                   std::vector<std::array<uint32_t, 2>> sources,
                                   VertexAttributes attributes) {
  const auto next_row = [&] {
    return static_cast<uint32_t>(attributes.views.size());
  };
  for (auto& [a, b] : sources) {
    if (std::max(a, b) >= next_row()) {
      a = b = kNone;
    }
  }
  const auto is_known = [&](uint32_t vertex) {
    return sources[vertex][0] != kNone;
  };
  std::map<uint32_t, std::vector<uint32_t>> neighbors;  // of unknown vertices
  for (const Facet& facet : mesh.facets) {
    for (int k = 0; k < 3; ++k) {
      if (!is_known(facet[k])) {
        neighbors[facet[k]].push_back(facet[(k + 1) % 3]);
      }
    }
  }
  // From the known vertices inwards: those found get new rows.
  std::vector<std::array<uint32_t, 2>> known;
  for (uint32_t first_row = kNone; first_row != next_row();) {
    first_row = next_row();
    std::vector<uint32_t> found;
    for (const auto& [vertex, ring] : neighbors) {
      known.clear();
      for (const uint32_t neighbor : ring) {
        if (is_known(neighbor)) {
          known.push_back(sources[neighbor]);
        }
      }
      if (!known.empty()) {
        found.push_back(vertex);
        AppendMean(InterpolateAttributes(attributes, known), &attributes);
      }
    }
    for (uint32_t i = 0; i < found.size(); ++i) {
      sources[found[i]].fill(first_row + i);
      neighbors.erase(found[i]);
    }
  }
  // The others have nothing.
  for (auto& source : sources) {
    std::ranges::replace(source, kNone, next_row());
  }
  attributes.views.EndRow();
  attributes.colors.resize(attributes.colors.empty() ? 0 : next_row());
  return InterpolateAttributes(attributes, sources);
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

void FinishSurface(const ManifoldMeshingOptions& options,
                   ExtractedSurface extracted, SurfacePoints points,
                   const std::vector<View>& views, const Progress& progress,
                   ManifoldMesh* result) {
  ManifoldMeshingReport& report = result->report;
  MakeManifold(options, std::move(extracted), std::move(points), views, result);
  FinishBorders(options.borders, views, progress, result);
  if (options.remeshing) {
    Report(progress, "Remeshing", 0);
    RemeshEvenly(result);
    result->facet_confidences =
        MeanOfCorners(result->mesh.facets, result->attributes.confidences);
  }
  Report(progress, "Repairing self-intersections", 0);
  report.self_intersections = RepairSelfIntersections(&result->mesh);
  Inherit(FinishRepair(&report.self_intersections.num_after, result),
          &result->facet_confidences);
  if (options.smoothing > 0) {
    Unfold(&result->mesh);
  }
  Report(progress, "Checking the mesh", 0);
  report.mesh = Analyze(result->mesh);
  if (!report.mesh.IsManifold()) {
    throw std::logic_error("the mesh is not manifold: " +
                           report.mesh.Defects());
  }
}

}  // namespace colmap_ext
