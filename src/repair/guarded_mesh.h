#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <set>
#include <vector>

#include <Eigen/Core>

#include "mesh/adjacency.h"
#include "mesh/surface.h"
#include "mesh/triangle_mesh.h"
#include "spatial/facet_tree.h"
#include "spatial/self_intersections.h"

namespace colmap_ext {

// Drops pairs of two fixed facets.
void DropFixedPairs(const TriangleMesh& mesh, const FixedVertices& fixed,
                    std::vector<FacetPair>* pairs);

// Whether the edge of two facets is folded: their normals are more than 120
// degrees apart.
bool IsFoldedEdge(const TriangleMesh& mesh, uint32_t a, uint32_t b);

// Returns some facets and their neighbors across folded edges, each pair once.
// \param partners  as of PairHalfEdges()
std::vector<FacetPair> FoldsOf(const TriangleMesh& mesh,
                               const std::vector<uint32_t>& partners,
                               const std::vector<uint32_t>& facets);

// Where some vertices are to go.
struct VertexTargets {
  std::vector<uint32_t> vertices;          // each once
  std::vector<Eigen::Vector3f> positions;  // of each of them, scene units
};

// A manifold mesh with its self-intersections, which changes only where they
// become fewer: a change is made if the pairs of facets that intersect
// afterwards are a real subset of those before, and if it turns no facet over.
// A facet turns over if its normal turns by more than a right angle, unless it
// was folded onto a neighbor and is not so any more; and no more edges may be
// folded than before.
class GuardedMesh {
 public:
  // \param fixed  of the mesh. Pairs of two fixed facets do not count.
  // \param has_folds  whether facets at a folded edge are a pair, too
  // \pre the mesh is manifold
  explicit GuardedMesh(TriangleMesh mesh, FixedVertices fixed = {},
                       bool has_folds = false);

  const TriangleMesh& mesh() const { return mesh_; }
  const FixedVertices& fixed() const { return fixed_; }
  const VertexRings& rings() const { return rings_; }

  std::vector<FacetPair> Pairs() const;

  // Those that have one of the facets.
  std::vector<FacetPair> PairsOf(const std::vector<uint32_t>& facets) const;

  // The facets of the pairs in groups, ascending in each, by their lowest
  // facets: facets belong together if they intersect or share a vertex.
  std::map<uint32_t, std::vector<uint32_t>> Clusters() const;

  size_t NumPairs() const { return crossing_.size() / 2; }

  // The facets that were looked at so far for what they intersect, and the
  // pairs found: a measure of time that is the same on every machine.
  size_t Work() const { return work_; }

  // \pre none of the vertices is fixed
  // \return whether it is allowed, and done
  bool Move(VertexTargets targets);

 private:
  // Adds the pairs at folded edges of the facets, if has_folds_, and drops
  // pairs of two fixed facets.
  void FinishPairs(const std::vector<uint32_t>& facets,
                   std::vector<FacetPair>* pairs) const;

  void ReplacePairs(const std::vector<FacetPair>& old_pairs,
                    const std::vector<FacetPair>& new_pairs);
  void Swap(VertexTargets* targets);

  // The pairs of the facets as they are now, if they are a real subset.
  std::optional<std::vector<FacetPair>> FewerPairs(
      const std::vector<uint32_t>& facets,
      const std::vector<FacetPair>& old_pairs);

  // Of the facets and their neighbors, at the present positions.
  struct Shape {
    std::vector<Eigen::Vector3f> normals;  // of the facets
    std::vector<uint8_t> is_folded;        // [facets]
    size_t num_folded_edges = 0;
  };
  Shape ShapeOf(const std::vector<uint32_t>& facets) const;
  static bool TurnsOver(const Shape& before, const Shape& after);

  TriangleMesh mesh_;
  FixedVertices fixed_;
  bool has_folds_;
  VertexRings rings_;
  std::vector<uint32_t> partners_;
  FacetTree tree_;
  std::set<FacetPair> crossing_;  // pairs that intersect, either way round
  size_t work_ = 0;
};

// Returns where some vertices go by rounds of umbrella smoothing: in each, all
// go half of the way to the mean of their neighbors, of which those that are
// not among the vertices do not move. A vertex at a border goes to the mean of
// its neighbors along the border; one with other than two such neighbors does
// not move.
// \param vertices  ascending
// \pre indices are in range
VertexTargets Smoothed(const GuardedMesh& mesh,
                       const std::vector<uint32_t>& vertices, int num_rounds);

// Returns where some vertices go along the mean of their facets' normals, by a
// share of the mean length of their edges: all of them outwards or, where the
// share is negative, inwards.
// \param vertices  ascending
// \pre indices are in range
VertexTargets Pushed(const GuardedMesh& mesh,
                     const std::vector<uint32_t>& vertices, double share);

}  // namespace colmap_ext
