#include "refine/relief.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

#include <gtest/gtest.h>

#include "tests/mesh/known_meshes.h"

namespace colmap_ext {
namespace relief_test {

constexpr uint32_t kSize = 20;  // vertices a side
constexpr float kFootprint = 0.5F;

// A sheet z = height(x, y) of kSize x kSize vertices, one scene unit apart.
template <typename Height>
TriangleMesh Sheet(Height height) {
  TriangleMesh mesh = MakeSheet(kSize - 1, kSize - 1);
  for (Eigen::Vector3f& vertex : mesh.vertices) {
    vertex.z() = height(vertex.x(), vertex.y());
  }
  return mesh;
}

std::vector<double> TrustedReliefOf(const TriangleMesh& mesh,
                                    float footprint = kFootprint) {
  return TrustedRelief(mesh, MakeVertexRings(mesh),
                       std::vector<float>(mesh.vertices.size(), footprint));
}

std::vector<double> ReliefOf(const TriangleMesh& mesh) {
  return Relief(mesh, MakeVertexRings(mesh),
                std::vector<float>(mesh.vertices.size(), kFootprint));
}

constexpr uint32_t kMiddle = kSize / 2 * kSize + kSize / 2;

TEST(Relief, OfAPlaneIsNone) {
  const TriangleMesh mesh =
      Sheet([](float x, float y) { return 0.5F * x - 0.25F * y; });
  for (const double relief : ReliefOf(mesh)) {
    EXPECT_NEAR(relief, 0, 1e-6);
  }
}

TEST(Relief, PointsToTheSideOfTheNeighbors) {
  const TriangleMesh bowl = Sheet(
      [](float x, float y) { return 0.01F * (std::pow(x - 10, 2) + y * y); });
  const TriangleMesh hill = Sheet(
      [](float x, float y) { return -0.01F * (std::pow(x - 10, 2) + y * y); });
  EXPECT_GT(ReliefOf(bowl)[kMiddle], 0.005);
  EXPECT_NEAR(ReliefOf(hill)[kMiddle], -ReliefOf(bowl)[kMiddle], 1e-6);
}

TEST(TrustedRelief, IsThatOfAnEvenlyCurvedSurface) {
  const TriangleMesh mesh = Sheet([](float x, float y) {
    return 0.002F * (std::pow(x - 10, 2) + std::pow(y - 10, 2));
  });
  const double relief = ReliefOf(mesh)[kMiddle];
  EXPECT_NEAR(TrustedReliefOf(mesh)[kMiddle], relief, 0.02 * relief);
}

TEST(TrustedRelief, IsLittleOfWhatDiffersFromVertexToVertex) {
  const TriangleMesh mesh = Sheet([](float x, float y) {
    return 0.05F * std::sin(12.9898F * x + 78.233F * y * y);
  });
  const std::vector<double> relief = ReliefOf(mesh);
  const std::vector<double> trusted = TrustedReliefOf(mesh);
  double sum = 0;
  double sum_trusted = 0;
  for (size_t i = 0; i < relief.size(); ++i) {
    sum += relief[i] * relief[i];
    sum_trusted += trusted[i] * trusted[i];
  }
  EXPECT_LT(sum_trusted, 0.3 * sum);
}

TEST(TrustedRelief, LeavesSpikesOut) {
  const auto spike = [](float height) {
    return Sheet([height](float x, float y) {
      return x == 10 && y == 10 ? height : 0.0F;
    });
  };
  // As much as its neighbors, on the other side of it, have to give.
  const double low = TrustedReliefOf(spike(0.05F))[kMiddle];
  EXPECT_LT(low, -0.01);
  EXPECT_GE(TrustedReliefOf(spike(1.0F))[kMiddle], 0);
}

TEST(TrustedRelief, ScalesWithTheScene) {
  const auto height = [](float x, float y) {
    return 0.2F * std::sin(1.7F * x) * std::cos(0.9F * y);
  };
  const TriangleMesh mesh = Sheet(height);
  TriangleMesh scaled = mesh;
  for (Eigen::Vector3f& vertex : scaled.vertices) {
    vertex *= 1024;
  }
  const std::vector<double> relief = TrustedReliefOf(mesh);
  const std::vector<double> of_scaled =
      TrustedReliefOf(scaled, 1024 * kFootprint);
  for (size_t i = 0; i < relief.size(); ++i) {
    EXPECT_EQ(of_scaled[i], 1024 * relief[i]);
  }
}

TEST(TrustedRelief, IsNoneAtBorders) {
  const TriangleMesh mesh =
      Sheet([](float x, float y) { return 0.01F * x * y; });
  const std::vector<double> relief = TrustedReliefOf(mesh);
  for (uint32_t i = 0; i < kSize; ++i) {
    EXPECT_EQ(relief[i], 0);
    EXPECT_EQ(relief[i * kSize], 0);
  }
}

double Waves(float x, float y) { return 0.2 * std::sin(x) * std::cos(y); }
double Ripples(float x, float y) { return 0.1 * std::sin(2 * x + 3 * y); }

std::vector<double> Values(double (*function)(float, float)) {
  std::vector<double> values;
  for (const Eigen::Vector3f& vertex :
       MakeSheet(kSize - 1, kSize - 1).vertices) {
    values.push_back(function(vertex.x(), vertex.y()));
  }
  return values;
}

// Of a sheet's vertices.
std::vector<double> SharesOf(const std::vector<double>& relief,
                             const std::vector<double>& surface) {
  return ReliefShares(MakeVertexRings(MakeSheet(kSize - 1, kSize - 1)),
                      std::vector<double>(relief.size(), 3), relief, surface);
}

TEST(ReliefShares, AreHowMuchOfItASurfaceHas) {
  const std::vector<double> waves = Values(Waves);
  for (const double share : {-0.5, 0.0, 0.3, 0.8, 1.0, 2.0}) {
    std::vector<double> surface = Values(Ripples);
    for (size_t i = 0; i < surface.size(); ++i) {
      surface[i] += share * waves[i];
    }
    const double found = SharesOf(waves, surface)[kMiddle];
    EXPECT_NEAR(found, std::clamp(share, 0.0, 1.0), 0.15) << share;
    EXPECT_GE(found, 0);
    EXPECT_LE(found, 1);
  }
}

TEST(ReliefShares, AreThoseOfEachPart) {
  const std::vector<double> waves = Values(Waves);
  std::vector<double> surface = waves;
  for (size_t i = 0; i < surface.size(); ++i) {
    if (i % kSize < kSize / 2) {
      surface[i] = 0;
    }
  }
  const std::vector<double> shares = SharesOf(waves, surface);
  const uint32_t row = kSize / 2 * kSize;
  EXPECT_LT(shares[row], 0.1);
  EXPECT_GT(shares[row + kSize - 1], 0.8);
}

TEST(ReliefShares, LeaveOutWhatHasNoImportance) {
  const std::vector<double> waves = Values(Waves);
  std::vector<double> surface = waves;
  std::vector<double> importance(waves.size(), 1);
  for (size_t i = 0; i < surface.size(); i += 3) {
    surface[i] = -1e6 * waves[i];
    importance[i] = 0;
  }
  const VertexRings rings = MakeVertexRings(MakeSheet(kSize - 1, kSize - 1));
  EXPECT_GT(ReliefShares(rings, importance, waves, surface)[kMiddle], 0.8);
}

TEST(ReliefShares, AreNoneOfHardlyAnyRelief) {
  std::vector<double> relief = Values(Waves);
  for (size_t i = 0; i < relief.size() / 2; ++i) {
    relief[i] *= 1e-3;
  }
  const std::vector<double> shares = SharesOf(relief, relief);
  EXPECT_LT(shares[kSize / 2], 0.01);
  EXPECT_GT(shares[(kSize - 1) * kSize + kSize / 2], 0.8);
  for (const double share : SharesOf(std::vector<double>(relief.size(), 0),
                                     std::vector<double>(relief.size(), 1))) {
    EXPECT_EQ(share, 0);
  }
}

}  // namespace relief_test
}  // namespace colmap_ext
