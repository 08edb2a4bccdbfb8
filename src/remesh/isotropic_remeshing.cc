#include "remesh/isotropic_remeshing.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include <tbb/parallel_for.h>

#include "base/indices.h"
#include "base/rows.h"
#include "mesh/adjacency.h"
#include "mesh/normals.h"
#include "mesh/space_filling_curve.h"
#include "remesh/anchored_mesh.h"

namespace colmap_ext {

std::vector<float> MeanEdgeLengths(const TriangleMesh& mesh) {
  // So that a vertex's own facets decide less than the surface around it.
  constexpr int kSmoothings = 3;
  const VertexRings rings = MakeVertexRings(mesh);
  const auto means = MeanLengths(rings.neighbors, mesh.vertices);
  std::vector<float> lengths(means.begin(), means.end());
  for (int k = 0; k < kSmoothings; ++k) {
    const std::vector<float> before = lengths;
    tbb::parallel_for(size_t{0}, lengths.size(), [&](size_t i) {
      float sum = 0;
      for (const uint32_t neighbor : rings.neighbors[i]) {
        sum += before[neighbor];
      }
      const auto count = static_cast<float>(rings.neighbors[i].size());
      lengths[i] = count > 0 ? (before[i] + sum / count) / 2 : 0;
    });
  }
  return lengths;
}

std::vector<float> LengthsForCurvature(const TriangleMesh& mesh,
                                       const std::vector<float>& tolerances) {
  const VertexRings rings = MakeVertexRings(mesh);
  const std::vector<Eigen::Vector3f> normals = VertexNormals(mesh, rings);
  std::vector<float> lengths(mesh.vertices.size());
  tbb::parallel_for(size_t{0}, lengths.size(), [&](size_t i) {
    float curvature = 0;
    for (const uint32_t neighbor : rings.neighbors[i]) {
      const float length = (mesh.vertices[neighbor] - mesh.vertices[i]).norm();
      if (length > 0) {
        curvature = std::max(curvature,
                             (normals[neighbor] - normals[i]).norm() / length);
      }
    }
    const float tolerance = tolerances[i];
    const bool is_bounded = curvature > 0 && std::isfinite(tolerance);
    lengths[i] =
        is_bounded
            ? std::sqrt(std::max(
                  6 * tolerance / curvature - 3 * tolerance * tolerance, 0.0F))
            : std::numeric_limits<float>::infinity();
  });
  return lengths;
}

void LimitGradation(const TriangleMesh& mesh, float gradation,
                    std::vector<float>* lengths) {
  const auto growth = [&](uint32_t from, uint32_t to) {
    return gradation * (mesh.vertices[to] - mesh.vertices[from]).norm();
  };
  LowerAlongEdges(MakeVertexRings(mesh), std::numeric_limits<float>::infinity(),
                  growth, lengths);
}

std::vector<float> TolerancesOf(std::vector<float> lengths) {
  constexpr float kShare = 0.1F;
  for (float& length : lengths) {
    length *= kShare;
  }
  return lengths;
}

VertexAttributes CarryAttributes(const TriangleMesh& mesh,
                                 const VertexAttributes& attributes,
                                 const std::vector<SurfacePoint>& points) {
  VertexAttributes carried;
  if (!attributes.confidences.empty()) {
    carried.confidences = ValuesAt(points, mesh, attributes.confidences);
  }
  carried.colors.resize(attributes.colors.empty() ? 0 : points.size());
  const auto append = [&](size_t i, std::vector<uint32_t>* all) {
    const Facet& facet = mesh.facets[points[i].facet];
    std::vector<uint32_t> views;
    Eigen::Vector3f color = Eigen::Vector3f::Zero();
    for (int k = 0; k < 3; ++k) {
      const float weight = points[i].weights[k];
      if (!(weight > 0)) {
        continue;
      }
      Append(attributes.views[facet[k]], &views);
      for (int c = 0; c < 3 && !carried.colors.empty(); ++c) {
        color[c] += weight * static_cast<float>(attributes.colors[facet[k]][c]);
      }
    }
    SortUnique(&views);
    Append(views, all);
    for (int c = 0; c < 3 && !carried.colors.empty(); ++c) {
      carried.colors[i][c] =
          static_cast<uint8_t>(std::clamp(std::lround(color[c]), 0L, 255L));
    }
  };
  carried.views = MakeRows<uint32_t>(points.size(), append);
  return carried;
}

namespace {

// Lengths that allow for fixed edges: beside a longer one no split
// would ever make edges short enough.
std::vector<float> WithFixedEdges(const TriangleMesh& mesh,
                                  const FixedVertices& fixed,
                                  std::vector<float> lengths) {
  for (const Facet& facet : mesh.facets) {
    for (int k = 0; !fixed.empty() && k < 3; ++k) {
      const uint32_t a = facet[k];
      const uint32_t b = facet[(k + 1) % 3];
      if (IsFixed(fixed, a) && IsFixed(fixed, b)) {
        const float length = (mesh.vertices[a] - mesh.vertices[b]).norm();
        lengths[a] = std::max(lengths[a], length);
        lengths[b] = std::max(lengths[b], length);
      }
    }
  }
  return lengths;
}

// [V] whether a vertex is a corner of a facet with a small angle.
std::vector<uint8_t> CornersOfThinFacets(const AnchoredMesh& mesh,
                                         float min_cosine) {
  std::vector<uint8_t> is_corner(mesh.edit.NumVertices(), 0);
  for (uint32_t facet = 0; facet < mesh.edit.NumFacets(); ++facet) {
    if (!mesh.edit.IsRemovedFacet(facet) &&
        LargestCosine(mesh.Corners(3 * facet)) > min_cosine) {
      for (const uint32_t vertex : mesh.edit.FacetAt(facet)) {
        is_corner[vertex] = 1;
      }
    }
  }
  return is_corner;
}

// \param mesh  what is left of the work
// \param vertices [V] their indices in the work
RemeshedSurface ResultOf(const AnchoredMesh& work, TriangleMesh mesh,
                         const std::vector<uint32_t>& vertices) {
  RemeshedSurface result{std::move(mesh), {}, {}, {}};
  for (const uint32_t vertex : vertices) {
    result.sources.push_back(work.anchors[vertex].source);
    if (!work.fixed.empty()) {
      result.fixed_sources.push_back(IsFixed(work.fixed, vertex) ? vertex
                                                                 : kNone);
    }
  }
  return result;
}

}  // namespace

RemeshedSurface RemeshIsotropically(const TriangleMesh& mesh,
                                    const std::vector<float>& lengths,
                                    const std::vector<float>& tolerances,
                                    const FixedVertices& fixed) {
  // An edge is split or collapsed where its halves, or the edge twice as long,
  // come closer to the wanted length [Botsch2004].
  constexpr float kMaxRatio = 4.0F / 3;
  constexpr float kMinRatio = 4.0F / 5;
  constexpr float kNeedleRatio = 2;  // edges may get so long to end a needle
  constexpr float kAllFacets = 0;    // have an angle of less than 90 degrees
  constexpr int kIterations = 5;     // as [Botsch2004] has them
  AnchoredMesh work(mesh, WithFixedEdges(mesh, fixed, lengths), tolerances,
                    fixed);
  for (int i = 0; i < kIterations; ++i) {
    SplitLongEdges(kMaxRatio, &work);
    CollapseShortEdges(kMinRatio, kMaxRatio, &work);
    FlipForValence(&work);
    RelaxVertices({}, &work);
  }
  FlipForAngles(kAllFacets, &work);
  RelaxVertices({}, &work);
  // Needles that the reference's creases and noise cause.
  CollapseNeedles(kNeedleRatio, &work);
  FlipForAngles(kAllFacets, &work);
  CollapseNeedles(kNeedleRatio, &work);

  MeshPart compact = work.edit.Compact();
  std::vector<uint32_t> vertices = SortAlongCurve(&compact.mesh);
  for (uint32_t& vertex : vertices) {
    vertex = compact.vertices[vertex];
  }
  return ResultOf(work, std::move(compact.mesh), vertices);
}

RemeshedSurface ImproveAngles(const TriangleMesh& mesh,
                              const FixedVertices& fixed) {
  constexpr float kMinCosine = 0.906F;  // 25 degrees: a choice
  constexpr float kMaxRatio = 2;        // edges may get so long
  constexpr int kIterations = 3;        // later ones find next to nothing
  std::vector<float> lengths = MeanEdgeLengths(mesh);
  const std::vector<float> tolerances = TolerancesOf(lengths);
  AnchoredMesh work(mesh, std::move(lengths), tolerances, fixed);
  for (int i = 0; i < kIterations; ++i) {
    FlipForAngles(kMinCosine, &work);
    RelaxVertices(CornersOfThinFacets(work, kMinCosine), &work);
    CollapseNeedles(kMaxRatio, &work);
  }
  FlipForAngles(kMinCosine, &work);
  MeshPart compact = work.edit.Compact();
  RemeshedSurface improved =
      ResultOf(work, std::move(compact.mesh), compact.vertices);
  improved.facet_sources = std::move(compact.facets);
  return improved;
}

void BecomeRemeshed(RemeshedSurface remeshed, Surface* surface) {
  surface->attributes =
      CarryAttributes(surface->mesh, surface->attributes, remeshed.sources);
  if (!surface->origins.empty()) {
    surface->origins =
        ValuesAt(remeshed.sources, surface->mesh, surface->origins);
  }
  surface->mesh = std::move(remeshed.mesh);
  const FixedSources before = std::exchange(surface->fixed_sources, {});
  if (before.empty()) {
    return;
  }
  for (const uint32_t vertex : remeshed.fixed_sources) {
    surface->fixed_sources.push_back(vertex != kNone ? before[vertex] : kNone);
  }
}

void RemeshEvenly(Surface* surface) {
  std::vector<float> lengths = MeanEdgeLengths(surface->mesh);
  LimitGradation(surface->mesh, kGradation, &lengths);
  BecomeRemeshed(
      RemeshIsotropically(surface->mesh, lengths, TolerancesOf(lengths)),
      surface);
}

}  // namespace colmap_ext
