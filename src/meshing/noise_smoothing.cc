#include "meshing/noise_smoothing.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>

#include <tbb/parallel_for.h>
#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>

#include "base/rows.h"
#include "mesh/adjacency.h"
#include "mesh/normals.h"
#include "optim/conjugate_gradients.h"
#include "scene/point_tree.h"
#include "spatial/self_intersections.h"

namespace colmap_ext {
namespace {

using Eigen::Vector3d;
using Eigen::Vector3f;

constexpr float kInfinity = std::numeric_limits<float>::infinity();

// Of the points that a quadric is fitted to. A choice: five times as many as
// it has coefficients.
constexpr size_t kNumNearest = 32;
constexpr int kNumCoefficients = 6;
using Coefficients = Eigen::Matrix<double, kNumCoefficients, 1>;

// The deviation of the umbrella vectors, in mean lengths of edges: the first
// round has the largest one, further ones what the surface has around a vertex.
// Tuned by the accuracy of bunny, statue and wall, and by the roughness of the
// walls of south: a larger maximum is more exact, but hedges hide more of what
// is behind them.
constexpr double kMaxRelief = 0.05;
constexpr double kMinRelief = 0.004;

// Rounds over the ring of neighbors that average the relief. A choice.
constexpr int kReliefRounds = 5;

// The noise lies within these bounds, in mean lengths of edges, which bounds
// the condition of the equations. A choice.
constexpr double kMinNoise = 1e-3;
constexpr double kMaxNoise = 1;

// Each round has the relief and the lengths of edges that the last one leaves.
// A choice: walls are calm after six, and nothing else changes after four.
constexpr int kSmoothingRounds = 6;

// Of putting back; what still intersects is left to the repair. A choice.
constexpr int kPutBackRounds = 8;

// Each round continues where the last one ended, so that the errors of all but
// the last do not count. A choice.
constexpr SolverOptions kSolver{.tolerance = 0.03, .max_iterations = 200};

// The noise by the quadric z = q(x, y) over the plane that fits the points.
float NoiseAt(const Vector3f& place, std::span<const Vector3f> points,
              const std::vector<uint32_t>& nearest) {
  if (nearest.size() < 2 * kNumCoefficients) {
    return 0;
  }
  const double radius_squared =
      (points[nearest.back()] - place).cast<double>().squaredNorm();
  if (!(radius_squared > 0)) {
    return 0;
  }
  Vector3d mean = Vector3d::Zero();
  for (const uint32_t point : nearest) {
    mean += (points[point] - place).cast<double>();
  }
  mean /= static_cast<double>(nearest.size());
  Eigen::Matrix3d scatter = Eigen::Matrix3d::Zero();
  for (const uint32_t point : nearest) {
    const Vector3d from_mean = (points[point] - place).cast<double>() - mean;
    scatter += from_mean * from_mean.transpose();
  }
  // Ascending: the normal first.
  const Eigen::Matrix3d axes =
      Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(scatter).eigenvectors();
  using Row = Eigen::Matrix<double, kNumCoefficients + 1, 1>;
  // The normal equations, with the right hand side as the last column.
  Eigen::Matrix<double, kNumCoefficients + 1, kNumCoefficients + 1> products;
  products.setZero();
  double sum_of_weights = 0;
  for (const uint32_t point : nearest) {
    const Vector3d offset = (points[point] - place).cast<double>();
    const Vector3d local =
        axes.transpose() * (offset - mean) / std::sqrt(radius_squared);
    const double weight = 1 - 0.75 * offset.squaredNorm() / radius_squared;
    Row row;
    row << 1, local[1], local[2], local[1] * local[1], local[1] * local[2],
        local[2] * local[2], local[0];
    products += weight * row * row.transpose();
    sum_of_weights += weight;
  }
  const Coefficients right = products.topRightCorner<kNumCoefficients, 1>();
  const Coefficients quadric =
      products.topLeftCorner<kNumCoefficients, kNumCoefficients>().ldlt().solve(
          right);
  const double residual =
      products(kNumCoefficients, kNumCoefficients) - quadric.dot(right);
  const auto count = static_cast<double>(nearest.size());
  const double variance = std::max(residual, 0.0) / sum_of_weights *
                          radius_squared * count / (count - kNumCoefficients);
  return std::isfinite(variance) ? static_cast<float>(std::sqrt(variance)) : 0;
}

// The neighbors that a vertex is compared with, and the reverse.
struct Umbrellas {
  VertexRings rings;
  Rows<uint32_t> neighbors;  // [V] those along the border at the border
  Rows<uint32_t> users;      // [V] whose neighbor it is
};

Umbrellas MakeUmbrellas(const TriangleMesh& mesh) {
  Umbrellas umbrellas{MakeVertexRings(mesh), {}, {}};
  umbrellas.neighbors = MakeRows<uint32_t>(
      mesh.vertices.size(), [&](size_t i, std::vector<uint32_t>* row) {
        Append(
            SmoothingNeighbors(mesh, umbrellas.rings, static_cast<uint32_t>(i)),
            row);
      });
  umbrellas.users =
      GroupInRows<uint32_t>(mesh.vertices.size(), [&](const auto& add) {
        for (uint32_t i = 0; i < umbrellas.neighbors.size(); ++i) {
          for (const uint32_t neighbor : umbrellas.neighbors[i]) {
            add(neighbor, i);
          }
        }
      });
  return umbrellas;
}

// The normal equations of the displacements, for round after round. Vectors
// have 3 V elements.
class Smoother {
 public:
  using Values = SolverVectors::Vector;

  explicit Smoother(const Umbrellas& umbrellas)
      : umbrellas_(umbrellas),
        data_(umbrellas.neighbors.size()),
        smoothness_(data_.size()),
        diagonal_(data_.size()),
        weighted_(3 * data_.size()) {}

  // \param noises [V] of the positions, scene units
  // \param reliefs [V] deviations of the umbrella vectors, in lengths of edges
  // \param lengths [V] mean lengths of edges
  void SetWeights(const std::vector<float>& noises,
                  const std::vector<double>& reliefs,
                  const std::vector<double>& lengths) {
    tbb::parallel_for(size_t{0}, data_.size(), [&](size_t i) {
      data_[i] = 1;
      smoothness_[i] = 0;
      if (lengths[i] > 0) {
        const double noise = std::clamp<double>(
            noises[i], kMinNoise * lengths[i], kMaxNoise * lengths[i]);
        data_[i] = 1 / (noise * noise);
        const double deviation = reliefs[i] * lengths[i];
        smoothness_[i] = 1 / (deviation * deviation);
      }
    });
    tbb::parallel_for(size_t{0}, data_.size(), [&](size_t i) {
      diagonal_[i] = data_[i] + smoothness_[i];
      for (const uint32_t user : umbrellas_.users[i]) {
        diagonal_[i] += smoothness_[user] * Share(user) * Share(user);
      }
    });
  }

  // The motions of the vertices that minimize the sum of both terms.
  // \param positions [V] the measured ones
  const Values& Minimize(const std::vector<Vector3f>& positions,
                         const std::vector<Vector3f>& vertices) {
    Values& descent = vectors_.residual;
    Values& values = vectors_.direction;  // until the solver starts
    descent.resize(weighted_.size());
    values.resize(weighted_.size());
    tbb::parallel_for(size_t{0}, vertices.size(), [&](size_t i) {
      At(&values, i) = vertices[i].cast<double>();
    });
    Multiply(values, 0, &descent);
    tbb::parallel_for(size_t{0}, vertices.size(), [&](size_t i) {
      At(&descent, i) = data_[i] * (positions[i] - vertices[i]).cast<double>() -
                        At(descent, i);
    });
    SolveByConjugateGradients(
        kSolver, [&](const Values& in, Values* out) { Multiply(in, 1, out); },
        [&](const Values& in, Values* out) {
          tbb::parallel_for(size_t{0}, diagonal_.size(), [&](size_t i) {
            At(out, i) = At(in, i) / diagonal_[i];
          });
        },
        &vectors_);
    return vectors_.values;
  }

  static Eigen::Map<const Vector3d> At(const Values& values, size_t vertex) {
    return Eigen::Map<const Vector3d>(&values[3 * vertex]);
  }

 private:
  static Eigen::Map<Vector3d> At(Values* values, size_t vertex) {
    return Eigen::Map<Vector3d>(&(*values)[3 * vertex]);
  }

  // Of each neighbor in the mean.
  double Share(size_t vertex) const {
    return 1 / static_cast<double>(umbrellas_.neighbors[vertex].size());
  }

  // out = (data_share * data's matrix + smoothness' matrix) * in
  void Multiply(const Values& in, double data_share, Values* out) {
    tbb::parallel_for(size_t{0}, data_.size(), [&](size_t i) {
      const auto ring = umbrellas_.neighbors[i];
      Vector3d sum = Vector3d::Zero();
      for (const uint32_t neighbor : ring) {
        sum += At(in, neighbor) - At(in, i);
      }
      if (!ring.empty()) {
        At(&weighted_, i) = smoothness_[i] * Share(i) * sum;
      }
    });
    tbb::parallel_for(size_t{0}, data_.size(), [&](size_t i) {
      Vector3d sum = data_share * data_[i] * At(in, i) - At(weighted_, i);
      for (const uint32_t user : umbrellas_.users[i]) {
        sum += Share(user) * At(weighted_, user);
      }
      At(out, i) = sum;
    });
  }

  const Umbrellas& umbrellas_;
  std::vector<double> data_;
  std::vector<double> smoothness_;
  std::vector<double> diagonal_;  // the same for all three coordinates
  Values weighted_;  // Multiply()'s umbrella vectors times their weights
  SolverVectors vectors_;
};

// [V] The relief of a surface, in mean lengths of edges: the root mean square
// of the umbrella vectors around each vertex; away from the border only their
// components along the normal count. Not bounded.
// \param lengths  MeanLengths() of the mesh
std::vector<double> MeasureRelief(const Umbrellas& umbrellas,
                                  const std::vector<double>& lengths,
                                  const TriangleMesh& mesh) {
  const size_t size = mesh.vertices.size();
  const std::vector<Vector3f> normals = VertexNormals(mesh, umbrellas.rings);
  std::vector<double> squares(size, 0);
  tbb::parallel_for(size_t{0}, size, [&](size_t i) {
    const auto ring = umbrellas.neighbors[i];
    if (lengths[i] > 0) {
      Vector3f sum = Vector3f::Zero();
      for (const uint32_t neighbor : ring) {
        sum += mesh.vertices[neighbor] - mesh.vertices[i];
      }
      const double height =
          umbrellas.rings.is_border[i] != 0 ? sum.norm() : sum.dot(normals[i]);
      const double relief =
          height / (static_cast<double>(ring.size()) * lengths[i]);
      squares[i] = relief * relief;
    }
  });
  AverageOverNeighbors(umbrellas.neighbors, kReliefRounds, &squares);
  std::ranges::transform(squares, squares.begin(),
                         [](double square) { return std::sqrt(square); });
  return squares;
}

// [V] How far a vertex may move so that none of its facets passes over a place:
// by the distance of the place from the sphere that holds the facet's corners.
std::vector<float> MotionLimits(const std::vector<Vector3f>& places,
                                const TriangleMesh& mesh) {
  const PointTree tree(places);
  std::vector<float> distances(mesh.facets.size(), kInfinity);
  tbb::parallel_for(size_t{0}, mesh.facets.size(), [&](size_t i) {
    const auto [a, b, c] = CornersOf(mesh, mesh.facets[i]);
    const Vector3f centroid = (a + b + c) / 3;
    const float radius = std::sqrt(
        std::max({(a - centroid).squaredNorm(), (b - centroid).squaredNorm(),
                  (c - centroid).squaredNorm()}));
    for (const uint32_t nearest : tree.Nearest(centroid, 1, kInfinity)) {
      distances[i] =
          std::max(0.0f, (places[nearest] - centroid).norm() - radius);
    }
  });
  std::vector<float> limits(mesh.vertices.size(), kInfinity);
  for (size_t i = 0; i < mesh.facets.size(); ++i) {
    for (const uint32_t vertex : mesh.facets[i]) {
      limits[vertex] = std::min(limits[vertex], distances[i]);
    }
  }
  return limits;
}

}  // namespace

std::vector<float> LocalNoise(std::span<const Vector3f> points,
                              const std::vector<Vector3f>& places) {
  const PointTree tree(points);
  std::vector<float> noises(places.size());
  tbb::parallel_for(size_t{0}, places.size(), [&](size_t i) {
    noises[i] = NoiseAt(places[i], points,
                        tree.Nearest(places[i], kNumNearest, kInfinity));
  });
  return noises;
}

SmoothingReport SmoothByNoise(const std::vector<Vector3f>& centers,
                              const std::vector<float>& noises, double strength,
                              TriangleMesh* mesh) {
  const Umbrellas umbrellas = MakeUmbrellas(*mesh);
  const std::vector<float> limits = MotionLimits(centers, *mesh);
  const std::vector<Vector3f> positions = mesh->vertices;
  std::vector<double> reliefs(positions.size(), kMaxRelief / strength);
  Smoother smoother(umbrellas);
  for (int round = 0; round < kSmoothingRounds; ++round) {
    const std::vector<double> lengths =
        MeanLengths(umbrellas.neighbors, mesh->vertices);
    if (round > 0) {
      reliefs = MeasureRelief(umbrellas, lengths, *mesh);
      for (double& relief : reliefs) {
        relief =
            std::clamp(relief / strength, kMinRelief, kMaxRelief / strength);
      }
    }
    smoother.SetWeights(noises, reliefs, lengths);
    const std::vector<double>& motions =
        smoother.Minimize(positions, mesh->vertices);
    tbb::parallel_for(size_t{0}, positions.size(), [&](size_t i) {
      Vector3f& vertex = mesh->vertices[i];
      const Vector3d motion =
          (vertex - positions[i]).cast<double>() + Smoother::At(motions, i);
      const double limit = std::min<double>(limits[i], lengths[i]);
      const double share = std::min(1.0, limit / motion.norm());
      vertex = positions[i];
      if (share > 0) {
        vertex += (share * motion).cast<float>();
      }
    });
  }
  SmoothingReport report;
  for (int round = 0; round < kPutBackRounds; ++round) {
    const size_t num_put_back = PutBackIntersecting(positions, mesh);
    report.num_kept += num_put_back;
    if (num_put_back == 0) {
      break;
    }
  }
  for (size_t i = 0; i < positions.size(); ++i) {
    report.num_moved += mesh->vertices[i] != positions[i] ? 1 : 0;
  }
  return report;
}

}  // namespace colmap_ext
