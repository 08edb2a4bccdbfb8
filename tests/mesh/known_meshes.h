#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <set>
#include <utility>

#include <Eigen/Geometry>

#include "mesh/split_fans.h"
#include "mesh/triangle_mesh.h"
#include "tests/random.h"
#include "tests/synthetic/isosurface.h"
#include "tests/synthetic/noise.h"

// Meshes whose topology is known, and ways to make others of them.
namespace colmap_ext {

inline TriangleMesh MakeTetrahedron() {
  return {{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}},
          {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {2, 0, 3}}};
}

inline TriangleMesh MakeCube() {
  TriangleMesh cube;
  for (int corner = 0; corner < 8; ++corner) {
    cube.vertices.emplace_back(corner & 1, corner >> 1 & 1, corner >> 2);
  }
  cube.facets = {{0, 2, 3}, {0, 3, 1}, {4, 5, 7}, {4, 7, 6},
                 {0, 1, 5}, {0, 5, 4}, {2, 6, 7}, {2, 7, 3},
                 {0, 4, 6}, {0, 6, 2}, {1, 3, 7}, {1, 7, 5}};
  return cube;
}

// A sheet of quads, each of them two facets, of num_rows x num_cols quads,
// closed to a ring along the columns or the rows where it wraps.
// \pre at least 3 quads where it wraps
inline TriangleMesh MakeSheet(uint32_t num_rows, uint32_t num_cols,
                              bool wraps_rows = false,
                              bool wraps_cols = false) {
  const uint32_t num_vertex_rows = num_rows + !wraps_rows;
  const uint32_t num_vertex_cols = num_cols + !wraps_cols;
  TriangleMesh mesh;
  for (uint32_t row = 0; row < num_vertex_rows; ++row) {
    for (uint32_t col = 0; col < num_vertex_cols; ++col) {
      mesh.vertices.emplace_back(static_cast<float>(col),
                                 static_cast<float>(row), 0.0f);
    }
  }
  const auto vertex = [&](uint32_t row, uint32_t col) {
    return row % num_vertex_rows * num_vertex_cols + col % num_vertex_cols;
  };
  for (uint32_t row = 0; row < num_rows; ++row) {
    for (uint32_t col = 0; col < num_cols; ++col) {
      const uint32_t a = vertex(row, col);
      const uint32_t b = vertex(row, col + 1);
      const uint32_t c = vertex(row + 1, col + 1);
      const uint32_t d = vertex(row + 1, col);
      mesh.facets.push_back({a, b, c});
      mesh.facets.push_back({a, c, d});
    }
  }
  return mesh;
}

inline TriangleMesh MakeTorus() { return MakeSheet(5, 7, true, true); }
inline TriangleMesh MakeDisc() { return MakeSheet(5, 7); }
inline TriangleMesh MakeAnnulus() { return MakeSheet(5, 7, true, false); }

// One-sided: some edge is run twice in one direction, however it is oriented.
inline TriangleMesh MakeMoebiusStrip() {
  // An annulus of one quad across, whose last quad is glued on upside down.
  constexpr uint32_t kNumQuads = 7;
  TriangleMesh mesh = MakeSheet(kNumQuads, 1);
  for (Facet& facet : mesh.facets) {
    for (uint32_t& vertex : facet) {
      if (vertex >= 2 * kNumQuads) {
        vertex = 1 - vertex % 2;
      }
    }
  }
  mesh.vertices.resize(2 * kNumQuads);
  return mesh;
}

// The mesh with each vertex where function(position) says.
template <typename Function>
TriangleMesh Moved(TriangleMesh mesh, const Function& function) {
  for (Eigen::Vector3f& vertex : mesh.vertices) {
    vertex = function(vertex);
  }
  return mesh;
}

inline TriangleMesh Shifted(const TriangleMesh& mesh,
                            const Eigen::Vector3f& shift) {
  return Moved(mesh, [&](const auto& point) { return point + shift; });
}

inline TriangleMesh Scaled(const TriangleMesh& mesh, float factor) {
  return Moved(mesh, [&](const auto& point) { return factor * point; });
}

// A sheet of quads of sides of 1 whose vertices lie at height(x, y).
template <typename Height>
TriangleMesh MakeHeightField(uint32_t num_quads, const Height& height) {
  return Moved(MakeSheet(num_quads, num_quads), [&](const auto& p) {
    return Eigen::Vector3f(p.x(), p.y(), height(p.x(), p.y()));
  });
}

inline Eigen::Vector3f CentroidOf(const TriangleMesh& mesh,
                                  const Facet& facet) {
  const auto [a, b, c] = CornersOf(mesh, facet);
  return (a + b + c) / 3;
}

// Both meshes side by side.
inline TriangleMesh Union(const TriangleMesh& a, const TriangleMesh& b) {
  TriangleMesh both = a;
  const auto offset = static_cast<uint32_t>(a.vertices.size());
  Append(b.vertices, &both.vertices);
  for (const auto& [i, j, k] : b.facets) {
    both.facets.push_back({i + offset, j + offset, k + offset});
  }
  return both;
}

// The facets by their corners' positions, each turned so that the lowest comes
// first: the same in any order of vertices and facets.
inline std::multiset<std::array<std::array<float, 3>, 3>> TrianglesOf(
    const TriangleMesh& mesh) {
  std::multiset<std::array<std::array<float, 3>, 3>> triangles;
  for (const Facet& facet : mesh.facets) {
    std::array<std::array<float, 3>, 3> triangle;
    for (int k = 0; k < 3; ++k) {
      const Eigen::Vector3f& p = mesh.vertices[facet[k]];
      triangle[k] = {p.x(), p.y(), p.z()};
    }
    std::rotate(triangle.begin(), std::ranges::min_element(triangle),
                triangle.end());
    triangles.insert(triangle);
  }
  return triangles;
}

// Facets apart from each other, with corners at corner(facet, 0 ... 2).
template <typename Corner>
TriangleMesh MakeTriangles(size_t num_facets, const Corner& corner) {
  TriangleMesh mesh;
  for (uint32_t i = 0; i < num_facets; ++i) {
    for (int k = 0; k < 3; ++k) {
      mesh.vertices.push_back(corner(i, k));
    }
    mesh.facets.push_back({3 * i, 3 * i + 1, 3 * i + 2});
  }
  return mesh;
}

// Two tetrahedra that touch with their first vertices.
inline TriangleMesh MakeTipToTip() {
  const TriangleMesh tip = MakeTetrahedron();
  TriangleMesh other =
      Moved(tip, [&](const auto& p) { return 2 * tip.vertices[0] - p; });
  for (Facet& facet : other.facets) {
    std::swap(facet[1], facet[2]);  // the reflection turns it inside out
  }
  return Union(tip, other);
}

// Lets all facets use vertex `to` instead of `from`, which is then unreferenced
// and removed.
inline void MergeVertices(uint32_t from, uint32_t to, TriangleMesh* mesh) {
  for (Facet& facet : mesh->facets) {
    for (uint32_t& vertex : facet) {
      vertex = vertex == from ? to : vertex;
      vertex -= vertex > from;
    }
  }
  mesh->vertices.erase(mesh->vertices.begin() + from);
}

// Uniform in the unit cube.
inline Eigen::Vector3f RandomPoint(Random* random) {
  Eigen::Vector3f point;
  for (float& coordinate : point) {
    coordinate = static_cast<float>(random->Unit());
  }
  return point;
}

// Facets between random ones of few vertices, at random positions: edges and
// vertices of all kinds. No facet repeats a vertex.
// \param allow_duplicates of facets
inline TriangleMesh RandomSoup(uint32_t num_vertices, uint32_t num_facets,
                               bool allow_duplicates, Random* random) {
  TriangleMesh mesh;
  for (uint32_t i = 0; i < num_vertices; ++i) {
    mesh.vertices.emplace_back(random->Unit(), random->Unit(), random->Unit());
  }
  std::set<std::set<uint32_t>> triples;
  for (uint32_t i = 0; i < num_facets; ++i) {
    const Facet facet = {random->Below(num_vertices),
                         random->Below(num_vertices),
                         random->Below(num_vertices)};
    const std::set<uint32_t> triple(facet.begin(), facet.end());
    if (triple.size() == 3 &&
        (triples.insert(triple).second || allow_duplicates)) {
      mesh.facets.push_back(facet);
    }
  }
  return mesh;
}

// Meshes with a shape, of irregular facets whose sides are a cell long or less.

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
