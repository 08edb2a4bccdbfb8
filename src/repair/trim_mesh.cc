#include "repair/borders.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include <Eigen/Core>

#include "base/indices.h"
#include "base/union_find.h"
#include "mesh/adjacency.h"
#include "mesh/clip_mesh.h"
#include "mesh/confidences.h"
#include "mesh/normals.h"
#include "mesh/split_fans.h"

namespace colmap_ext {
namespace {

// A mesh with what finds its facets' neighbors.
struct LinkedMesh {
  const TriangleMesh& mesh;
  const std::vector<float>& gap_widths;  // [V]
  VertexRings rings;
  std::vector<uint32_t> partners;  // [3 F]
};

// The distances of vertices to the nearest source along edges: [V], each edge
// in mean gap widths of its ends, infinity beyond `reach`.
// \param is_source [V]
std::vector<float> Distances(const LinkedMesh& surface,
                             const std::vector<uint8_t>& is_source,
                             float reach) {
  std::vector<float> distances;
  for (const uint8_t source : is_source) {
    distances.push_back(source != 0 ? 0 : HUGE_VALF);
  }
  const std::vector<Eigen::Vector3f>& vertices = surface.mesh.vertices;
  const auto cost = [&](uint32_t from, uint32_t to) {
    const float width = (surface.gap_widths[from] + surface.gap_widths[to]) / 2;
    return (vertices[to] - vertices[from]).norm() / width;
  };
  LowerAlongEdges(surface.rings, reach, cost, &distances);
  return distances;
}

// How many corners of a facet are within the reach of Distances().
int NumReached(const std::vector<float>& distances, const Facet& facet) {
  return static_cast<int>(std::ranges::count_if(facet, [&](uint32_t vertex) {
    return std::isfinite(distances[vertex]);
  }));
}

// [V] 1: a corner of one of the facets that have the mark
std::vector<uint8_t> MarkCorners(const TriangleMesh& mesh,
                                 const std::vector<uint8_t>& marks,
                                 uint8_t mark = 1) {
  std::vector<uint8_t> is_corner(mesh.vertices.size(), 0);
  for (size_t i = 0; i < marks.size(); ++i) {
    if (marks[i] == mark) {
      for (const uint32_t vertex : mesh.facets[i]) {
        is_corner[vertex] = 1;
      }
    }
  }
  return is_corner;
}

// Which of the low facets are not in the closing of the others: [F]. Those
// within `grown` gap widths of the others are added, those within `shrunk` of
// what is still left out are taken away.
std::vector<uint8_t> FindOpen(const LinkedMesh& surface,
                              const std::vector<uint8_t>& is_low, float grown,
                              float shrunk) {
  const std::vector<Facet>& facets = surface.mesh.facets;
  std::vector<float> distances =
      Distances(surface, MarkCorners(surface.mesh, is_low, /*mark=*/0), grown);
  std::vector<uint8_t> is_open(is_low.size());
  for (size_t i = 0; i < is_low.size(); ++i) {
    is_open[i] = is_low[i] != 0 && NumReached(distances, facets[i]) < 3;
  }
  std::vector<uint8_t> is_source = MarkCorners(surface.mesh, is_open);
  // Beyond a border nothing is known to be surface.
  for (uint32_t half = 0; half < surface.partners.size(); ++half) {
    if (surface.partners[half] == kNone && is_low[half / 3] != 0) {
      is_source[FromVertex(facets, half)] = 1;
      is_source[ToVertex(facets, half)] = 1;
    }
  }
  distances = Distances(surface, is_source, shrunk);
  for (size_t i = 0; i < is_low.size(); ++i) {
    is_open[i] = is_low[i] != 0 && NumReached(distances, facets[i]) > 0;
  }
  return is_open;
}

// The areas of facets: [F] squares of the gap width.
std::vector<double> SizesOf(const LinkedMesh& surface) {
  const std::vector<Facet>& facets = surface.mesh.facets;
  const std::vector<float> widths = MeanOfCorners(facets, surface.gap_widths);
  std::vector<double> sizes;
  for (size_t i = 0; i < facets.size(); ++i) {
    const Eigen::Vector3f area = AreaVector(surface.mesh, facets[i]) / 2;
    sizes.push_back((area / widths[i] / widths[i]).norm());
  }
  return sizes;
}

// Of what is left, drops pieces smaller than a disk, too. The less confident a
// piece is, the larger it has to be: facets count with the squares of their
// weights, so that fragments of foliage go.
void AddLeftovers(const LinkedMesh& surface, const std::vector<double>& sizes,
                  const std::vector<float>& weights,
                  std::vector<uint8_t>* is_dropped) {
  UnionFind pieces = JoinFacets(surface.partners, [&](uint32_t a, uint32_t b) {
    return (*is_dropped)[a] == (*is_dropped)[b];
  });
  std::vector<double> totals(sizes.size(), 0);
  double largest = 0;
  for (uint32_t i = 0; i < sizes.size(); ++i) {
    double& total = totals[pieces.Find(i)];
    total += (*is_dropped)[i] != 0 ? 0 : sizes[i] * weights[i] * weights[i];
    largest = std::max(largest, total);
  }
  const double min_size = std::min(std::numbers::pi, largest);
  for (uint32_t i = 0; i < sizes.size(); ++i) {
    (*is_dropped)[i] |= totals[pieces.Find(i)] < min_size ? 1 : 0;
  }
}

// Drops the facets and smooths the borders that this opens.
void Drop(const LinkedMesh& surface, const std::vector<uint8_t>& is_dropped,
          TrimmedMesh* trimmed) {
  TriangleMesh kept{surface.mesh.vertices, {}};
  std::vector<uint32_t> sources;   // [F]
  std::vector<uint8_t> is_opened;  // [3 F]
  for (uint32_t i = 0; i < is_dropped.size(); ++i) {
    if (is_dropped[i] != 0) {
      continue;
    }
    kept.facets.push_back(surface.mesh.facets[i]);
    sources.push_back(i);
    for (uint32_t half = 3 * i; half < 3 * i + 3; ++half) {
      const uint32_t partner = surface.partners[half];
      is_opened.push_back(partner != kNone && is_dropped[partner / 3] != 0);
    }
  }
  // A manifold mesh gets no midpoints: facets, half-edges keep their indices.
  FanSplit split = SplitFans(std::move(kept));
  SmoothBorders(is_opened, &split.mesh);
  trimmed->mesh = std::move(split.mesh);
  trimmed->from.facets = std::move(sources);
  trimmed->from = Compose(trimmed->from, std::move(split.from));
}

}  // namespace

TrimmedMesh TrimMesh(double min_confidence, TriangleMesh mesh,
                     const std::vector<float>& facet_confidences,
                     const std::vector<float>& gap_widths,
                     const std::vector<float>& front_shares) {
  Provenance from = IdentityOf(mesh);
  TrimmedMesh trimmed{{std::move(mesh), std::move(from)}, {}};
  if (!(min_confidence > 0)) {
    return trimmed;
  }
  const LinkedMesh surface{trimmed.mesh, gap_widths,
                           MakeVertexRings(trimmed.mesh),
                           PairHalfEdges(trimmed.mesh.facets)};
  std::vector<uint8_t> is_low(facet_confidences.size());
  std::ranges::transform(facet_confidences, is_low.begin(),
                         [=](float value) { return value < min_confidence; });
  // Choices. First notches are filled. After that a plain closing would keep
  // webs in corners, such as between a roof and a chimney; a right angle's web
  // is .41 gap widths wide.
  constexpr float kNotch = .25F;
  constexpr float kShrunk = 1.5F;
  constexpr double kHollow = 50;  // a disk of four gap widths
  std::vector<uint8_t> is_dropped =
      FindOpen(surface, FindOpen(surface, is_low, kNotch, kNotch), 1, kShrunk);
  const std::vector<double> sizes = SizesOf(surface);
  KeepEnclosed(surface.partners, sizes, kHollow, &is_dropped);
  KeepContinuations(surface.mesh, surface.partners, 1, &is_dropped);
  // The closing of what is dropped removes shreds of membranes.
  constexpr float kShred = 0.5F;
  const auto is_none = [](uint8_t mark) { return mark == 0 ? 1 : 0; };
  std::ranges::transform(is_dropped, is_dropped.begin(), is_none);
  is_dropped = FindOpen(surface, is_dropped, kShred, kShrunk * kShred);
  std::ranges::transform(is_dropped, is_dropped.begin(), is_none);
  std::vector<float> weights = facet_confidences;
  for (size_t i = 0; i < front_shares.size(); ++i) {
    weights[i] *= front_shares[i];
  }
  AddLeftovers(surface, sizes, weights, &is_dropped);
  TrimReport& report = trimmed.report;
  for (size_t i = 0; i < is_low.size(); ++i) {
    report.num_facets += is_dropped[i];
    report.num_leftover_facets += is_dropped[i] != 0 && is_low[i] == 0;
    report.num_kept_facets += is_dropped[i] == 0 && is_low[i] != 0;
  }
  if (report.num_facets > 0) {
    Drop(surface, is_dropped, &trimmed);
  }
  return trimmed;
}

}  // namespace colmap_ext
