#include "tests/mesh/known_meshes.h"

#include <set>

namespace colmap_ext {

TriangleMesh MakeTetrahedron() {
  return {{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}},
          {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {2, 0, 3}}};
}

TriangleMesh MakeCube() {
  TriangleMesh cube;
  for (int corner = 0; corner < 8; ++corner) {
    cube.vertices.emplace_back(corner & 1, corner >> 1 & 1, corner >> 2);
  }
  cube.facets = {{0, 2, 3}, {0, 3, 1}, {4, 5, 7}, {4, 7, 6},
                 {0, 1, 5}, {0, 5, 4}, {2, 6, 7}, {2, 7, 3},
                 {0, 4, 6}, {0, 6, 2}, {1, 3, 7}, {1, 7, 5}};
  return cube;
}

TriangleMesh MakeSheet(uint32_t num_rows, uint32_t num_cols, bool wraps_rows,
                       bool wraps_cols) {
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

TriangleMesh MakeTorus() { return MakeSheet(5, 7, true, true); }

TriangleMesh MakeDisc() { return MakeSheet(5, 7); }

TriangleMesh MakeAnnulus() { return MakeSheet(5, 7, true, false); }

TriangleMesh MakeMoebiusStrip() {
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

TriangleMesh MakeTipToTip() {
  const TriangleMesh tip = MakeTetrahedron();
  return Union(
      tip, Moved(tip, [&](const auto& p) { return 2 * tip.vertices[0] - p; }));
}

TriangleMesh Union(const TriangleMesh& a, const TriangleMesh& b) {
  TriangleMesh both = a;
  const auto offset = static_cast<uint32_t>(a.vertices.size());
  both.vertices.insert(both.vertices.end(), b.vertices.begin(),
                       b.vertices.end());
  for (const auto& [i, j, k] : b.facets) {
    both.facets.push_back({i + offset, j + offset, k + offset});
  }
  return both;
}

void MergeVertices(uint32_t from, uint32_t to, TriangleMesh* mesh) {
  for (Facet& facet : mesh->facets) {
    for (uint32_t& vertex : facet) {
      vertex = vertex == from ? to : vertex;
      vertex -= vertex > from;
    }
  }
  mesh->vertices.erase(mesh->vertices.begin() + from);
}

Eigen::Vector3f RandomPoint(Random* random) {
  Eigen::Vector3f point;
  for (float& coordinate : point) {
    coordinate = static_cast<float>(random->Unit());
  }
  return point;
}

TriangleMesh RandomSoup(uint32_t num_vertices, uint32_t num_facets,
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
