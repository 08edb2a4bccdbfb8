#include "refine/vertex_motion.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include <tbb/parallel_for.h>

#include "mesh/facet_normals.h"

namespace colmap_ext {

namespace {

constexpr double kMaxEdgeShare = 0.4;  // of the edges' mean length
constexpr float kMinCosine = 0.5F;     // between a facet's old and new normal
constexpr int kMaxHalvings = 4;        // 1/16 of a motion is next to none

// The vertices that move and belong to a facet that turned too far: [V].
std::vector<uint8_t> VerticesOfTurnedFacets(
    const TriangleMesh& mesh, const std::vector<Eigen::Vector3f>& before,
    const std::vector<Eigen::Vector3f>& after,
    const std::vector<double>& motion) {
  std::vector<uint8_t> is_turned(mesh.vertices.size(), 0);
  for (size_t i = 0; i < mesh.facets.size(); ++i) {
    if (before[i].dot(after[i]) < kMinCosine * before[i].squaredNorm()) {
      for (const uint32_t vertex : mesh.facets[i]) {
        is_turned[vertex] = motion[vertex] != 0;
      }
    }
  }
  return is_turned;
}

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

MovedMesh MoveWithoutFlips(const TriangleMesh& mesh,
                           const std::vector<Eigen::Vector3f>& normals,
                           std::vector<double> motion) {
  const std::vector<Eigen::Vector3f> before = FacetNormals(mesh);
  MovedMesh moved{mesh, std::move(motion),
                  std::vector<uint8_t>(mesh.vertices.size(), 0)};
  for (int halving = 0;; ++halving) {
    tbb::parallel_for(size_t{0}, mesh.vertices.size(), [&](size_t i) {
      moved.mesh.vertices[i] =
          mesh.vertices[i] + static_cast<float>(moved.motion[i]) * normals[i];
    });
    const std::vector<uint8_t> is_turned = VerticesOfTurnedFacets(
        mesh, before, FacetNormals(moved.mesh), moved.motion);
    if (std::find(is_turned.begin(), is_turned.end(), 1) == is_turned.end()) {
      return moved;
    }
    for (size_t i = 0; i < is_turned.size(); ++i) {
      if (is_turned[i] != 0) {
        moved.motion[i] *= halving < kMaxHalvings ? 0.5 : 0.0;
        moved.is_shortened[i] = 1;
      }
    }
  }
}

double MeanMotion(const std::vector<double>& motion,
                  const std::vector<float>& footprints) {
  double sum = 0;
  for (size_t i = 0; i < motion.size(); ++i) {
    sum += std::abs(motion[i]) / footprints[i];
  }
  return sum / static_cast<double>(motion.size());
}

}  // namespace colmap_ext
