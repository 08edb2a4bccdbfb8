#include "refine/smoothness_model.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numeric>
#include <vector>

#include <gtest/gtest.h>
#include <Eigen/Geometry>

#include "mesh/normals.h"
#include "tests/mesh/known_meshes.h"

namespace colmap_ext::thin_plate_test {

using Eigen::Vector3f;

// A surface as ThinPlate takes it; footprints and pixels differ from vertex to
// vertex.
struct PlateScene {
  explicit PlateScene(TriangleMesh surface)
      : mesh(std::move(surface)),
        rings(MakeVertexRings(mesh)),
        normals(VertexNormals(mesh, rings)),
        relief(mesh.vertices.size(), 0) {
    Random random(1);
    for (size_t i = 0; i < mesh.vertices.size(); ++i) {
      footprints.push_back(static_cast<float>(0.01 * (1 + random.Unit())));
      num_pixels.push_back(static_cast<float>(random.Below(20)));
    }
  }

  ThinPlate Plate(double weight) const {
    return Plate(std::vector<double>(mesh.vertices.size(), weight));
  }

  ThinPlate Plate(const std::vector<double>& weights) const {
    return MakeThinPlate(
        {mesh.vertices, normals, rings, footprints, num_pixels}, weights,
        relief);
  }

  TriangleMesh mesh;
  VertexRings rings;
  std::vector<Vector3f> normals;
  std::vector<float> footprints;
  std::vector<float> num_pixels;
  std::vector<double> relief;
};

// Leaning in space.
TriangleMesh UnevenPlane() {
  Random random(2);
  const Eigen::Matrix3f rotation =
      Eigen::AngleAxisf(1, Vector3f(1, 2, 3).normalized()).toRotationMatrix();
  return Moved(MakeJitteredSquare(20, &random),
               [&](const Vector3f& p) -> Vector3f {
                 const Vector3f uneven(std::pow(p.x(), 1.7f), p.y(), p.z());
                 return rotation * uneven + Vector3f(0.5f, 0, 1);
               });
}

TEST(ThinPlate, IsFlatOnAPlaneHoweverItIsCut) {
  const PlateScene scene(UnevenPlane());
  const ThinPlate plate = scene.Plate(1);
  for (size_t i = 0; i < plate.residuals.size(); ++i) {
    EXPECT_NEAR(plate.residuals[i], 0, 1e-6);
    EXPECT_GT(plate.coefficients[i], 0);
  }
  EXPECT_LT(plate.Energy(), 1e-4);
}

// As where no image sees the surface.
TEST(ThinPlate, HasNoEnergyWithoutFootprints) {
  PlateScene scene(
      Moved(MakeCube(), [](const Vector3f&) { return Vector3f(1, 2, 3); }));
  std::ranges::fill(scene.footprints, 0);
  const ThinPlate plate = scene.Plate(1);
  EXPECT_EQ(plate.Energy(), 0);
  for (const float share : plate.shares) {
    EXPECT_TRUE(std::isfinite(share));
  }
}

// It is the sum of the two curvatures, in 1 / px, whatever the facets: on a
// sphere of radius R a neighbor at distance l lies l^2 / 2 R below the plane.
TEST(ThinPlate, MeasuresTheCurvatureOfASphereHoweverItIsCut) {
  for (const float cell_size : {0.1f, 0.25f}) {
    PlateScene scene(MakeBumpySphere(cell_size, 0));
    constexpr float kRadius = 3;
    for (size_t i = 0; i < scene.normals.size(); ++i) {
      scene.normals[i] = scene.mesh.vertices[i].normalized();
      scene.mesh.vertices[i] = kRadius * scene.normals[i];
    }
    const ThinPlate plate = scene.Plate(1);
    double energy = 0;
    for (size_t i = 0; i < plate.residuals.size(); ++i) {
      const double curvature = 2 * scene.footprints[i] / kRadius;
      const double expected =
          (1 + scene.num_pixels[i]) * curvature * curvature / 2;
      EXPECT_LT(plate.residuals[i], 0);
      EXPECT_NEAR(
          plate.coefficients[i] * plate.residuals[i] * plate.residuals[i] / 2,
          expected, 1e-3 * expected);
      energy += expected;
    }
    EXPECT_NEAR(plate.Energy(), energy, 1e-3 * energy);
  }
}

TEST(ThinPlate, MeasuresTheCurvatureOfACylinder) {
  // Of equilateral triangles, whose rings are alike in all directions.
  constexpr float kRadius = 10;
  constexpr float kEdge = 0.5f;
  const PlateScene scene(Moved(MakeSheet(9, 9), [](const Vector3f& at) {
    const float along = kEdge * (at.x() - 0.5f * at.y());
    const float around = kEdge * std::sqrt(0.75f) * at.y() / kRadius;
    return Vector3f(along, kRadius * std::sin(around),
                    -kRadius * std::cos(around));
  }));
  const ThinPlate plate = scene.Plate(1);
  for (size_t i = 0; i < plate.residuals.size(); ++i) {
    if (scene.rings.is_border[i] == 0) {
      EXPECT_EQ(scene.rings.neighbors[i].size(), 6);
      EXPECT_NEAR(std::sqrt(plate.coefficients[i] / (1 + scene.num_pixels[i])) *
                      std::abs(plate.residuals[i]),
                  scene.footprints[i] / kRadius,
                  0.01 * scene.footprints[i] / kRadius);
    }
  }
}

TEST(ThinPlate, DoesNotDependOnTheScale) {
  const PlateScene scene(MakeBumpyCap(0.1f));
  const ThinPlate expected = scene.Plate(3);
  EXPECT_GT(expected.Energy(), 0);
  for (const int exponent : {-10, 7}) {
    PlateScene scaled = scene;
    for (size_t i = 0; i < scaled.mesh.vertices.size(); ++i) {
      scaled.mesh.vertices[i] *= std::ldexp(1.0f, exponent);
      scaled.footprints[i] = std::ldexp(scaled.footprints[i], exponent);
    }
    const ThinPlate plate = scaled.Plate(3);
    EXPECT_EQ(plate.Energy(), expected.Energy());
    EXPECT_EQ(plate.shares, expected.shares);
    for (size_t i = 0; i < plate.residuals.size(); ++i) {
      EXPECT_EQ(plate.residuals[i],
                std::ldexp(expected.residuals[i], exponent));
      EXPECT_EQ(plate.coefficients[i],
                std::ldexp(expected.coefficients[i], -2 * exponent));
    }
  }
}

// The shares are the weights that the residuals are means by.
TEST(ThinPlate, TellsHowEachNeighborCounts) {
  const PlateScene scene(MakeBumpyCap(0.15f));
  const ThinPlate plate = scene.Plate(1);
  for (size_t i = 0; i < plate.residuals.size(); ++i) {
    const auto ring = scene.rings.neighbors[i];
    const float* shares =
        plate.shares.data() + scene.rings.neighbors.offsets[i];
    EXPECT_NEAR(std::accumulate(shares, shares + ring.size(), 0.0), 1, 1e-6);
    Eigen::Vector3d umbrella = Eigen::Vector3d::Zero();
    for (size_t k = 0; k < ring.size(); ++k) {
      umbrella +=
          shares[k] * (scene.mesh.vertices[ring[k]] - scene.mesh.vertices[i])
                          .cast<double>();
    }
    EXPECT_NEAR(plate.residuals[i],
                umbrella.dot(scene.normals[i].cast<double>()), 1e-6);
  }
}

// Borders hold on to the rest; a vertex without facets does not count.
TEST(ThinPlate, LeavesLooseVerticesAlone) {
  PlateScene scene(MakeBumpyCap(0.2f));
  scene.mesh.vertices.emplace_back(5, 5, 5);
  scene = PlateScene(scene.mesh);
  const ThinPlate plate = scene.Plate(1);
  EXPECT_EQ(plate.residuals.back(), 0);
  EXPECT_EQ(plate.coefficients.back(), 0);
  EXPECT_EQ(std::ranges::count(plate.coefficients, 0), 1);
}

TEST(ThinPlate, IsAtRestWhereItIsToKeepItsShape) {
  PlateScene scene(MakeBumpyCap(0.1f));
  const ThinPlate plate = scene.Plate(1);
  scene.relief = plate.residuals;
  const ThinPlate resting = scene.Plate(1);
  EXPECT_EQ(resting.Energy(), 0);
  EXPECT_EQ(resting.coefficients, plate.coefficients);
  for (double& relief : scene.relief) {
    relief *= 3;
  }
  EXPECT_NEAR(scene.Plate(1).Energy(), 4 * plate.Energy(),
              1e-9 * plate.Energy());
}

TEST(ThinPlate, CountsAsItsWeightsAndThePixelsSay) {
  PlateScene scene(MakeBumpyCap(0.2f));
  const ThinPlate plate = scene.Plate(1);
  std::vector<double> weights(plate.coefficients.size());
  std::iota(weights.begin(), weights.end(), 1);
  const ThinPlate weighted = scene.Plate(weights);
  EXPECT_EQ(weighted.residuals, plate.residuals);
  for (size_t i = 0; i < weights.size(); ++i) {
    EXPECT_NEAR(weighted.coefficients[i], weights[i] * plate.coefficients[i],
                1e-9 * weighted.coefficients[i]);
  }
  EXPECT_NEAR(scene.Plate(5).Energy(), 5 * plate.Energy(),
              1e-9 * plate.Energy());
  EXPECT_EQ(scene.Plate(0).Energy(), 0);
  const std::vector<float> num_pixels = scene.num_pixels;
  for (float& pixels : scene.num_pixels) {
    pixels = 2 * pixels + 1;
  }
  const ThinPlate doubled = scene.Plate(1);
  for (size_t i = 0; i < num_pixels.size(); ++i) {
    EXPECT_EQ(doubled.coefficients[i], 2 * plate.coefficients[i]);
  }
}

// As if all edges were half a pixel long.
TEST(ThinPlate, IsNoStifferForEdgesMuchShorterThanAPixel) {
  for (const float cell_size : {0.06f, 0.12f}) {
    PlateScene scene(MakeBumpySphere(cell_size));
    constexpr float kFootprint = 0.5f;
    std::ranges::fill(scene.footprints, kFootprint);
    std::ranges::fill(scene.num_pixels, 0);
    for (const double coefficient : scene.Plate(1).coefficients) {
      const double scale = 4 * kFootprint / std::pow(kFootprint / 2, 2);
      EXPECT_NEAR(coefficient, scale * scale, 1e-6 * coefficient);
    }
  }
}

constexpr uint32_t kSize = 20;  // vertices a side
constexpr float kFootprint = 0.5F;

// A sheet z = height(x, y) of kSize x kSize vertices, one scene unit apart.
template <typename Height>
TriangleMesh Sheet(Height height) {
  return MakeHeightField(kSize - 1, height);
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

TEST(Relief, PointsToTheSideOfTheNeighborsAndIsNoneOnAPlane) {
  const TriangleMesh mesh =
      Sheet([](float x, float y) { return 0.5F * x - 0.25F * y; });
  for (const double relief : ReliefOf(mesh)) {
    EXPECT_NEAR(relief, 0, 1e-6);
  }
  const auto bowl = [](float curvature) {
    return ReliefOf(Sheet([=](float x, float y) {
      return curvature * (std::pow(x - 10, 2) + y * y);
    }))[kMiddle];
  };
  EXPECT_GT(bowl(0.01F), 0.005);
  EXPECT_NEAR(bowl(-0.01F), -bowl(0.01F), 1e-6);
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
  const auto squares = [](const std::vector<double>& relief) {
    return std::inner_product(relief.begin(), relief.end(), relief.begin(),
                              0.0);
  };
  EXPECT_LT(squares(TrustedReliefOf(mesh)), 0.3 * squares(ReliefOf(mesh)));
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
  const TriangleMesh mesh = Sheet([](float x, float y) {
    return 0.2F * std::sin(1.7F * x) * std::cos(0.9F * y);
  });
  const std::vector<double> relief = TrustedReliefOf(mesh);
  const std::vector<double> of_scaled =
      TrustedReliefOf(Scaled(mesh, 1024), 1024 * kFootprint);
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

// Of a sheet's vertices.
template <typename Function>
std::vector<double> Values(const Function& function) {
  std::vector<double> values;
  for (const Vector3f& vertex : MakeSheet(kSize - 1, kSize - 1).vertices) {
    values.push_back(function(vertex.x(), vertex.y()));
  }
  return values;
}

// \param importance  none: 3 everywhere
std::vector<double> SharesOf(const std::vector<double>& relief,
                             const std::vector<double>& surface,
                             std::vector<double> importance = {}) {
  importance.resize(relief.size(), 3);
  return ReliefShares(MakeVertexRings(MakeSheet(kSize - 1, kSize - 1)),
                      importance, relief, surface);
}

TEST(ReliefShares, AreHowMuchOfItASurfaceHas) {
  const std::vector<double> waves = Values(Waves);
  for (const double share : {-0.5, 0.0, 0.3, 0.8, 1.0, 2.0}) {
    const std::vector<double> surface = Values(
        [&](float x, float y) { return Ripples(x, y) + share * Waves(x, y); });
    const double found = SharesOf(waves, surface)[kMiddle];
    EXPECT_NEAR(found, std::clamp(share, 0.0, 1.0), 0.15) << share;
    EXPECT_GE(found, 0);
    EXPECT_LE(found, 1);
  }
}

TEST(ReliefShares, AreThoseOfEachPart) {
  const std::vector<double> shares = SharesOf(
      Values(Waves),
      Values([](float x, float y) { return x < kSize / 2 ? 0 : Waves(x, y); }));
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
  EXPECT_GT(SharesOf(waves, surface, importance)[kMiddle], 0.8);
}

TEST(ReliefShares, AreNoneOfHardlyAnyRelief) {
  const std::vector<double> relief = Values([](float x, float y) {
    return (y < kSize / 2 ? 1e-3 : 1) * Waves(x, y);
  });
  const std::vector<double> shares = SharesOf(relief, relief);
  EXPECT_LT(shares[kSize / 2], 0.01);
  EXPECT_GT(shares[(kSize - 1) * kSize + kSize / 2], 0.8);
  for (const double share : SharesOf(std::vector<double>(relief.size(), 0),
                                     std::vector<double>(relief.size(), 1))) {
    EXPECT_EQ(share, 0);
  }
}

}  // namespace colmap_ext::thin_plate_test
