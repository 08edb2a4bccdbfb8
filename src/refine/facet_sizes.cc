#include "refine/facet_sizes.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <memory>
#include <utility>

#include <tbb/parallel_for.h>

#include "base/indices.h"
#include "mesh/mesh_in_image.h"
#include "mesh/normals.h"
#include "mesh/subdivision.h"
#include "remesh/isotropic_remeshing.h"

namespace colmap_ext {

std::vector<float> RefinableAreas(const TriangleMesh& mesh,
                                  const std::vector<View>& views,
                                  const FacetVisibility& visibility) {
  std::vector<float> areas(mesh.facets.size(), 0);
  tbb::parallel_for(size_t{0}, areas.size(), [&](size_t i) {
    double largest = 0;
    double second = 0;
    for (const uint32_t view : visibility[i]) {
      const double area = AreaInImage(mesh, mesh.facets[i], views[view]);
      second = std::max(second, std::min(area, largest));
      largest = std::max(area, largest);
    }
    areas[i] = static_cast<float>(second);
  });
  return areas;
}

namespace {

// [F] 1 where a facet covers more than max_area and has no fixed edge, else 0.
std::vector<uint8_t> FindLarge(double max_area, const TriangleMesh& mesh,
                               const std::vector<float>& areas,
                               const FixedVertices& fixed) {
  std::vector<uint8_t> is_large(areas.size(), 0);
  for (size_t i = 0; i < areas.size(); ++i) {
    const auto num_fixed = std::ranges::count_if(
        mesh.facets[i],
        [&](uint32_t vertex) { return IsFixed(fixed, vertex); });
    is_large[i] = areas[i] > max_area && num_fixed < 2;
  }
  return is_large;
}

// The RefinableAreas() of a mesh that was subdivided. They are computed for new
// facets alone.
// \param drawn_facets [F] of the buffers' mesh, that each facet is a part of
// \param sources [F] of the mesh before, ascending: likewise
// \param before  the areas of the mesh before
std::vector<float> AreasOfParts(const VisibilityBuffers& buffers,
                                const TriangleMesh& mesh,
                                const std::vector<uint32_t>& drawn_facets,
                                const std::vector<uint32_t>& sources,
                                const std::vector<float>& before) {
  std::vector<float> areas(sources.size());
  std::vector<uint32_t> new_facets;
  TriangleMesh parts{mesh.vertices, {}};
  std::vector<uint32_t> drawn_facets_of_parts;
  for (uint32_t i = 0; i < sources.size(); ++i) {
    areas[i] = before[sources[i]];
    if ((i > 0 && sources[i - 1] == sources[i]) ||
        (i + 1 < sources.size() && sources[i + 1] == sources[i])) {
      new_facets.push_back(i);
      parts.facets.push_back(mesh.facets[i]);
      drawn_facets_of_parts.push_back(drawn_facets[i]);
    }
  }
  const std::vector<float> new_areas =
      RefinableAreas(parts, buffers.Views(),
                     FindVisibleParts(buffers, parts, drawn_facets_of_parts));
  for (size_t k = 0; k < new_facets.size(); ++k) {
    areas[new_facets[k]] = new_areas[k];
  }
  return areas;
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
    const float area = AreaVector(mesh, mesh.facets[i]).norm() / 2;
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

FacetVisibility SubdivideLargeFacets(double max_area, const DrawMesh& draw,
                                     Surface* surface) {
  // A round cuts a facet in four: 4^8 parts are enough for one that is 65536
  // times too large.
  constexpr int kMaxRounds = 8;
  std::shared_ptr<const VisibilityBuffers> buffers = draw(surface->mesh);
  FacetVisibility visibility = FindVisibleFacets(*buffers);
  std::vector<float> areas =
      RefinableAreas(surface->mesh, buffers->Views(), visibility);
  std::vector<uint32_t> drawn_facets = Iota(areas.size());
  for (int round = 0; round < kMaxRounds; ++round) {
    const FixedVertices fixed = FixedOf(surface->fixed_sources);
    const std::vector<uint8_t> is_large =
        FindLarge(max_area, surface->mesh, areas, fixed);
    if (std::ranges::find(is_large, 1) == is_large.end()) {
      break;
    }
    visibility = {};  // large where many images see each facet
    DerivedMesh derived = Subdivide(surface->mesh, is_large, fixed);
    const std::vector<uint32_t> sources = derived.from.facets;
    for (uint32_t& facet : derived.from.facets) {
      facet = drawn_facets[facet];
    }
    drawn_facets = std::move(derived.from.facets);
    surface->Become(std::move(derived));
    areas = AreasOfParts(*buffers, surface->mesh, drawn_facets, sources, areas);
  }
  if (visibility.size() > 0) {
    return visibility;
  }
  buffers.reset();  // before others take memory
  return FindVisibleFacets(*draw(surface->mesh));
}

FacetVisibility RemeshForImages(double area, const DrawMesh& draw,
                                Surface* surface) {
  std::vector<float> lengths;
  {
    const std::shared_ptr<const VisibilityBuffers> buffers =
        draw(surface->mesh);
    lengths = WantedLengths(area, surface->mesh,
                            RefinableAreas(surface->mesh, buffers->Views(),
                                           FindVisibleFacets(*buffers)));
  }
  draw({});  // lets go of what was drawn, before others take memory
  BecomeRemeshed(
      RemeshIsotropically(surface->mesh, lengths, TolerancesOf(lengths),
                          FixedOf(surface->fixed_sources)),
      surface);
  return FindVisibleFacets(*draw(surface->mesh));
}

std::vector<float> ExpectedParts(double area, const TriangleMesh& mesh,
                                 const Rows<uint32_t>& vertex_views,
                                 const std::vector<View>& views) {
  FacetVisibility visibility;
  for (const Facet& facet : mesh.facets) {
    std::vector<uint32_t> of_facet;
    for (const uint32_t vertex : facet) {
      Append(vertex_views[vertex], &of_facet);
    }
    SortUnique(&of_facet);
    visibility.AddRow(of_facet);
  }
  const std::vector<float> lengths =
      WantedLengths(area, mesh, RefinableAreas(mesh, views, visibility));
  std::vector<float> parts(mesh.facets.size());
  tbb::parallel_for(size_t{0}, parts.size(), [&](size_t i) {
    const auto [a, b, c] = mesh.facets[i];
    const double length = (lengths[a] + lengths[b] + lengths[c]) / 3;
    const double wanted = std::pow(length / EdgeOfArea(1), 2);
    parts[i] = static_cast<float>(AreaVector(mesh, mesh.facets[i]).norm() / 2 /
                                  wanted);
  });
  return parts;
}

}  // namespace colmap_ext
