#include "mesh/adjacency.h"

namespace colmap_ext {

Rows<uint32_t> CornersByVertex(const std::vector<Facet>& facets) {
  ExpectIndexable(3 * facets.size(), "half-edges");
  uint32_t num_vertices = 0;
  for (const Facet& facet : facets) {
    num_vertices = std::max(num_vertices, std::ranges::max(facet) + 1);
  }
  return NumbersInRows(num_vertices, 3 * facets.size(), [&](uint32_t corner) {
    return FromVertex(facets, corner);
  });
}

std::vector<uint32_t> PairHalfEdges(const std::vector<Facet>& facets) {
  std::vector<uint32_t> partners(3 * facets.size(), kNone);
  ForEachEdge</*kInParallel=*/true>(facets, [&](auto first, auto last) {
    const uint32_t half = first->second;
    if (last - first == 2) {
      const uint32_t other = (first + 1)->second;
      if (FromVertex(facets, half) != FromVertex(facets, other)) {
        partners[half] = other;
        partners[other] = half;
      }
    }
  });
  return partners;
}

std::vector<uint32_t> VertexRings::FacetsAt(
    const std::vector<uint32_t>& vertices) const {
  std::vector<uint32_t> facets;
  for (const uint32_t vertex : vertices) {
    for (const uint32_t corner : corners[vertex]) {
      facets.push_back(corner / 3);
    }
  }
  SortUnique(&facets);
  return facets;
}

std::vector<uint32_t> VertexRings::VerticesAround(
    std::vector<uint32_t> vertices, int num_rings) const {
  SortUnique(&vertices);
  for (int ring = 0; ring < num_rings; ++ring) {
    for (size_t i = 0, size = vertices.size(); i < size; ++i) {
      Append(neighbors[vertices[i]], &vertices);
    }
    SortUnique(&vertices);
  }
  return vertices;
}

void AverageOverNeighbors(const Rows<uint32_t>& neighbors, int num_rounds,
                          std::vector<double>* values) {
  std::vector<double> means(values->size());
  for (int round = 0; round < num_rounds; ++round) {
    tbb::parallel_for(size_t{0}, values->size(), [&](size_t i) {
      const auto ring = neighbors[i];
      double sum = (*values)[i];
      for (const uint32_t neighbor : ring) {
        sum += (*values)[neighbor];
      }
      means[i] = sum / static_cast<double>(1 + ring.size());
    });
    values->swap(means);
  }
}

std::vector<uint32_t> VerticesOf(const TriangleMesh& mesh,
                                 const std::vector<uint32_t>& facets) {
  std::vector<uint32_t> vertices;
  for (const uint32_t facet : facets) {
    Append(mesh.facets[facet], &vertices);
  }
  SortUnique(&vertices);
  return vertices;
}

VertexRings MakeVertexRings(const TriangleMesh& mesh) {
  VertexRings rings;
  rings.is_border.assign(mesh.vertices.size(), 0);
  rings.corners = CornersByVertex(mesh.facets);
  rings.corners.offsets.resize(mesh.vertices.size() + 1,
                               rings.corners.values.size());
  const auto append = [&](size_t vertex, std::vector<uint32_t>* neighbors) {
    std::vector<uint32_t> others;  // once for each facet
    for (const uint32_t corner : rings.corners[vertex]) {
      others.push_back(ToVertex(mesh.facets, corner));
      others.push_back(FromVertex(mesh.facets, PreviousHalfEdge(corner)));
    }
    std::ranges::sort(others);
    for (auto first = others.begin(); first != others.end();) {
      const auto last = std::upper_bound(first, others.end(), *first);
      neighbors->push_back(*first);
      rings.is_border[vertex] |= last - first == 1;
      first = last;
    }
  };
  rings.neighbors = MakeRows<uint32_t>(rings.NumVertices(), append);
  return rings;
}

std::vector<uint32_t> SmoothingNeighbors(const TriangleMesh& mesh,
                                         const VertexRings& rings,
                                         uint32_t vertex) {
  const auto is_along_border = [&](uint32_t neighbor) {
    return std::ranges::count_if(rings.corners[vertex], [&](uint32_t corner) {
             return std::ranges::count(mesh.facets[corner / 3], neighbor) > 0;
           }) == 1;
  };
  std::vector<uint32_t> neighbors;
  for (const uint32_t neighbor : rings.neighbors[vertex]) {
    if (rings.is_border[vertex] == 0 || is_along_border(neighbor)) {
      neighbors.push_back(neighbor);
    }
  }
  return neighbors;
}

std::vector<double> MeanLengths(const Rows<uint32_t>& neighbors,
                                const std::vector<Eigen::Vector3f>& vertices) {
  std::vector<double> lengths(vertices.size(), 0);
  tbb::parallel_for(size_t{0}, vertices.size(), [&](size_t i) {
    for (const uint32_t neighbor : neighbors[i]) {
      lengths[i] += (vertices[neighbor] - vertices[i]).norm();
    }
    lengths[i] /= std::max<double>(1, static_cast<double>(neighbors[i].size()));
  });
  return lengths;
}

}  // namespace colmap_ext
