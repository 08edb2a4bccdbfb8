#include "delaunay/edge_lengths.h"

#include <algorithm>
#include <cmath>
#include <set>
#include <utility>

#include <gtest/gtest.h>

#include "tests/delaunay/random_complex.h"

namespace colmap_ext {
namespace edge_lengths_test {

TEST(EdgeLengthPercentile, CountsEveryFiniteEdgeOnce) {
  for (const auto& [name, points] : DifficultPoints()) {
    SCOPED_TRACE(name);
    const Tetrahedralization tetrahedra = DelaunayOf(points);
    std::set<std::pair<uint32_t, uint32_t>> edges;
    for (const auto& cell : tetrahedra.cells) {
      for (const uint32_t u : cell.vertices) {
        for (const uint32_t v : cell.vertices) {
          if (u < v && v != kInfiniteVertex) {
            edges.emplace(u, v);
          }
        }
      }
    }
    std::vector<float> lengths;
    for (const auto& [u, v] : edges) {
      lengths.push_back((tetrahedra.points[u] - tetrahedra.points[v]).norm());
    }
    std::sort(lengths.begin(), lengths.end());
    for (const double percent : {0.0, 10.0, 25.0, 50.0, 99.0, 100.0}) {
      const auto nth = static_cast<size_t>(
          std::round(percent / 100 * static_cast<double>(lengths.size() - 1)));
      EXPECT_EQ(EdgeLengthPercentile(tetrahedra, percent), lengths[nth]);
    }
  }
}

TEST(EdgeLengthPercentile, IsZeroWithoutEdges) {
  for (const auto& [name, points] : DifficultPoints()) {
    SCOPED_TRACE(name);
    const Tetrahedralization tetrahedra = DelaunayOf(points);
    std::vector<uint8_t> is_left_out(tetrahedra.points.size(), 1);
    EXPECT_EQ(EdgeLengthPercentile(tetrahedra, 25, is_left_out), 0);
    is_left_out.front() = 0;  // A vertex alone has no edge.
    EXPECT_EQ(EdgeLengthPercentile(tetrahedra, 25, is_left_out), 0);
  }
}

}  // namespace edge_lengths_test
}  // namespace colmap_ext
