#include "viewer/coarse_mesh.h"

#include <gtest/gtest.h>

namespace colmap_ext {
namespace coarse_mesh_test {

TEST(CoarseMesh, IsOfAboutAsManyFacetsOnTheSameSurface) {
  constexpr int kSize = 200;
  ShownMesh fine;
  for (int y = 0; y <= kSize; ++y) {
    for (int x = 0; x <= kSize; ++x) {
      fine.mesh.vertices.emplace_back(0.01F * x, 0.01F * y, 1.0F);
      fine.confidences.push_back(0.01F * x / 2);
    }
  }
  for (int y = 0; y < kSize; ++y) {
    for (int x = 0; x < kSize; ++x) {
      const uint32_t a = y * (kSize + 1) + x;
      const uint32_t b = a + kSize + 1;
      fine.mesh.facets.push_back({a, a + 1, b + 1});
      fine.mesh.facets.push_back({a, b + 1, b});
      fine.labels.insert(fine.labels.end(), 2, x < kSize / 2 ? 0 : 1);
    }
  }
  const ShownMesh coarse = CoarseMesh(fine, 2000);
  EXPECT_GT(coarse.mesh.facets.size(), 500);
  EXPECT_LT(coarse.mesh.facets.size(), 4000);
  ASSERT_EQ(coarse.confidences.size(), coarse.mesh.vertices.size());
  ASSERT_EQ(coarse.labels.size(), coarse.mesh.facets.size());
  double area = 0;
  for (size_t i = 0; i < coarse.mesh.facets.size(); ++i) {
    const auto corner = [&](int k) {
      return coarse.mesh.vertices[coarse.mesh.facets[i][k]];
    };
    const Eigen::Vector3f a = corner(1) - corner(0);
    const Eigen::Vector3f b = corner(2) - corner(0);
    const float doubled = a.x() * b.y() - a.y() * b.x();
    EXPECT_GE(doubled, -1e-6);  // upwards, as they were
    area += 0.5 * doubled;
  }
  EXPECT_NEAR(area, 4, 0.3);
  for (size_t i = 0; i < coarse.mesh.vertices.size(); ++i) {
    EXPECT_NEAR(coarse.confidences[i], coarse.mesh.vertices[i].x() / 2, 1e-5);
  }
}

}  // namespace coarse_mesh_test
}  // namespace colmap_ext
