#include "refine/remesh_for_images.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <memory>
#include <utility>

#include <Eigen/Geometry>

#include "mesh/pixel_footprint.h"
#include "refine/refinable_areas.h"
#include "remesh/carry_attributes.h"
#include "remesh/edge_length_field.h"
#include "remesh/isotropic_remeshing.h"

namespace colmap_ext {

namespace {

// Scene units squared.
float Area(const TriangleMesh& mesh, const Facet& facet) {
  const auto& [a, b, c] = facet;
  return (mesh.vertices[b] - mesh.vertices[a])
             .cross(mesh.vertices[c] - mesh.vertices[a])
             .norm() /
         2;
}

// Of an equilateral triangle.
double EdgeOfArea(double area) { return std::sqrt(area * 4 / std::sqrt(3.0)); }

// [V] the edge length with which the facets around a vertex would cover a
// pixel's area where the images show them largest; infinite where they are not
// seen. Scene units.
std::vector<float> LengthsOfPixels(const TriangleMesh& mesh,
                                   const std::vector<float>& areas) {
  std::vector<float> lengths(mesh.vertices.size(),
                             std::numeric_limits<float>::infinity());
  for (size_t i = 0; i < mesh.facets.size(); ++i) {
    const float area = Area(mesh, mesh.facets[i]);
    if (areas[i] > 0 && area > 0) {
      const auto length = static_cast<float>(EdgeOfArea(area / areas[i]));
      for (const uint32_t vertex : mesh.facets[i]) {
        lengths[vertex] = std::min(lengths[vertex], length);
      }
    }
  }
  return lengths;
}

// [V] as short as is allowed where the surface bends, up to kMaxGrowth times as
// long where it is flat; where fewer than two images see it, multiples of the
// present lengths. Scene units.
// \param area  px^2, of the smallest facets
// \param areas [F] px^2, see RefinableAreas()
std::vector<float> WantedLengths(double area, const TriangleMesh& mesh,
                                 const std::vector<float>& areas) {
  // How far an edge may stray from the surface, px: about what a refined
  // surface errs. This and the factors are choices.
  constexpr float kMaxError = 0.1F;
  constexpr float kMaxGrowth = 3;
  constexpr float kUnseenFactor = 4;
  std::vector<float> lengths = LengthsOfPixels(mesh, areas);
  std::vector<float> errors = lengths;
  for (float& error : errors) {
    error *= kMaxError / static_cast<float>(EdgeOfArea(1));
  }
  const std::vector<float> bent = LengthsForCurvature(mesh, errors);
  const std::vector<float> present = MeanEdgeLengths(mesh);
  const auto side = static_cast<float>(std::sqrt(area));
  for (size_t i = 0; i < lengths.size(); ++i) {
    const float shortest = side * lengths[i];
    lengths[i] = std::isfinite(shortest)
                     ? std::clamp(bent[i], shortest, kMaxGrowth * shortest)
                     : kUnseenFactor * present[i];
  }
  LimitGradation(mesh, kGradation, &lengths);
  return lengths;
}

}  // namespace

FacetVisibility RemeshForImages(double area, const DrawMesh& draw,
                                TriangleMesh* mesh,
                                VertexAttributes* attributes,
                                std::vector<Eigen::Vector3f>* origins,
                                FixedSources* fixed_sources) {
  std::vector<float> lengths;
  {
    const std::shared_ptr<const VisibilityBuffers> buffers = draw(*mesh);
    lengths = WantedLengths(
        area, *mesh,
        RefinableAreas(*mesh, buffers->Views(), FindVisibleFacets(*buffers)));
  }
  RemeshedSurface remeshed = RemeshIsotropically(
      *mesh, lengths, TolerancesOf(lengths), FixedOf(*fixed_sources));
  *attributes = CarryAttributes(*mesh, *attributes, remeshed.sources);
  *origins = ValuesAt(remeshed.sources, *mesh, *origins);
  *mesh = std::move(remeshed.mesh);
  *fixed_sources = CarrySources(*fixed_sources, remeshed.fixed_sources);
  return FindVisibleFacets(*draw(*mesh));
}

size_t ExpectedFacets(double area, const TriangleMesh& mesh,
                      const Rows<uint32_t>& vertex_views,
                      const std::vector<View>& views) {
  const double footprint = MedianFootprint(mesh, vertex_views, views);
  double total_area = 0;
  for (const Facet& facet : mesh.facets) {
    total_area += Area(mesh, facet);
  }
  const double expected =
      footprint > 0 ? total_area / (area * footprint * footprint) : 0;
  return std::max(mesh.facets.size(), static_cast<size_t>(expected));
}

}  // namespace colmap_ext
