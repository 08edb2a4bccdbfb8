#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <set>
#include <vector>

#include <Eigen/Core>

#include "mesh/fixed_vertices.h"
#include "mesh/triangle_mesh.h"
#include "mesh/vertex_rings.h"
#include "spatial/facet_tree.h"
#include "spatial/self_intersections.h"

namespace colmap_ext {

// Drops pairs of two facets that stay.
void DropFixedPairs(const TriangleMesh& mesh, const FixedVertices& fixed,
                    std::vector<FacetPair>* pairs);

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
// folded than before. Folded is an edge whose facets' normals are more than 120
// degrees apart.
class GuardedMesh {
 public:
  // \param fixed  of the mesh. Pairs of two facets that stay do not count.
  // \pre the mesh is manifold
  explicit GuardedMesh(TriangleMesh mesh, FixedVertices fixed = {});

  const TriangleMesh& mesh() const { return mesh_; }
  const FixedVertices& fixed() const { return fixed_; }
  const VertexRings& rings() const { return rings_; }

  // [3 F] as PairHalfEdges().
  const std::vector<uint32_t>& partners() const { return partners_; }

  std::vector<FacetPair> Pairs() const;

  // Those that have one of the facets.
  std::vector<FacetPair> PairsOf(const std::vector<uint32_t>& facets) const;

  size_t NumPairs() const { return num_pairs_; }

  // The facets that were looked at so far for what they intersect, and the
  // pairs found: a measure of time that is the same on every machine.
  size_t Work() const { return work_; }

  // The number of pairs that a move would leave; nothing if it is not allowed.
  std::optional<size_t> PairsAfter(const VertexTargets& targets);

  // \pre none of the vertices is fixed
  // \return whether it is allowed, and done
  bool Move(const VertexTargets& targets);

  // Lets the edge of a half-edge connect the two corners opposite of it.
  // \return whether it is allowed, and done. Then rings() and partners() no
  //         longer hold around the two facets, until Update().
  // \pre both hold around the half-edge
  bool Flip(uint32_t half);

  void Update();

 private:
  using Partners = std::map<uint32_t, std::set<uint32_t>>;

  std::vector<uint32_t> FacetsOf(const std::vector<uint32_t>& vertices) const;
  void ReplacePairs(const std::vector<FacetPair>& old_pairs,
                    const std::vector<FacetPair>& new_pairs);
  void Swap(VertexTargets* targets);

  // The pairs of the facets as they are now, if they are a real subset.
  std::optional<std::vector<FacetPair>> FewerPairs(
      const std::vector<uint32_t>& facets,
      const std::vector<FacetPair>& old_pairs);

  // Pairs of the facets that change.
  struct Change {
    std::vector<FacetPair> old_pairs, new_pairs;
  };

  // Moves the vertices, if it is allowed; the pairs are to be replaced then.
  std::optional<Change> Try(VertexTargets targets);

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
  VertexRings rings_;
  std::vector<uint32_t> partners_;
  FacetTree tree_;
  Partners crossing_;  // facets that intersect each facet
  size_t num_pairs_ = 0;
  size_t work_ = 0;
};

}  // namespace colmap_ext
