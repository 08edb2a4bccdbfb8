#include "tests/synthetic/vertex_spreading.h"

#include <algorithm>
#include <array>
#include <utility>

#include "tests/synthetic/parallel.h"

namespace colmap_ext::synthetic {
namespace {

constexpr size_t kChunk = 4096;  // vertices

// Vertices of edges that one facet alone has.
std::vector<char> BorderVertices(const TriangleMesh& mesh) {
  std::vector<std::pair<uint32_t, uint32_t>> edges;
  edges.reserve(3 * mesh.facets.size());
  for (const Facet& facet : mesh.facets) {
    for (int i = 0; i < 3; ++i) {
      edges.push_back(std::minmax({facet[i], facet[(i + 1) % 3]}));
    }
  }
  std::sort(edges.begin(), edges.end());
  std::vector<char> is_border(mesh.vertices.size(), false);
  for (size_t i = 0; i < edges.size();) {
    size_t j = i;
    while (j < edges.size() && edges[j] == edges[i]) {
      ++j;
    }
    if (j == i + 1) {
      is_border[edges[i].first] = is_border[edges[i].second] = true;
    }
    i = j;
  }
  return is_border;
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

}  // namespace

void SpreadVertices(const Solid& solid, float cell_size, int num_rounds,
                    int num_threads, TriangleMesh* mesh) {
  const std::vector<char> is_border = BorderVertices(*mesh);
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
    ParallelFor(num_vertices / kChunk + 1, num_threads, [&](size_t chunk) {
      const size_t end = std::min((chunk + 1) * kChunk, num_vertices);
      for (size_t v = chunk * kChunk; v < end; ++v) {
        if (is_border[v] || counts[v] == 0) {
          continue;
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
      }
    });
  }
}

std::vector<Eigen::Vector3f> VertexNormals(const TriangleMesh& mesh) {
  std::vector<Eigen::Vector3f> normals(mesh.vertices.size(),
                                       Eigen::Vector3f::Zero());
  for (const Facet& facet : mesh.facets) {
    const Eigen::Vector3f& a = mesh.vertices[facet[0]];
    const Eigen::Vector3f normal =
        (mesh.vertices[facet[1]] - a).cross(mesh.vertices[facet[2]] - a);
    for (const uint32_t vertex : facet) {
      normals[vertex] += normal;
    }
  }
  for (Eigen::Vector3f& normal : normals) {
    normal.normalize();
  }
  return normals;
}

}  // namespace colmap_ext::synthetic
