#include "tiles/tile_cells.h"

#include <algorithm>
#include <vector>

#include <gtest/gtest.h>

#include "tests/delaunay/random_complex.h"
#include "tests/random_vectors.h"

namespace colmap_ext {
namespace tile_cells_test {

float Between(float low, float high, Random* random) {
  return low + (high - low) * static_cast<float>(random->Unit());
}

// In a flat box.
std::vector<Eigen::Vector3f> FlatPoints(size_t count, Random* random) {
  std::vector<Eigen::Vector3f> points;
  for (size_t i = 0; i < count; ++i) {
    points.emplace_back(Between(0, 10, random), Between(0, 10, random),
                        Between(0, 1, random));
  }
  return points;
}

TEST(SplitTree, PartsAreOfAboutEqualWeight) {
  Random random(1);
  const std::vector<Eigen::Vector3f> points =
      RandomPoints(20000, 100000, &random);
  std::vector<float> weights;
  for (const Eigen::Vector3f& point : points) {
    weights.push_back(point.x() > 0 ? 3 : 1);
  }
  for (const size_t num_parts : {1, 2, 3, 7, 16}) {
    const SplitTree tree(points, weights, num_parts);
    std::vector<double> sums(num_parts, 0);
    double total = 0;
    for (size_t i = 0; i < points.size(); ++i) {
      ASSERT_LT(tree.PartOf(points[i]), num_parts);
      sums[tree.PartOf(points[i])] += weights[i];
      total += weights[i];
    }
    const double mean = total / static_cast<double>(num_parts);
    EXPECT_GT(std::ranges::min(sums), 0.98 * mean);
    EXPECT_LT(std::ranges::max(sums), 1.02 * mean);
  }
}

TEST(SplitTree, KnowsPlacesThatNoPointIsAt) {
  Random random(2);
  const std::vector<Eigen::Vector3f> points = RandomPoints(100, 10, &random);
  const SplitTree tree(points, std::vector<float>(points.size(), 1), 8);
  EXPECT_LT(tree.PartOf({1e6f, -1e6f, 0}), 8u);
}

TEST(TileCells, AreThePartsOfTheTree) {
  Random random(1);
  const auto points = FlatPoints(2000, &random);
  const SplitTree tree(points, std::vector<float>(points.size(), 1), 13);
  const TileCells cells = tree.Cells();
  ASSERT_EQ(cells.size(), 13);
  for (const Eigen::Vector3f& point : points) {
    EXPECT_EQ(CellOf(cells, point), tree.PartOf(point));
    EXPECT_EQ(CellOf(cells, 100 * point), tree.PartOf(100 * point));
  }
}

// Small facets all over the plane.
TriangleMesh MakeFacets(const std::vector<Eigen::Vector3f>& points) {
  TriangleMesh mesh;
  for (const Eigen::Vector3f& point : points) {
    const auto first = static_cast<uint32_t>(mesh.vertices.size());
    mesh.vertices.push_back(point);
    mesh.vertices.emplace_back(point + Eigen::Vector3f(0.1F, 0, 0));
    mesh.vertices.emplace_back(point + Eigen::Vector3f(0, 0.1F, 0));
    mesh.facets.push_back({first, first + 1, first + 2});
  }
  return mesh;
}

TEST(ColorTiles, KeepsTilesOfOneColorApart) {
  Random random(2);
  const auto points = FlatPoints(5000, &random);
  const TriangleMesh mesh = MakeFacets(points);
  const SplitTree tree(points, std::vector<float>(points.size(), 1), 16);
  const TileCells cells = tree.Cells();
  const std::vector<uint32_t> colors =
      ColorTiles(cells, std::vector<float>(16, 0.2F), mesh);
  EXPECT_LE(*std::ranges::max_element(colors), 5);
  for (const Facet& facet : mesh.facets) {
    std::vector<uint32_t> met;
    for (uint32_t tile = 0; tile < 16; ++tile) {
      if (GrowBox(cells[tile], 0.2F).intersects(BoxOf(mesh, facet))) {
        met.push_back(colors[tile]);
      }
    }
    std::ranges::sort(met);
    EXPECT_EQ(std::ranges::adjacent_find(met), met.end());
  }
}

TEST(MayHide, IsTrueOfWhatLiesBetween) {
  Random random(3);
  const auto corner = [&random](double size) -> Eigen::Vector3f {
    return RandomVector(&random, size).cast<float>();
  };
  size_t num_hiding = 0;
  for (int i = 0; i < 2000; ++i) {
    Eigen::AlignedBox3f seen(corner(1));
    seen.extend(corner(1));
    Eigen::AlignedBox3f box(corner(2));
    box.extend(Eigen::Vector3f(box.min() + corner(1)));
    const Eigen::Vector3f center = corner(8);
    const bool may_hide = MayHide(box, center, seen);
    num_hiding += may_hide ? 1 : 0;
    // Points of the hull within the box.
    for (int k = 0; k < 50; ++k) {
      const Eigen::Vector3f target = seen.sample();
      const Eigen::Vector3f point =
          center + Between(0, 1, &random) * (target - center);
      EXPECT_TRUE(may_hide || !box.contains(point));
    }
  }
  EXPECT_GT(num_hiding, 50);
  EXPECT_LT(num_hiding, 1000);
}

}  // namespace tile_cells_test
}  // namespace colmap_ext
