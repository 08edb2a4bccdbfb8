#pragma once

#include <cstdint>
#include <vector>

#include <Eigen/Core>

#include "mesh/triangle_mesh.h"

namespace colmap_ext {

// Four values side by side, one for each ray of a packet (GCC and Clang).
using Float4 = float __attribute__((vector_size(16)));
using Int4 = int32_t __attribute__((vector_size(16)));

// Four rays from one origin. Distances are in lengths of the directions.
struct RayPacket {
  Eigen::Vector3f origin = Eigen::Vector3f::Zero();
  Float4 x{}, y{}, z{};  // directions, any length but zero
  float min_distance = 0;
  float max_distance = 1e30f;

  void SetDirection(int ray, const Eigen::Vector3f& direction) {
    x[ray] = direction.x();
    y[ray] = direction.y();
    z[ray] = direction.z();
  }
};

struct HitPacket {
  Float4 distance;  // of the nearest hit, else the packet's max_distance
  Int4 facet;       // -1: no hit
};

// A bounding volume hierarchy over the facets of a mesh, split by the surface
// area heuristic in bins (Wald 2007), traversed by packets of four rays, which
// meet the facets by the test of Moeller and Trumbore (1997).
class Bvh {
 public:
  // Facets may be degenerate: one that repeats a vertex three times is a point.
  // \pre facet indices < mesh.vertices.size(), their vertices are finite
  explicit Bvh(const TriangleMesh& mesh);

  HitPacket Intersect(const RayPacket& rays) const;

  // Distance from a point to the nearest facet, scene units: exact but for the
  // rounding of the facets' edges to floats.
  // \return max_distance if there is none nearer.
  double Distance(const Eigen::Vector3f& point, double max_distance) const;

 private:
  static constexpr int kMaxDepth = 64;  // of the tree

  struct Node {
    Eigen::Vector3f min, max;  // of the facets' bounding box
    uint32_t next;             // leaf: its first facet; else the far child
    uint16_t num_facets;       // leaf: > 0; else 0, the near child follows
    uint16_t axis;             // inner node: the split's
  };
  struct Corner {
    Eigen::Vector3f point, edge1, edge2;
  };
  struct Builder;

  static double DistanceSquared(const Corner& corner,
                                const Eigen::Vector3d& point);
  static double DistanceSquared(const Node& node, const Eigen::Vector3d& point);

  std::vector<Node> nodes_;
  std::vector<Corner> corners_;   // [F], in the order of the leaves
  std::vector<uint32_t> facets_;  // [F], in the order of the leaves
};

}  // namespace colmap_ext
