#include "meshing/noise_smoothing.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

#include <gtest/gtest.h>
#include <Eigen/Dense>

#include "mesh/adjacency.h"
#include "mesh/normals.h"
#include "spatial/self_intersections.h"
#include "tests/mesh/known_meshes.h"
#include "tests/threads.h"

namespace colmap_ext::noise_smoothing_test {

using Eigen::Vector3f;

std::vector<Vector3f> Shaken(std::vector<Vector3f> points, double sigma) {
  std::mt19937 generator(7);
  std::normal_distribution<double> normal(0, sigma);
  for (Vector3f& point : points) {
    for (float& value : point) {
      value += static_cast<float>(normal(generator));
    }
  }
  return points;
}

// Points of a saddle over the square from -1 to 1.
std::vector<Vector3f> SaddlePoints(size_t count) {
  Random random(3);
  std::vector<Vector3f> points;
  for (size_t i = 0; i < count; ++i) {
    const float x = random.Between(-1, 1);
    const float y = random.Between(-1, 1);
    points.emplace_back(x, y, 0.3f * x * x - 0.5f * x * y - 0.2f * y * y);
  }
  return points;
}

double Mean(const std::vector<float>& values) {
  double sum = 0;
  for (const float value : values) {
    sum += value;
  }
  return sum / static_cast<double>(values.size());
}

TEST(LocalNoise, IsThatOfTheNormalDirectionOrZeroOfFewPoints) {
  const std::vector<Vector3f> points = SaddlePoints(4000);
  EXPECT_LT(Mean(LocalNoise(points, points)), 5e-4);
  for (const double sigma : {1e-3, 4e-3}) {
    const std::vector<Vector3f> shaken = Shaken(points, sigma);
    EXPECT_NEAR(Mean(LocalNoise(shaken, shaken)), sigma, 0.15 * sigma);
  }
  const std::vector<Vector3f> few = SaddlePoints(11);
  EXPECT_EQ(LocalNoise(few, {few[0]}), std::vector<float>{0});
  EXPECT_EQ(LocalNoise(std::vector<Vector3f>(100, few[0]), {few[0]}),
            std::vector<float>{0});
  EXPECT_EQ(LocalNoise({}, {few[0]}), std::vector<float>{0});
}

TEST(LocalNoise, ScalesWithThePoints) {
  std::vector<Vector3f> points = Shaken(SaddlePoints(500), 0.01);
  const std::vector<float> noises = LocalNoise(points, points);
  for (Vector3f& point : points) {
    point *= 64;
  }
  const std::vector<float> scaled = LocalNoise(points, points);
  for (size_t i = 0; i < noises.size(); ++i) {
    EXPECT_NEAR(scaled[i], 64 * noises[i], 1e-3f * scaled[i]);
  }
}

using Reliefs = std::vector<double>;

// The root mean square of the umbrella vectors' heights over the surface, in
// lengths of edges, averaged five times over the rings; within the bounds.
Reliefs ExpectedReliefs(const TriangleMesh& mesh, double strength) {
  const VertexRings rings = MakeVertexRings(mesh);
  const std::vector<Vector3f> normals = VertexNormals(mesh, rings);
  Reliefs reliefs;
  for (size_t i = 0; i < mesh.vertices.size(); ++i) {
    Vector3f mean = Vector3f::Zero();
    float length = 0;
    for (const uint32_t neighbor : rings.neighbors[i]) {
      mean += mesh.vertices[neighbor] - mesh.vertices[i];
      length += (mesh.vertices[neighbor] - mesh.vertices[i]).norm();
    }
    reliefs.push_back(std::pow(mean.dot(normals[i]) / length, 2));
  }
  for (int round = 0; round < 5; ++round) {
    Reliefs means(reliefs);
    for (size_t i = 0; i < means.size(); ++i) {
      for (const uint32_t neighbor : rings.neighbors[i]) {
        means[i] += reliefs[neighbor];
      }
      means[i] /= static_cast<double>(1 + rings.neighbors[i].size());
    }
    reliefs = means;
  }
  for (double& relief : reliefs) {
    relief = std::clamp(std::sqrt(relief) / strength, 0.004, 0.05 / strength);
  }
  return reliefs;
}

// What the header says is minimized, solved densely.
std::vector<Vector3f> ExpectedRound(const TriangleMesh& measured,
                                    const std::vector<Vector3f>& lengths_at,
                                    float noise, const Reliefs& reliefs) {
  const auto size = static_cast<Eigen::Index>(measured.vertices.size());
  const VertexRings rings = MakeVertexRings(measured);
  Eigen::MatrixXd matrix = Eigen::MatrixXd::Zero(size, size);
  Eigen::MatrixX3d right(size, 3);
  Eigen::VectorXd lengths(size);
  for (Eigen::Index i = 0; i < size; ++i) {
    Eigen::RowVectorXd umbrella = Eigen::RowVectorXd::Zero(size);
    const auto ring = rings.neighbors[static_cast<size_t>(i)];
    double length = 0;
    for (const uint32_t neighbor : ring) {
      umbrella[neighbor] += 1.0 / static_cast<double>(ring.size());
      length += (lengths_at[neighbor] - lengths_at[i]).norm();
    }
    umbrella[i] -= 1;
    length /= static_cast<double>(ring.size());
    lengths[i] = length;
    const double bounded = std::min<double>(noise, length);
    matrix +=
        umbrella.transpose() * umbrella / std::pow(reliefs[i] * length, 2);
    matrix(i, i) += 1 / (bounded * bounded);
    right.row(i) = measured.vertices[i].cast<double>() / (bounded * bounded);
  }
  const Eigen::MatrixX3d solved = matrix.ldlt().solve(right);
  std::vector<Vector3f> expected;
  for (Eigen::Index i = 0; i < size; ++i) {
    const Vector3f motion =
        Vector3f(solved.row(i).cast<float>()) - measured.vertices[i];
    const float share =
        std::min(1.0f, static_cast<float>(lengths[i]) / motion.norm());
    expected.push_back(measured.vertices[i] + share * motion);
  }
  return expected;
}

TEST(SmoothByNoise, IsTheMinimum) {
  TriangleMesh mesh = MakeBumpySphere(0.4f);
  mesh.vertices = Shaken(mesh.vertices, 0.01);
  const TriangleMesh measured = mesh;
  constexpr float kNoise = 0.02f;
  for (const double strength : {1.0, 3.0}) {
    mesh = measured;
    SmoothByNoise({}, std::vector<float>(mesh.vertices.size(), kNoise),
                  strength, &mesh);
    TriangleMesh expected = measured;
    Reliefs reliefs(measured.vertices.size(), 0.05 / strength);
    for (int round = 0; round < 6; ++round) {
      expected.vertices =
          ExpectedRound(measured, expected.vertices, kNoise, reliefs);
      reliefs = ExpectedReliefs(expected, strength);
    }
    for (size_t i = 0; i < measured.vertices.size(); ++i) {
      EXPECT_LT((mesh.vertices[i] - expected.vertices[i]).norm(), 2e-3f);
    }
  }
}

// Of the heights over the plane z = 0.
double Roughness(const TriangleMesh& mesh) {
  double sum = 0;
  for (const Vector3f& vertex : mesh.vertices) {
    sum += vertex.z() * vertex.z();
  }
  return std::sqrt(sum / static_cast<double>(mesh.vertices.size()));
}

TEST(SmoothByNoise, MakesNoisyPlanesCalmAndKeepsWhatIsExact) {
  Random random(3);
  TriangleMesh flat = MakeJitteredSquare(40, &random);
  constexpr double kSigma = 0.005;  // a fifth of an edge
  TriangleMesh noisy = flat;
  noisy.vertices = Shaken(flat.vertices, kSigma);
  const auto smoothed = [&](float noise, double strength) {
    TriangleMesh mesh = noisy;
    const SmoothingReport report = SmoothByNoise(
        {}, std::vector<float>(mesh.vertices.size(), noise), strength, &mesh);
    EXPECT_GT(report.num_moved, 0u);
    return Roughness(mesh);
  };
  EXPECT_LT(smoothed(kSigma, 1), 0.25 * Roughness(noisy));
  EXPECT_LT(smoothed(kSigma, 5), smoothed(kSigma, 1));
  EXPECT_NEAR(smoothed(0, 1), Roughness(noisy), 0.02 * Roughness(noisy));
}

// A ridge between two planes stays sharp where both get calm.
TEST(SmoothByNoise, KeepsEdges) {
  Random random(3);
  TriangleMesh mesh = MakeJitteredSquare(40, &random);
  const auto roof = [](const Vector3f& vertex) {
    return 0.5f * std::abs(vertex.x() - 0.5f);
  };
  for (Vector3f& vertex : mesh.vertices) {
    vertex.z() = roof(vertex);
  }
  mesh.vertices = Shaken(mesh.vertices, 0.003);
  SmoothByNoise({}, std::vector<float>(mesh.vertices.size(), 0.003f), 1, &mesh);
  double at_ridge = 0;
  double on_planes = 0;
  for (const Vector3f& vertex : mesh.vertices) {
    const double error = std::abs(vertex.z() - roof(vertex));
    double& largest =
        std::abs(vertex.x() - 0.5f) < 0.03f ? at_ridge : on_planes;
    largest = std::max(largest, error);
  }
  EXPECT_LT(at_ridge, 0.01);  // 0.4 of an edge
  EXPECT_LT(on_planes, 0.006);
}

// Of a MakeJitteredSquare().
size_t MiddleVertex(const TriangleMesh& square) {
  const auto middle =
      std::ranges::min_element(square.vertices, {}, [](const Vector3f& vertex) {
        return (vertex - Vector3f(0.5f, 0.5f, 0)).norm();
      });
  return static_cast<size_t>(middle - square.vertices.begin());
}

TEST(SmoothByNoise, PutsUnmeasuredVerticesBetweenTheirNeighbors) {
  Random random(3);
  TriangleMesh mesh = MakeJitteredSquare(9, &random);
  std::vector<float> noises(mesh.vertices.size(), 0);
  const size_t spike = MiddleVertex(mesh);
  noises[spike] = std::numeric_limits<float>::infinity();
  mesh.vertices[spike].z() = 0.08f;
  SmoothByNoise({}, noises, 1, &mesh);
  EXPECT_LT(std::abs(mesh.vertices[spike].z()), 0.02f);
}

// A spike of one vertex is flattened, unless a camera stands under it.
TEST(SmoothByNoise, DoesNotPassOverCameras) {
  Random random(3);
  TriangleMesh mesh = MakeJitteredSquare(9, &random);
  const size_t spike = MiddleVertex(mesh);
  mesh.vertices[spike].z() = 0.08f;
  const Vector3f below = mesh.vertices[spike] - Vector3f(0, 0, 0.03f);
  const std::vector<float> noises(mesh.vertices.size(), 0.1f);
  const auto height = [&](const std::vector<Vector3f>& centers) {
    TriangleMesh smoothed = mesh;
    SmoothByNoise(centers, noises, 1, &smoothed);
    return smoothed.vertices[spike].z();
  };
  EXPECT_LT(height({}), below.z());
  EXPECT_GT(height({below}), below.z());
  EXPECT_EQ(height({below + Vector3f(0, 0, 9)}), height({}));
}

TEST(SmoothByNoise, KeepsStraightBorders) {
  Random random(3);
  TriangleMesh mesh = MakeJitteredSquare(10, &random);
  const std::vector<Vector3f> before = mesh.vertices;
  const std::vector<uint32_t> partners = PairHalfEdges(mesh.facets);
  SmoothByNoise({}, std::vector<float>(before.size(), 0.005f), 1, &mesh);
  size_t num_checked = 0;
  for (uint32_t half = 0; half < partners.size(); ++half) {
    const uint32_t vertex = FromVertex(mesh.facets, half);
    const Vector3f& position = before[vertex];
    const float from_corner =
        std::max(std::abs(position.x() - 0.5f), std::abs(position.y() - 0.5f)) -
        std::min(std::abs(position.x() - 0.5f), std::abs(position.y() - 0.5f));
    if (partners[half] == kNone && from_corner > 0.25f) {
      // How far inside of the square.
      const Vector3f& moved = mesh.vertices[vertex];
      EXPECT_NEAR(
          std::min({moved.x(), 1 - moved.x(), moved.y(), 1 - moved.y()}), 0,
          0.01f);
      ++num_checked;
    }
  }
  EXPECT_EQ(num_checked, 20u);
}

TEST(SmoothByNoise, MovesNothingFarOrThroughOthers) {
  // Two noisy sheets, nearer to each other than their noise.
  Random random(3);
  TriangleMesh mesh = MakeJitteredSquare(20, &random);
  const auto size = static_cast<uint32_t>(mesh.vertices.size());
  const std::vector<Facet> facets = mesh.facets;
  for (uint32_t i = 0; i < size; ++i) {
    mesh.vertices[i].z() = random.Between(-0.02f, 0.02f);
    mesh.vertices.push_back(mesh.vertices[i] + Vector3f(0, 0, 1e-3f));
  }
  for (const Facet& facet : facets) {
    mesh.facets.push_back({facet[0] + size, facet[2] + size, facet[1] + size});
  }
  ASSERT_TRUE(FindSelfIntersections(mesh).empty());
  const std::vector<Vector3f> before = mesh.vertices;
  std::vector<float> noises;
  for (uint32_t i = 0; i < 2 * size; ++i) {
    noises.push_back(random.Between(0, 0.05f));
  }
  const SmoothingReport report = SmoothByNoise({}, noises, 1, &mesh);
  EXPECT_GT(report.num_kept, 0u);
  EXPECT_TRUE(FindSelfIntersections(mesh).empty());
  for (size_t i = 0; i < before.size(); ++i) {
    EXPECT_LT((mesh.vertices[i] - before[i]).norm(), 0.15f);
  }
}

TEST(SmoothByNoise, DoesNotDependOnThreads) {
  TriangleMesh mesh = MakeBumpyCap(0.05f);
  mesh.vertices = Shaken(mesh.vertices, 0.01);
  const auto smooth = [&] {
    TriangleMesh smoothed = mesh;
    SmoothByNoise({}, LocalNoise(mesh.vertices, mesh.vertices), 1, &smoothed);
    return smoothed.vertices;
  };
  ExpectSameForAnyThreads(smooth);
}

}  // namespace colmap_ext::noise_smoothing_test
