#include "mesh/space_filling_curve.h"

#include <algorithm>

#include <gtest/gtest.h>

#include "tests/mesh/known_meshes.h"
#include "tests/random_vectors.h"

namespace colmap_ext::space_filling_curve_test {

constexpr int kNumBits = 21;

uint64_t Interleave(const Eigen::Vector3f& point) {
  uint64_t key = 0;
  for (int bit = 0; bit < kNumBits; ++bit) {
    for (int axis = 0; axis < 3; ++axis) {
      const auto coordinate = static_cast<uint64_t>(point[axis]);
      key |= (coordinate >> bit & 1) << (3 * bit + axis);
    }
  }
  return key;
}

// By the interleaved bits; points at one place by their indices.
TEST(OrderAlongCurve, IsThatOfTheInterleavedBits) {
  constexpr int kHalf = 1 << (kNumBits - 1);
  constexpr float kLast = 2 * kHalf - 1;
  Random random(1);
  std::vector<Eigen::Vector3f> points = RandomPoints(1000, kHalf - 1, &random);
  for (Eigen::Vector3f& point : points) {
    point.array() += kHalf;
  }
  points.emplace_back(0, 0, 0);
  points.emplace_back(kLast, kLast, kLast);
  points.insert(points.end(), points.begin(), points.begin() + 100);
  std::vector<uint32_t> expected = Iota(points.size());
  std::ranges::stable_sort(expected, {},
                           [&](uint32_t i) { return Interleave(points[i]); });
  EXPECT_EQ(OrderAlongCurve(points), expected);
}

TEST(OrderAlongCurve, DoesNotDependOnPlaceAndScaleAndKeepsEqualPoints) {
  Random random(2);
  const std::vector<Eigen::Vector3f> points = RandomPoints(500, 1000, &random);
  std::vector<Eigen::Vector3f> moved = points;
  for (Eigen::Vector3f& point : moved) {
    point = 8 * point + Eigen::Vector3f(1000, -5000, 16000);
  }
  EXPECT_EQ(OrderAlongCurve(moved), OrderAlongCurve(points));
  EXPECT_EQ(OrderAlongCurve(std::vector<Eigen::Vector3f>(3, {1, 2, 3})),
            (std::vector<uint32_t>{0, 1, 2}));
  EXPECT_TRUE(OrderAlongCurve({}).empty());
}

// The way along the curve is about as long as it is without the point.
TEST(OrderAlongCurve, OnePointFarOffLeavesTheOthersTheirOrder) {
  Random random(3);
  std::vector<Eigen::Vector3f> points = RandomPoints(5000, 1000, &random);
  const auto length = [&] {
    double sum = 0;
    const Eigen::Vector3f* last = nullptr;
    for (const uint32_t i : OrderAlongCurve(points)) {
      if (i < 5000) {
        sum += last != nullptr ? (points[i] - *last).norm() : 0;
        last = &points[i];
      }
    }
    return sum;
  };
  const double alone = length();
  for (const float distance : {1e9f, -1e9f, 1e10f, 1e12f}) {
    points.emplace_back(distance, -0.3f * distance, 7);
    EXPECT_LT(length(), 1.5 * alone) << distance;
    points.pop_back();
  }
}

// The same mesh, in which the vertices of a facet are near in memory.
TEST(SortAlongCurve, KeepsTheMeshAndBringsNeighborsTogether) {
  const TriangleMesh sphere = MakeBumpySphere(0.1F);
  TriangleMesh mesh = sphere;
  Random random(1);
  const std::vector<uint32_t> places = random.Permutation(mesh.vertices.size());
  for (uint32_t i = 0; i < places.size(); ++i) {
    mesh.vertices[places[i]] = sphere.vertices[i];
  }
  for (Facet& facet : mesh.facets) {
    facet = {places[facet[0]], places[facet[1]], places[facet[2]]};
  }
  const TriangleMesh before = mesh;
  const std::vector<uint32_t> order = SortAlongCurve(&mesh);
  ASSERT_EQ(mesh.vertices.size(), before.vertices.size());
  for (size_t i = 0; i < order.size(); ++i) {
    EXPECT_EQ(mesh.vertices[i], before.vertices[order[i]]);
  }
  EXPECT_EQ(TrianglesOf(mesh), TrianglesOf(before));
  const auto spread = [](const TriangleMesh& any) {
    double sum = 0;
    for (const Facet& facet : any.facets) {
      const auto [low, high] = std::ranges::minmax(facet);
      sum += high - low;
    }
    return sum;
  };
  EXPECT_LT(spread(mesh), 0.1 * spread(before));
  EXPECT_EQ(SortAlongCurve(&mesh)[7], 7);
}

}  // namespace colmap_ext::space_filling_curve_test
