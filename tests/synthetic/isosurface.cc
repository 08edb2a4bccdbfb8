#include "tests/synthetic/isosurface.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

#include <tbb/parallel_for.h>

#include "base/indices.h"
#include "mesh/adjacency.h"
#include "mesh/normals.h"

namespace colmap_ext::synthetic {
namespace {

constexpr int kBlock = 8;             // nodes a side
constexpr float kMaxGradient = 1.5f;  // of the shape
constexpr int kNumSpreadings = 6;

// Node and direction of a lattice edge: the edge runs from the node to the one
// that is a step away in each axis whose bit is set.
using EdgeKey = uint64_t;
EdgeKey MakeKey(uint64_t node, uint64_t bits) { return node * 8 + bits; }

// The solid's function at the nodes of a lattice.
struct Lattice {
  Eigen::Vector3f origin;
  float cell_size;
  std::array<uint64_t, 3> size;  // nodes in x, y, z; x runs fastest
  std::vector<float> values;

  uint64_t Node(uint64_t x, uint64_t y, uint64_t z) const {
    return (z * size[1] + y) * size[0] + x;
  }
  Eigen::Vector3f Position(uint64_t x, uint64_t y, uint64_t z) const {
    return origin + cell_size * Eigen::Vector3f(x, y, z);
  }
  Eigen::Vector3f Position(uint64_t node) const {
    return Position(node % size[0], node / size[0] % size[1],
                    node / size[0] / size[1]);
  }
  uint64_t Step(uint64_t bits) const {
    return (bits & 1) + ((bits >> 1) & 1) * size[0] +
           (bits >> 2) * size[0] * size[1];
  }
};

// Fills a block of nodes. Far from the surface only the signs are needed, which
// the expensive detail cannot change.
void FillBlock(const Solid& solid, const std::array<uint64_t, 3>& first,
               Lattice* lattice) {
  std::array<uint64_t, 3> last;
  for (int i = 0; i < 3; ++i) {
    last[i] = std::min(first[i] + kBlock, lattice->size[i]);
  }
  const Eigen::Vector3f corner =
      lattice->Position(first[0], first[1], first[2]);
  const float half = 0.5f * kBlock * lattice->cell_size;
  const float center = solid.shape(corner + Eigen::Vector3f::Constant(half));
  const float reach =
      kMaxGradient * (half * std::sqrt(3.0f)) + solid.max_detail;
  for (uint64_t z = first[2]; z < last[2]; ++z) {
    for (uint64_t y = first[1]; y < last[1]; ++y) {
      for (uint64_t x = first[0]; x < last[0]; ++x) {
        float value = center;
        if (std::abs(center) <= reach) {
          const Eigen::Vector3f point = lattice->Position(x, y, z);
          value = solid.shape(point);
          if (std::abs(value) <= solid.max_detail) {
            value += solid.detail(point);
          }
        }
        lattice->values[lattice->Node(x, y, z)] = value;
      }
    }
  }
}

Lattice Sample(const Solid& solid, float cell_size) {
  Lattice lattice;
  lattice.origin = solid.box.min();
  lattice.cell_size = cell_size;
  std::array<uint64_t, 3> blocks;
  for (int i = 0; i < 3; ++i) {
    lattice.size[i] = 2 + std::floor(solid.box.sizes()[i] / cell_size);
    blocks[i] = (lattice.size[i] + kBlock - 1) / kBlock;
  }
  lattice.values.resize(lattice.size[0] * lattice.size[1] * lattice.size[2]);
  tbb::parallel_for(
      size_t{0}, blocks[0] * blocks[1] * blocks[2], [&](size_t b) {
        FillBlock(solid,
                  {b % blocks[0] * kBlock, b / blocks[0] % blocks[1] * kBlock,
                   b / blocks[0] / blocks[1] * kBlock},
                  &lattice);
      });
  return lattice;
}

using EdgeTriangle = std::array<EdgeKey, 3>;

// The surface in one tetrahedron of lattice nodes, given with positive
// orientation. Corners are bits (x, y, z) of the cube at `node`.
void MarchTetrahedron(const Lattice& lattice, uint64_t node,
                      const std::array<uint64_t, 4>& corners,
                      std::vector<EdgeTriangle>* triangles) {
  std::array<int, 4> in, out;
  int num_in = 0, num_out = 0;
  for (int i = 0; i < 4; ++i) {
    if (lattice.values[node + lattice.Step(corners[i])] < 0) {
      in[num_in++] = i;
    } else {
      out[num_out++] = i;
    }
  }
  if (num_in == 0 || num_out == 0) {
    return;
  }
  const auto edge = [&](int i, int j) {
    // Of two corners of a Kuhn tetrahedron one has the bits of the other.
    const uint64_t low = corners[i] & corners[j];
    return MakeKey(node + lattice.Step(low), corners[i] ^ corners[j]);
  };
  // Whether (i, j, k, l) is an even permutation of the corners.
  const auto even = [](int i, int j, int k, int l) {
    return ((i > j) + (i > k) + (i > l) + (j > k) + (j > l) + (k > l)) % 2 == 0;
  };
  const auto add = [&](EdgeKey a, EdgeKey b, EdgeKey c, bool keep) {
    triangles->push_back(keep ? EdgeTriangle{a, b, c} : EdgeTriangle{a, c, b});
  };
  if (num_in == 2) {
    const bool keep = even(in[0], in[1], out[0], out[1]);
    const EdgeKey a = edge(in[0], out[0]), b = edge(in[0], out[1]);
    const EdgeKey c = edge(in[1], out[1]), d = edge(in[1], out[0]);
    add(a, b, c, keep);
    add(a, c, d, keep);
    return;
  }
  const int apex = num_in == 1 ? in[0] : out[0];
  const auto& base = num_in == 1 ? out : in;
  const bool keep = even(apex, base[0], base[1], base[2]) == (num_in == 1);
  add(edge(apex, base[0]), edge(apex, base[1]), edge(apex, base[2]), keep);
}

// The surface in one layer of cubes.
std::vector<EdgeTriangle> MarchLayer(const Lattice& lattice, uint64_t z) {
  // The six paths from corner 0 to corner 7 along the axes. In those of odd
  // permutations two corners are swapped, so that all have one orientation.
  static constexpr std::array<std::array<uint64_t, 4>, 6> kTetrahedra = {
      {{0, 1, 3, 7},
       {0, 2, 6, 7},
       {0, 4, 5, 7},
       {0, 3, 2, 7},
       {0, 6, 4, 7},
       {0, 5, 1, 7}}};
  std::vector<EdgeTriangle> triangles;
  for (uint64_t y = 0; y + 1 < lattice.size[1]; ++y) {
    for (uint64_t x = 0; x + 1 < lattice.size[0]; ++x) {
      const uint64_t node = lattice.Node(x, y, z);
      int num_in = 0;
      for (uint64_t bits = 0; bits < 8; ++bits) {
        num_in += lattice.values[node + lattice.Step(bits)] < 0;
      }
      if (num_in == 0 || num_in == 8) {
        continue;
      }
      for (const auto& corners : kTetrahedra) {
        MarchTetrahedron(lattice, node, corners, &triangles);
      }
    }
  }
  return triangles;
}

Eigen::Vector3f EdgePoint(const Lattice& lattice, EdgeKey key) {
  const uint64_t node = key / 8;
  const uint64_t other = node + lattice.Step(key % 8);
  const float a = lattice.values[node];
  const float b = lattice.values[other];
  // Not too close to the nodes, where facets would degenerate.
  const float t = std::clamp(a / (a - b), 0.1f, 0.9f);
  return (1 - t) * lattice.Position(node) + t * lattice.Position(other);
}

TriangleMesh March(const Lattice& lattice) {
  std::vector<std::vector<EdgeTriangle>> layers(lattice.size[2] - 1);
  tbb::parallel_for(size_t{0}, layers.size(),
                    [&](size_t z) { layers[z] = MarchLayer(lattice, z); });
  std::vector<EdgeKey> keys;
  for (const auto& layer : layers) {
    for (const EdgeTriangle& triangle : layer) {
      Append(triangle, &keys);
    }
  }
  std::vector<EdgeKey> vertices = keys;
  SortUnique(&vertices);
  TriangleMesh mesh;
  mesh.vertices.resize(vertices.size());
  mesh.facets.resize(keys.size() / 3);
  tbb::parallel_for(size_t{0}, vertices.size(), [&](size_t v) {
    mesh.vertices[v] = EdgePoint(lattice, vertices[v]);
  });
  tbb::parallel_for(size_t{0}, mesh.facets.size(), [&](size_t f) {
    for (int i = 0; i < 3; ++i) {
      mesh.facets[f][i] = std::ranges::lower_bound(vertices, keys[3 * f + i]) -
                          vertices.begin();
    }
  });
  return mesh;
}

Eigen::Vector3f Gradient(const Solid& solid, const Eigen::Vector3f& point,
                         float value, float step) {
  Eigen::Vector3f gradient;
  for (int i = 0; i < 3; ++i) {
    Eigen::Vector3f ahead = point;
    ahead[i] += step;
    gradient[i] = (solid(ahead) - value) / step;
  }
  return gradient;
}

// `vector`, shortened to `length` where it is longer.
Eigen::Vector3f Clamp(const Eigen::Vector3f& vector, float length) {
  const float norm = vector.norm();
  return norm > length ? Eigen::Vector3f(vector * (length / norm)) : vector;
}

// Evens out the facets of a mesh of the solid's surface: moves every vertex
// towards the mean of its neighbors, in the tangent plane, and back onto the
// surface by a Newton step. Vertices at the border stay.
// \param cell_size  limits the step of a vertex in one round, scene units
void SpreadVertices(const Solid& solid, float cell_size, int num_rounds,
                    TriangleMesh* mesh) {
  const std::vector<uint8_t> is_border = MakeVertexRings(*mesh).is_border;
  const size_t num_vertices = mesh->vertices.size();
  for (int round = 0; round < num_rounds; ++round) {
    std::vector<Eigen::Vector3f> sums(num_vertices, Eigen::Vector3f::Zero());
    std::vector<float> counts(num_vertices, 0);
    for (const Facet& facet : mesh->facets) {
      for (int i = 0; i < 3; ++i) {
        sums[facet[i]] += mesh->vertices[facet[(i + 1) % 3]] +
                          mesh->vertices[facet[(i + 2) % 3]];
        counts[facet[i]] += 2;
      }
    }
    tbb::parallel_for(size_t{0}, num_vertices, [&](size_t v) {
      if (is_border[v] || counts[v] == 0) {
        return;
      }
      Eigen::Vector3f& point = mesh->vertices[v];
      const float value = solid(point);
      const Eigen::Vector3f gradient =
          Gradient(solid, point, value, 0.05f * cell_size);
      const float squared = std::max(gradient.squaredNorm(), 0.1f);
      const Eigen::Vector3f move = sums[v] / counts[v] - point;
      point += Clamp(move - gradient * (move.dot(gradient) / squared) -
                         gradient * (value / squared),
                     0.3f * cell_size);
    });
  }
}

}  // namespace

TriangleMesh MeshSolid(const Solid& solid, float cell_size) {
  TriangleMesh mesh = March(Sample(solid, cell_size));
  SpreadVertices(solid, cell_size, kNumSpreadings, &mesh);
  return mesh;
}

std::vector<Eigen::Vector3f> VertexNormals(const TriangleMesh& mesh) {
  std::vector<Eigen::Vector3f> normals(mesh.vertices.size(),
                                       Eigen::Vector3f::Zero());
  for (const Facet& facet : mesh.facets) {
    for (const uint32_t vertex : facet) {
      normals[vertex] += AreaVector(mesh, facet);
    }
  }
  for (Eigen::Vector3f& normal : normals) {
    normal.normalize();
  }
  return normals;
}

}  // namespace colmap_ext::synthetic
