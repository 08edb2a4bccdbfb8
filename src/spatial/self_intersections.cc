#include "spatial/self_intersections.h"

#include <algorithm>
#include <span>

#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>

#include "base/indices.h"
#include "base/rows.h"
#include "mesh/space_filling_curve.h"
#include "spatial/predicates.h"

namespace colmap_ext {
namespace {

// Collects pairs that intersect, from all threads.
class PairFinder {
 public:
  explicit PairFinder(const TriangleMesh& mesh) : mesh_(mesh) {}

  // Pairs of two facets of a tree.
  void AddWithin(const FacetTree& tree) {
    tbb::parallel_for(size_t{0}, tree.NumLeaves(), [&](size_t leaf) {
      tree.ForEachPair(leaf, [&](uint32_t a, uint32_t b) { Add(a, b); });
    });
  }

  // Pairs of a facet of a tree and another.
  void AddWith(const FacetTree& tree, std::span<const uint32_t> facets) {
    tbb::parallel_for(size_t{0}, facets.size(), [&](size_t i) {
      tree.ForEachNear(BoxOf(mesh_, facets[i]),
                       [&](uint32_t other) { Add(facets[i], other); });
    });
  }

  // Facets that have no area.
  void AddFlat() {
    const auto num_facets = static_cast<uint32_t>(mesh_.facets.size());
    tbb::parallel_for(uint32_t{0}, num_facets,
                      [&](uint32_t facet) { Add(facet, facet); });
  }

  // Sorted, each once.
  std::vector<FacetPair> Collect() const {
    std::vector<FacetPair> pairs;
    for (const std::vector<FacetPair>& part : found_) {
      Append(part, &pairs);
    }
    SortUnique(&pairs);
    return pairs;
  }

 private:
  void Add(uint32_t a, uint32_t b) {
    const FacetPair pair{std::min(a, b), std::max(a, b)};
    if (DoesPairIntersect(mesh_, pair)) {
      found_.local().push_back(pair);
    }
  }

  const TriangleMesh& mesh_;
  tbb::enumerable_thread_specific<std::vector<FacetPair>> found_;
};

// The facets in the order of their first vertices along a curve: those that are
// close in it lie near each other.
std::vector<uint32_t> OrderFacets(const TriangleMesh& mesh) {
  std::vector<uint32_t> places(mesh.vertices.size());
  uint32_t place = 0;
  for (const uint32_t vertex : OrderAlongCurve(mesh.vertices)) {
    places[vertex] = place++;
  }
  return NumbersInRows(
             places.size(), mesh.facets.size(),
             [&](uint32_t facet) { return places[mesh.facets[facet][0]]; })
      .values;
}

// The corners of a facet that are no corners of another one.
struct OwnCorners {
  OwnCorners(const Facet& facet, const Facet& other) {
    for (int k = 0; k < 3; ++k) {
      if (std::ranges::find(other, facet[k]) == other.end()) {
        corners[count++] = k;
      }
    }
  }

  std::array<int, 3> corners{};
  int count = 0;
};

// Whether a facet's own corners lie on one side of another's plane.
bool LieAside(const Triangle& facet, const OwnCorners& own,
              const Triangle& other) {
  int side = 0;
  for (int i = 0; i < own.count; ++i) {
    const int at =
        Orientation(other[0], other[1], other[2], facet[own.corners[i]]);
    if (at == 0 || at * side < 0) {
      return false;
    }
    side = at;
  }
  return own.count > 0;
}

bool HasArea(const Triangle& facet) {
  return !AreCollinear(facet[0], facet[1], facet[2]);
}

}  // namespace

bool DoesPairIntersect(const TriangleMesh& mesh, const FacetPair& pair) {
  const Facet& first = mesh.facets[pair[0]];
  const Facet& second = mesh.facets[pair[1]];
  const Triangle a = CornersOf(mesh, first);
  if (pair[0] == pair[1]) {
    return !HasArea(a);
  }
  const Triangle b = CornersOf(mesh, second);
  const OwnCorners own_a(first, second);
  const OwnCorners own_b(second, first);
  // Most facets end here.
  if (LieAside(a, own_a, b) || LieAside(b, own_b, a) || !HasArea(a) ||
      !HasArea(b)) {
    return false;
  }
  const auto& [i, j, k] = own_a.corners;
  const auto& [l, m, n] = own_b.corners;
  switch (own_a.count) {
    case 3:
      return TrianglesMeet(a, b);
    case 2:
      return SegmentMeetsTriangle(a[i], a[j], b) ||
             SegmentMeetsTriangle(b[l], b[m], a);
    case 1:
      return AreOnOneSide(a[(i + 1) % 3], a[(i + 2) % 3], a[i], b[l]);
    default:
      return true;
  }
}

std::vector<FacetPair> FindSelfIntersections(const TriangleMesh& mesh,
                                             size_t max_part_facets) {
  const std::vector<uint32_t> order = OrderFacets(mesh);
  std::vector<std::span<const uint32_t>> parts;
  for (size_t i = 0; i < order.size(); i += max_part_facets) {
    parts.emplace_back(&order[i], std::min(max_part_facets, order.size() - i));
  }
  std::vector<Eigen::AlignedBox3f> boxes(parts.size());
  tbb::parallel_for(size_t{0}, parts.size(), [&](size_t i) {
    for (const uint32_t facet : parts[i]) {
      boxes[i].extend(BoxOf(mesh, facet));
    }
  });
  PairFinder finder(mesh);
  finder.AddFlat();
  // Few trees at a time: those of all parts would be most of the memory.
  tbb::parallel_for(size_t{0}, parts.size(), [&](size_t i) {
    const FacetTree tree(mesh, parts[i]);
    finder.AddWithin(tree);
    for (size_t j = i + 1; j < parts.size(); ++j) {
      if (boxes[i].intersects(boxes[j])) {
        finder.AddWith(tree, parts[j]);
      }
    }
  });
  return finder.Collect();
}

std::vector<FacetPair> FindSelfIntersections(const TriangleMesh& mesh,
                                             const FacetTree& tree) {
  PairFinder finder(mesh);
  finder.AddFlat();
  finder.AddWithin(tree);
  return finder.Collect();
}

std::vector<FacetPair> FindSelfIntersections(
    const TriangleMesh& mesh, const FacetTree& tree,
    const std::vector<uint32_t>& facets) {
  PairFinder finder(mesh);
  finder.AddWith(tree, facets);
  return finder.Collect();
}

size_t PutBackIntersecting(const std::vector<Eigen::Vector3f>& positions,
                           TriangleMesh* mesh) {
  size_t num_moved = 0;
  for (const FacetPair& pair : FindSelfIntersections(*mesh)) {
    for (const uint32_t facet : pair) {
      for (const uint32_t vertex : mesh->facets[facet]) {
        num_moved += mesh->vertices[vertex] != positions[vertex] ? 1 : 0;
        mesh->vertices[vertex] = positions[vertex];
      }
    }
  }
  return num_moved;
}

}  // namespace colmap_ext
