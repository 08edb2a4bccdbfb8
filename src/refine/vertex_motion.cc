#include "refine/vertex_motion.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include <tbb/parallel_for.h>

#include "base/indices.h"
#include "mesh/normals.h"
#include "spatial/self_intersections.h"

namespace colmap_ext {
namespace {

constexpr double kMaxEdgeShare = 0.4;  // of the edges' mean length
constexpr float kMinCosine = 0.5F;     // between a facet's old and new normal
constexpr int kMaxHalvings = 4;        // 1/16 of a motion is next to none

// A motion that is shortened until it is safe.
class SafeMotion {
 public:
  SafeMotion(const TriangleMesh& mesh, const VertexRings& rings,
             const std::vector<Eigen::Vector3f>& normals,
             std::vector<double> motion)
      : mesh_(mesh),
        rings_(rings),
        normals_(normals),
        facet_normals_(FacetNormals(mesh)),
        num_halvings_(mesh.vertices.size(), 0),
        moved_{mesh, std::move(motion),
               std::vector<uint8_t>(mesh.vertices.size(), 0)} {
    tbb::parallel_for(size_t{0}, mesh.vertices.size(),
                      [&](size_t vertex) { Place(vertex); });
  }

  MovedMesh Run(FacetTree* tree) {
    std::vector<uint32_t> facets = ShortenTurned(TurnedFacets());
    // What is turned no more may still cross; what no more crosses may turn.
    tree->Enclose(mesh_, moved_.mesh);
    facets = ShortenCrossing(FindSelfIntersections(moved_.mesh, *tree));
    while (!facets.empty()) {
      const std::vector<uint32_t> also = ShortenTurned(facets);
      facets.insert(facets.end(), also.begin(), also.end());
      SortUnique(&facets);
      facets =
          ShortenCrossing(FindSelfIntersections(moved_.mesh, *tree, facets));
    }
    return std::move(moved_);
  }

 private:
  void Place(size_t vertex) {
    moved_.mesh.vertices[vertex] =
        mesh_.vertices[vertex] +
        static_cast<float>(moved_.motion[vertex]) * normals_[vertex];
  }

  bool IsTurned(uint32_t facet) const {
    const Eigen::Vector3f& before = facet_normals_[facet];
    return before.dot(FacetNormal(moved_.mesh, facet)) <
           kMinCosine * before.squaredNorm();
  }

  std::vector<uint32_t> TurnedFacets() const {
    std::vector<uint8_t> is_turned(mesh_.facets.size());
    tbb::parallel_for(size_t{0}, is_turned.size(), [&](size_t facet) {
      is_turned[facet] = IsTurned(static_cast<uint32_t>(facet)) ? 1 : 0;
    });
    return Marked(is_turned);
  }

  // Shortens the motion of the facets' vertices.
  // \return the facets whose positions change, ascending
  std::vector<uint32_t> Shorten(const std::vector<uint32_t>& facets) {
    std::vector<uint32_t> vertices = VerticesOf(mesh_, facets);
    std::erase_if(vertices,
                  [&](uint32_t vertex) { return moved_.motion[vertex] == 0; });
    for (const uint32_t vertex : vertices) {
      moved_.motion[vertex] *= num_halvings_[vertex] < kMaxHalvings ? 0.5 : 0;
      ++num_halvings_[vertex];
      moved_.is_shortened[vertex] = 1;
      Place(vertex);
    }
    return rings_.FacetsAt(vertices);
  }

  // Until none of the given facets, and of those that change, is turned.
  // \return the facets whose positions change
  std::vector<uint32_t> ShortenTurned(std::vector<uint32_t> facets) {
    std::vector<uint32_t> all;
    while (true) {
      std::erase_if(facets, [&](uint32_t facet) { return !IsTurned(facet); });
      facets = Shorten(facets);
      if (facets.empty()) {
        return all;
      }
      all.insert(all.end(), facets.begin(), facets.end());
    }
  }

  // Once, where a pair does not intersect in the mesh before the step.
  // \return the facets whose positions change
  std::vector<uint32_t> ShortenCrossing(const std::vector<FacetPair>& pairs) {
    std::vector<uint32_t> facets;
    for (const FacetPair& pair : pairs) {
      if (!DoesPairIntersect(mesh_, pair)) {
        facets.insert(facets.end(), pair.begin(), pair.end());
      }
    }
    return Shorten(facets);
  }

  const TriangleMesh& mesh_;
  const VertexRings& rings_;
  const std::vector<Eigen::Vector3f>& normals_;
  std::vector<Eigen::Vector3f> facet_normals_;  // [F] before the step
  std::vector<uint8_t> num_halvings_;           // [V]
  MovedMesh moved_;
};

}  // namespace

void LimitMotion(const TriangleMesh& mesh, const VertexRings& rings,
                 const std::vector<float>& footprints,
                 std::vector<double>* motion) {
  const std::vector<Eigen::Vector3f>& vertices = mesh.vertices;
  tbb::parallel_for(size_t{0}, motion->size(), [&](size_t i) {
    const auto ring = rings.neighbors[i];
    double length = 0;
    for (const uint32_t neighbor : ring) {
      length += (vertices[neighbor] - vertices[i]).norm();
    }
    length *=
        kMaxEdgeShare / std::max<double>(1, static_cast<double>(ring.size()));
    const double limit = std::min<double>(length, footprints[i]);
    (*motion)[i] = std::clamp((*motion)[i], -limit, limit);
  });
}

MovedMesh MoveSafely(const TriangleMesh& mesh, const VertexRings& rings,
                     const std::vector<Eigen::Vector3f>& normals,
                     std::vector<double> motion, FacetTree* tree) {
  return SafeMotion(mesh, rings, normals, std::move(motion)).Run(tree);
}

double MeanMotion(const std::vector<double>& motion,
                  const std::vector<float>& footprints,
                  const FixedVertices& fixed) {
  double sum = 0;
  size_t num_free = 0;
  for (uint32_t i = 0; i < motion.size(); ++i) {
    if (!IsFixed(fixed, i)) {
      sum += std::abs(motion[i]) / footprints[i];
      ++num_free;
    }
  }
  return num_free > 0 ? sum / static_cast<double>(num_free) : 0;
}

}  // namespace colmap_ext
