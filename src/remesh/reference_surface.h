#pragma once

#include <array>
#include <vector>

#include <Eigen/Geometry>

#include "mesh/triangle_mesh.h"
#include "spatial/bvh.h"
#include "spatial/surface_point.h"

namespace colmap_ext {

// The position of a vertex of the new mesh on the old surface, and the targets
// there.
struct Anchor {
  SurfacePoint source;
  Eigen::Vector3f normal{0, 0, 0};  // of the old surface, unit
  float length = 0;                 // target length of edges, scene units
  float tolerance = 0;              // distance allowed, scene units
};

// A corner of a facet that an operation would make.
struct AnchoredCorner {
  Eigen::Vector3f position;
  const Anchor* anchor;
};

// The surface that a remeshed one has to stay close to, with the edge lengths
// that are wanted on it.
class ReferenceSurface {
 public:
  // \param mesh  outlives this.
  // \param lengths [V] wanted at each vertex, scene units
  // \param tolerances [V] distance allowed at each vertex, scene units
  ReferenceSurface(const TriangleMesh& mesh, std::vector<float> lengths,
                   std::vector<float> tolerances);

  // Of a vertex of the reference itself.
  // \param corner  3 * facet + k, a corner at the vertex
  Anchor AtCorner(uint32_t corner) const;

  // Of the nearest point whose facet faces the way `normal` does.
  // \param hint  a facet that is near.
  Anchor Nearest(const Eigen::Vector3f& position, const Eigen::Vector3f& normal,
                 uint32_t hint) const;

  Eigen::Vector3f Position(const Anchor& anchor) const {
    return ValueAt(anchor.source, mesh_, mesh_.vertices);
  }

  // Whether a facet follows the reference: its normal agrees with those at its
  // corners, or else its centre and the middles of its edges are nowhere
  // farther from a reference that faces its way than is allowed.
  bool IsFollowedBy(const std::array<AnchoredCorner, 3>& facet) const;

 private:
  struct NearPoint {
    SurfacePoint point;
    float distance;  // scene units
  };

  Anchor At(const SurfacePoint& source) const;
  // Along the normal, as long as twice the area.
  Eigen::Vector3f AreaVector(uint32_t facet) const;
  NearPoint NearestIn(uint32_t facet, const Eigen::Vector3f& position) const;
  NearPoint Descend(const Eigen::Vector3f& position,
                    const Eigen::Vector3f& normal, uint32_t facet) const;
  bool IsNearFacet(uint32_t facet, const Eigen::Vector3f& position,
                   const Eigen::Vector3f& normal, float tolerance) const;

  const TriangleMesh& mesh_;
  std::vector<float> lengths_;
  std::vector<float> tolerances_;
  std::vector<Eigen::Vector3f> normals_;  // [V]
  std::vector<uint32_t> partners_;        // [3 F] of half-edges
  Bvh bvh_;
};

}  // namespace colmap_ext
