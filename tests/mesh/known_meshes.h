#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <set>

#include "mesh/triangle_mesh.h"
#include "tests/random.h"

// Meshes whose topology is known.
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

// Both meshes side by side.
inline TriangleMesh Union(const TriangleMesh& a, const TriangleMesh& b) {
  TriangleMesh both = a;
  const auto offset = static_cast<uint32_t>(a.vertices.size());
  both.vertices.insert(both.vertices.end(), b.vertices.begin(),
                       b.vertices.end());
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
    std::ranges::rotate(triangle, std::ranges::min_element(triangle));
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
  return Union(
      tip, Moved(tip, [&](const auto& p) { return 2 * tip.vertices[0] - p; }));
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

}  // namespace colmap_ext
