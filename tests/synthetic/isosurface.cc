#include "tests/synthetic/isosurface.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

#include "tests/synthetic/parallel.h"
#include "tests/synthetic/vertex_spreading.h"

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

// Fills a block of nodes. Far from the surface the signs are all that matters,
// and the detail, which is what costs, cannot change them.
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

Lattice Sample(const Solid& solid, float cell_size, int num_threads) {
  Lattice lattice;
  lattice.origin = solid.box.min();
  lattice.cell_size = cell_size;
  std::array<uint64_t, 3> blocks;
  for (int i = 0; i < 3; ++i) {
    lattice.size[i] = 2 + std::floor(solid.box.sizes()[i] / cell_size);
    blocks[i] = (lattice.size[i] + kBlock - 1) / kBlock;
  }
  lattice.values.resize(lattice.size[0] * lattice.size[1] * lattice.size[2]);
  ParallelFor(blocks[0] * blocks[1] * blocks[2], num_threads, [&](size_t b) {
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
  // The six ways from corner 0 to corner 7, one axis after another; those of
  // odd permutations with two corners swapped, so that all have one
  // orientation.
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
  // Not too close to the nodes, where facets would shrink to nothing.
  const float t = std::clamp(a / (a - b), 0.1f, 0.9f);
  return (1 - t) * lattice.Position(node) + t * lattice.Position(other);
}

TriangleMesh March(const Lattice& lattice, int num_threads) {
  std::vector<std::vector<EdgeTriangle>> layers(lattice.size[2] - 1);
  ParallelFor(layers.size(), num_threads,
              [&](size_t z) { layers[z] = MarchLayer(lattice, z); });
  std::vector<EdgeKey> keys;
  for (const auto& layer : layers) {
    for (const EdgeTriangle& triangle : layer) {
      keys.insert(keys.end(), triangle.begin(), triangle.end());
    }
  }
  std::vector<EdgeKey> vertices = keys;
  std::sort(vertices.begin(), vertices.end());
  vertices.erase(std::unique(vertices.begin(), vertices.end()), vertices.end());

  TriangleMesh mesh;
  mesh.vertices.resize(vertices.size());
  mesh.facets.resize(keys.size() / 3);
  ParallelFor(vertices.size() / 4096 + 1, num_threads, [&](size_t chunk) {
    const size_t end = std::min((chunk + 1) * 4096, vertices.size());
    for (size_t v = chunk * 4096; v < end; ++v) {
      mesh.vertices[v] = EdgePoint(lattice, vertices[v]);
    }
  });
  ParallelFor(mesh.facets.size() / 4096 + 1, num_threads, [&](size_t chunk) {
    const size_t end = std::min((chunk + 1) * 4096, mesh.facets.size());
    for (size_t f = chunk * 4096; f < end; ++f) {
      for (int i = 0; i < 3; ++i) {
        mesh.facets[f][i] = std::lower_bound(vertices.begin(), vertices.end(),
                                             keys[3 * f + i]) -
                            vertices.begin();
      }
    }
  });
  return mesh;
}

}  // namespace

TriangleMesh MeshSolid(const Solid& solid, float cell_size, int num_threads) {
  TriangleMesh mesh = March(Sample(solid, cell_size, num_threads), num_threads);
  SpreadVertices(solid, cell_size, kNumSpreadings, num_threads, &mesh);
  return mesh;
}

}  // namespace colmap_ext::synthetic
