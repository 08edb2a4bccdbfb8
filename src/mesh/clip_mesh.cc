#include "mesh/clip_mesh.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <unordered_map>
#include <utility>

#include "base/percentile.h"
#include "mesh/adjacency.h"
#include "mesh/normals.h"
#include "mesh/split_fans.h"

namespace colmap_ext {
namespace {

// Cuts a mesh along one plane; inside is where normal . x <= offset.
class PlaneCut {
 public:
  // \param normal  unit
  // \param offset, rounding  scene units
  PlaneCut(const Eigen::Vector3d& normal, double offset, double rounding,
           DerivedMesh* clipped)
      : clipped_(*clipped) {
    for (const Eigen::Vector3f& vertex : clipped_.mesh.vertices) {
      const double beyond = normal.dot(vertex.cast<double>()) - offset;
      beyond_.push_back(std::abs(beyond) <= rounding ? 0 : beyond);
    }
  }

  // \return whether anything is cut off
  bool Run() {
    if (std::ranges::all_of(beyond_, [](double d) { return d <= 0; })) {
      return false;
    }
    const std::vector<Facet> facets = std::exchange(clipped_.mesh.facets, {});
    const std::vector<uint32_t> sources =
        std::exchange(clipped_.from.facets, {});
    for (size_t i = 0; i < facets.size(); ++i) {
      Cut(facets[i], sources[i]);
    }
    return true;
  }

 private:
  // Appends what of the facet is inside: a polygon of up to four corners.
  void Cut(const Facet& facet, uint32_t source) {
    std::array<uint32_t, 4> corners{};
    size_t size = 0;
    for (int k = 0; k < 3; ++k) {
      const uint32_t from = facet[k];
      const uint32_t to = facet[(k + 1) % 3];
      if (beyond_[from] <= 0) {
        corners[size++] = from;
      }
      // An end on the plane is where the edge is cut.
      if (beyond_[from] * beyond_[to] < 0) {
        const uint32_t middle = CutEdge(from, to);
        if (middle != from && middle != to) {
          corners[size++] = middle;
        }
      }
    }
    // Not a facet of which nothing but an edge or a corner is left.
    for (size_t k = 2; k < size; ++k) {
      clipped_.mesh.facets.push_back({corners[0], corners[k - 1], corners[k]});
      clipped_.from.facets.push_back(source);
    }
  }

  // The vertex where an edge is cut; its inner end, where that is as near as
  // float coordinates tell.
  uint32_t CutEdge(uint32_t from, uint32_t to) {
    const uint32_t inner = beyond_[from] < 0 ? from : to;
    const uint32_t outer = inner == from ? to : from;
    const uint64_t key = uint64_t{inner} << 32 | outer;
    const auto [it, is_new] = cut_edges_.try_emplace(key, inner);
    if (!is_new) {
      return it->second;
    }
    std::vector<Eigen::Vector3f>& vertices = clipped_.mesh.vertices;
    const double share = beyond_[inner] / (beyond_[inner] - beyond_[outer]);
    const Eigen::Vector3d a = vertices[inner].cast<double>();
    const Eigen::Vector3d b = vertices[outer].cast<double>();
    const Eigen::Vector3f position = (a + share * (b - a)).cast<float>();
    if (position != vertices[inner]) {
      it->second = static_cast<uint32_t>(vertices.size());
      vertices.push_back(position);
      auto& sources = clipped_.from.vertices;
      sources.push_back({sources[inner][0], sources[outer][1]});
    }
    return it->second;
  }

  DerivedMesh& clipped_;
  std::vector<double> beyond_;  // [V] the plane, scene units
  std::unordered_map<uint64_t, uint32_t> cut_edges_;  // inner, outer end
};

// Whether the normals of two area vectors differ by no more than 26 degrees.
bool AreAlong(const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
  constexpr double kMinCosine = 0.9;
  return a.dot(b) >= kMinCosine * a.norm() * b.norm();
}

// A region of dropped facets without creases. Its rim are the edges that it
// shares with kept facets; its other outer edges are creases or belong to the
// mesh's border.
struct DroppedRegion {
  Eigen::Vector3d area = Eigen::Vector3d::Zero();  // sum of area vectors
  double size = 0;                                 // sum of their lengths
  double rim = 0;                                  // length
  double aligned = 0;  // length of the rim where the kept facets lie along it
  double border = 0;   // length of the other edges

  bool Continues(double min_rim) const {  // see KeepContinuations()
    constexpr double kMinAligned = 2.0 / 3;
    constexpr double kFlatness = 0.97;
    return rim > min_rim * border && aligned >= kMinAligned * rim &&
           area.norm() >= kFlatness * size;
  }
};

}  // namespace

std::optional<Provenance> ClipMesh(const Region& region, TriangleMesh* mesh) {
  float largest = 0;  // of the coordinates, by their absolute values
  for (const Eigen::Vector3f& vertex : mesh->vertices) {
    largest = std::max(largest, vertex.cwiseAbs().maxCoeff());
  }
  // How far float coordinates may put a vertex off the border, scene units.
  const double rounding = 4 * 0x1p-24 * largest;
  DerivedMesh clipped{std::move(*mesh), {}};
  clipped.from = IdentityOf(clipped.mesh);
  bool is_clipped = false;
  for (int axis = 0; axis < 3; ++axis) {
    for (const double sign : {1.0, -1.0}) {
      const Eigen::Vector3d normal = sign * region.region_from_world.row(axis);
      const double offset = normal.dot(region.center) + region.half_sizes[axis];
      is_clipped |= PlaneCut(normal, offset, rounding, &clipped).Run();
    }
  }
  if (is_clipped) {
    const auto sources = std::exchange(clipped.from.vertices, {});
    for (const uint32_t vertex : DropUnusedVertices(&clipped.mesh)) {
      clipped.from.vertices.push_back(sources[vertex]);
    }
  }
  *mesh = std::move(clipped.mesh);
  return is_clipped ? std::optional(std::move(clipped.from)) : std::nullopt;
}

std::optional<Provenance> CutOff(const Region& region, Surface* surface) {
  const std::optional<Provenance> clipped = ClipMesh(region, &surface->mesh);
  if (!clipped) {
    return std::nullopt;
  }
  DerivedMesh split = SplitFans(std::move(surface->mesh));
  split.from = Compose(*clipped, std::move(split.from));
  Provenance from = split.from;
  surface->Become(std::move(split));
  return from;
}

UnionFind JoinFacets(const std::vector<uint32_t>& partners,
                     const std::function<bool(uint32_t, uint32_t)>& joins) {
  UnionFind pieces(partners.size() / 3);
  for (uint32_t half = 0; half < partners.size(); ++half) {
    const uint32_t partner = partners[half];
    if (partner != kNone && partner < half && joins(half / 3, partner / 3)) {
      pieces.Join(half / 3, partner / 3);
    }
  }
  return pieces;
}

void KeepEnclosed(const std::vector<uint32_t>& partners,
                  const std::vector<double>& sizes, double max_size,
                  std::vector<uint8_t>* is_dropped) {
  UnionFind pieces = JoinFacets(partners, [&](uint32_t a, uint32_t b) {
    return (*is_dropped)[a] != 0 && (*is_dropped)[b] != 0;
  });
  std::vector<double> totals(is_dropped->size(), 0);
  std::vector<uint8_t> has_rim(is_dropped->size(), 0);
  for (uint32_t half = 0; half < partners.size(); ++half) {
    const uint32_t piece = pieces.Find(half / 3);
    const bool is_border = partners[half] == kNone;
    totals[piece] += is_border ? HUGE_VAL : sizes[half / 3] / 3;
    has_rim[piece] |= !is_border && (*is_dropped)[partners[half] / 3] == 0;
  }
  for (uint32_t facet = 0; facet < is_dropped->size(); ++facet) {
    const uint32_t piece = pieces.Find(facet);
    (*is_dropped)[facet] &= has_rim[piece] == 0 || !(totals[piece] <= max_size);
  }
}

void KeepContinuations(const TriangleMesh& mesh,
                       const std::vector<uint32_t>& partners, double min_rim,
                       std::vector<uint8_t>* is_dropped) {
  const std::vector<Facet>& facets = mesh.facets;
  const auto area_of = [&](uint32_t facet) -> Eigen::Vector3d {
    return AreaVector(mesh, facets[facet]).cast<double>();
  };
  const std::vector<uint32_t> dropped = Marked(*is_dropped);
  UnionFind pieces = JoinFacets(partners, [&](uint32_t a, uint32_t b) {
    return (*is_dropped)[a] != 0 && (*is_dropped)[b] != 0 &&
           AreAlong(area_of(a), area_of(b));
  });
  std::map<uint32_t, DroppedRegion> regions;  // by representatives
  for (const uint32_t facet : dropped) {
    DroppedRegion& region = regions[pieces.Find(facet)];
    region.area += area_of(facet);
    region.size += area_of(facet).norm();
  }
  for (const uint32_t facet : dropped) {
    DroppedRegion& region = regions[pieces.Find(facet)];
    for (uint32_t half = 3 * facet; half < 3 * facet + 3; ++half) {
      const double length = (mesh.vertices[ToVertex(facets, half)] -
                             mesh.vertices[FromVertex(facets, half)])
                                .norm();
      const uint32_t partner = partners[half];
      if (partner != kNone && (*is_dropped)[partner / 3] == 0) {
        region.rim += length;
        region.aligned +=
            AreAlong(region.area, area_of(partner / 3)) ? length : 0;
      } else if (partner == kNone ||
                 pieces.Find(partner / 3) != pieces.Find(facet)) {
        region.border += length;
      }
    }
  }
  for (const uint32_t facet : dropped) {
    const DroppedRegion& region = regions[pieces.Find(facet)];
    (*is_dropped)[facet] = region.Continues(min_rim) ? 0 : 1;
  }
}

size_t DropLongFacets(double factor, double percentile, TriangleMesh* mesh) {
  if (factor <= 0 || mesh->facets.empty()) {
    return 0;
  }
  std::vector<float> sides;  // [F] the longest
  for (const Facet& facet : mesh->facets) {
    const auto [a, b, c] = CornersOf(*mesh, facet);
    sides.push_back(std::max({(a - b).norm(), (b - c).norm(), (c - a).norm()}));
  }
  std::vector<float> sorted = sides;
  const double limit = factor * Percentile(percentile, &sorted);
  std::vector<uint8_t> is_dropped(sides.size());
  std::ranges::transform(sides, is_dropped.begin(),
                         [=](float side) { return !(side <= limit); });
  const std::vector<uint32_t> partners = PairHalfEdges(mesh->facets);
  KeepEnclosed(partners, std::vector<double>(sides.size()), 0, &is_dropped);
  // Ground at the end of a scene often has more border than rim.
  KeepContinuations(*mesh, partners, 0.5, &is_dropped);
  return std::erase_if(mesh->facets, [&](const Facet& facet) {
    return is_dropped[&facet - mesh->facets.data()] != 0;
  });
}

size_t DropSmallComponents(size_t min_facets, std::vector<Facet>* facets) {
  if (min_facets <= 1) {
    return 0;
  }
  UnionFind components = JoinFacets(PairHalfEdges(*facets),
                                    [](uint32_t, uint32_t) { return true; });
  std::vector<uint32_t> sizes(facets->size(), 0);
  for (uint32_t i = 0; i < facets->size(); ++i) {
    ++sizes[components.Find(i)];
  }
  size_t num_dropped = 0;
  for (uint32_t i = 0; i < sizes.size(); ++i) {
    num_dropped += components.Find(i) == i && sizes[i] < min_facets;
  }
  std::erase_if(*facets, [&](const Facet& facet) {
    const auto index = static_cast<uint32_t>(&facet - facets->data());
    return sizes[components.Find(index)] < min_facets;
  });
  return num_dropped;
}

}  // namespace colmap_ext
