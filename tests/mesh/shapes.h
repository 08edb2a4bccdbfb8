#pragma once

#include <cmath>
#include <cstdint>

#include <Eigen/Geometry>

#include "mesh/adjacency.h"
#include "mesh/split_fans.h"
#include "mesh/triangle_mesh.h"
#include "tests/mesh/known_meshes.h"
#include "tests/synthetic/isosurface.h"
#include "tests/synthetic/noise.h"

// Meshes with a shape, of irregular facets whose sides are a cell long or less.
namespace colmap_ext {

inline synthetic::Solid BumpySphere(float height) {
  synthetic::Solid solid;
  solid.box.extend(Eigen::Vector3f::Constant(-1.3f));
  solid.box.extend(Eigen::Vector3f::Constant(1.3f));
  solid.shape = [](const Eigen::Vector3f& point) { return point.norm() - 1; };
  solid.detail = [height](const Eigen::Vector3f& point) {
    return height * synthetic::ValueNoise(4 * point, 5);
  };
  solid.max_detail = height;
  return solid;
}

// A unit sphere around the origin with bumps of the given height.
inline TriangleMesh MakeBumpySphere(float cell_size, float height = 0.1f) {
  return synthetic::MeshSolid(BumpySphere(height), cell_size);
}

// What of it lies above z = -0.3: one border loop.
inline TriangleMesh MakeBumpyCap(float cell_size, float height = 0.1f) {
  synthetic::Solid solid = BumpySphere(height);
  solid.box.min().z() = -0.3f;
  return synthetic::MeshSolid(solid, cell_size);
}

// A torus around the z axis with radii of 0.7 and 0.3.
inline TriangleMesh MakeRoundTorus(float cell_size) {
  synthetic::Solid solid = BumpySphere(0);
  solid.shape = [](const Eigen::Vector3f& point) {
    return std::hypot(point.head<2>().norm() - 0.7f, point.z()) - 0.3f;
  };
  return synthetic::MeshSolid(solid, cell_size);
}

// A cube of sides of 2 around the origin.
inline TriangleMesh MakeFineCube(float cell_size) {
  synthetic::Solid solid = BumpySphere(0);
  solid.shape = [](const Eigen::Vector3f& point) {
    return point.cwiseAbs().maxCoeff() - 1;
  };
  return synthetic::MeshSolid(solid, cell_size);
}

// A square sheet of sides of 1 in the plane z = 0, its inner vertices moved
// within the plane by up to a third of their distance.
inline TriangleMesh MakeJitteredSquare(uint32_t num_quads, Random* random) {
  TriangleMesh mesh = MakeSheet(num_quads, num_quads);
  const auto size = static_cast<float>(num_quads);
  for (Eigen::Vector3f& vertex : mesh.vertices) {
    if (vertex.head<2>().minCoeff() > 0 && vertex.head<2>().maxCoeff() < size) {
      vertex.x() += static_cast<float>((random->Unit() - 0.5) * 2 / 3);
      vertex.y() += static_cast<float>((random->Unit() - 0.5) * 2 / 3);
    }
    vertex /= size;
  }
  return mesh;
}

// A manifold mesh of any topology, with positions at random.
inline TriangleMesh MakeRandomManifold(Random* random) {
  const uint32_t num_vertices = 4 + random->Below(12);
  const TriangleMesh soup = RandomSoup(
      num_vertices, 1 + random->Below(3 * num_vertices), false, random);
  return SplitFans(soup).mesh;
}

// What the facets enclose, positive where they are seen counter-clockwise from
// outside.
inline double Volume(const TriangleMesh& mesh) {
  double volume = 0;
  for (const Facet& facet : mesh.facets) {
    const auto [a, b, c] = CornersOf<double>(mesh, facet);
    volume += a.cross(b).dot(c) / 6;
  }
  return volume;
}

// Returns the area of all facets.
inline double Area(const TriangleMesh& mesh) {
  double area = 0;
  for (const Facet& facet : mesh.facets) {
    const auto [a, b, c] = CornersOf<double>(mesh, facet);
    area += 0.5 * (b - a).cross(c - a).norm();
  }
  return area;
}

}  // namespace colmap_ext
