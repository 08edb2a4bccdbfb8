#include "refine/vertex_motion.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include <gtest/gtest.h>
#include <Eigen/Cholesky>

#include "mesh/normals.h"
#include "raster/facet_id_buffer.h"
#include "tests/mesh/known_meshes.h"
#include "tests/threads.h"

namespace colmap_ext::normal_equations_test {

using Eigen::MatrixXd;
using Eigen::VectorXd;

// Terms at random, those of the curvatures positive definite.
PhotometricTerms RandomTerms(size_t num_facets, Random* random) {
  PhotometricTerms terms;
  for (size_t i = 0; i < num_facets; ++i) {
    FacetTerms& facet = terms.facets.emplace_back();
    const auto uniform = [&] {
      return static_cast<float>(2 * random->Unit() - 1);
    };
    facet.slopes = {uniform(), uniform(), uniform()};
    const Eigen::Matrix3f root = Eigen::Matrix3f::NullaryExpr(uniform);
    const Eigen::Matrix3f m = root * root.transpose();
    facet.curvatures = {m(0, 0), m(0, 1), m(0, 2), m(1, 1), m(1, 2), m(2, 2)};
  }
  return terms;
}

VectorXd AsVector(const std::vector<double>& values) {
  return Eigen::Map<const VectorXd>(values.data(),
                                    static_cast<Eigen::Index>(values.size()));
}

struct NormalEquationsTest : testing::Test {
  // Of as many vertices as to be solved without sparseness.
  NormalEquationsTest() : NormalEquationsTest(MakeBumpyCap(0.25f)) {}

  explicit NormalEquationsTest(TriangleMesh mesh) {
    mesh_ = std::move(mesh);
    rings_ = MakeVertexRings(mesh_);
    terms_ = RandomTerms(mesh_.facets.size(), &random_);
    SetWeight(0.1);
  }

  // Of the mesh as it is.
  void SetWeight(double weight) {
    const size_t size = mesh_.vertices.size();
    normals_ = VertexNormals(mesh_, rings_);
    domain_.footprints.assign(size, 0.05f);
    domain_.num_pixels.assign(size, 10);
    plate_ = PlateOf({weight, std::vector<double>(size, weight),
                      std::vector<double>(size, 0.003)},
                     domain_, surface_);
  }

  double NumDetermined(double tolerance, int max_iterations) const {
    return AsVector(Equations().Determined({tolerance, max_iterations})).sum();
  }

  NormalEquations Equations() const { return {surface_, domain_, plate_}; }

  Eigen::Index Size() const {
    return static_cast<Eigen::Index>(mesh_.vertices.size());
  }

  // Rows: how each vertex' residual of the smoothness changes as the vertices
  // move along their normals.
  MatrixXd Bending() const {
    MatrixXd bending = MatrixXd::Zero(Size(), Size());
    for (Eigen::Index i = 0; i < Size(); ++i) {
      bending(i, i) = -1;
      const auto ring = rings_.neighbors[i];
      for (size_t k = 0; k < ring.size(); ++k) {
        bending(i, ring[k]) =
            plate_.shares[rings_.neighbors.offsets[i] + k] *
            normals_[i].cast<double>().dot(normals_[ring[k]].cast<double>());
      }
    }
    return bending;
  }

  MatrixXd Smoothness() const {
    const MatrixXd bending = Bending();
    return bending.transpose() * AsVector(plate_.coefficients).asDiagonal() *
           bending;
  }

  // How far the corners move along their facet's normal as each one's vertex
  // does along its own.
  Eigen::Vector3d CornerMoves(size_t facet) const {
    const FacetFrame frame = ComputeFacetFrame(mesh_, mesh_.facets[facet]);
    Eigen::Vector3d moves;
    for (int k = 0; k < 3; ++k) {
      moves[k] =
          frame.normal.dot(normals_[mesh_.facets[facet][k]].cast<double>());
    }
    return moves;
  }

  MatrixXd Photometric() const {
    MatrixXd matrix = MatrixXd::Zero(Size(), Size());
    for (size_t i = 0; i < mesh_.facets.size(); ++i) {
      const auto& [aa, ab, ac, bb, bc, cc] = terms_.facets[i].curvatures;
      Eigen::Matrix3d curvatures;
      curvatures << aa, ab, ac, ab, bb, bc, ac, bc, cc;
      const Eigen::Vector3d moves = CornerMoves(i);
      for (int k = 0; k < 3; ++k) {
        for (int l = 0; l < 3; ++l) {
          matrix(mesh_.facets[i][k], mesh_.facets[i][l]) +=
              moves[k] * curvatures(k, l) * moves[l];
        }
      }
    }
    return matrix;
  }

  VectorXd Gradient() const {
    VectorXd gradient = VectorXd::Zero(Size());
    for (size_t i = 0; i < mesh_.facets.size(); ++i) {
      const Eigen::Vector3d moves = CornerMoves(i);
      for (int k = 0; k < 3; ++k) {
        gradient[mesh_.facets[i][k]] += moves[k] * terms_.facets[i].slopes[k];
      }
    }
    return gradient + Bending().transpose() *
                          AsVector(plate_.coefficients)
                              .cwiseProduct(AsVector(plate_.residuals));
  }

  Random random_{1};
  EvaluatedSurface surface_;
  SmoothnessDomain domain_;
  TriangleMesh& mesh_ = surface_.mesh;
  VertexRings& rings_ = domain_.rings;
  std::vector<Eigen::Vector3f>& normals_ = surface_.normals;
  PhotometricTerms& terms_ = surface_.terms;
  ThinPlate plate_;
};

TEST_F(NormalEquationsTest, HaveTheGradientAndDiagonalOfTheModel) {
  const NormalEquations equations = Equations();
  const VectorXd gradient = Gradient();
  const VectorXd diagonal = (Photometric() + Smoothness()).diagonal();
  EXPECT_LT((AsVector(equations.Gradient()) - gradient).norm(),
            1e-5 * gradient.norm());
  EXPECT_LT((AsVector(equations.Diagonal()) - diagonal).norm(),
            1e-5 * diagonal.norm());
}

// Of the smoothness alone, the normals and the neighbors' shares held: the
// residuals are linear then.
TEST_F(NormalEquationsTest, HaveTheGradientOfTheSmoothness) {
  for (FacetTerms& facet : terms_.facets) {
    facet.slopes = {};
  }
  const NormalEquations equations = Equations();
  const auto energy = [&](const std::vector<Eigen::Vector3d>& vertices) {
    double sum = 0;
    for (size_t i = 0; i < vertices.size(); ++i) {
      Eigen::Vector3d umbrella = Eigen::Vector3d::Zero();
      const auto ring = rings_.neighbors[i];
      for (size_t k = 0; k < ring.size(); ++k) {
        umbrella += plate_.shares[rings_.neighbors.offsets[i] + k] *
                    (vertices[ring[k]] - vertices[i]);
      }
      const double residual = normals_[i].cast<double>().dot(umbrella) - 0.003;
      sum += plate_.coefficients[i] * residual * residual / 2;
    }
    return sum;
  };
  std::vector<Eigen::Vector3d> vertices;
  for (const Eigen::Vector3f& vertex : mesh_.vertices) {
    vertices.push_back(vertex.cast<double>());
  }
  EXPECT_NEAR(energy(vertices), plate_.Energy(), 1e-5 * plate_.Energy());
  constexpr double kStep = 1e-4;
  const double scale = AsVector(equations.Gradient()).cwiseAbs().maxCoeff();
  EXPECT_GT(scale, 0);
  for (size_t i = 0; i < vertices.size(); ++i) {
    const Eigen::Vector3d at = vertices[i];
    const Eigen::Vector3d move = kStep * normals_[i].cast<double>();
    vertices[i] = at + move;
    const double above = energy(vertices);
    vertices[i] = at - move;
    const double below = energy(vertices);
    vertices[i] = at;
    EXPECT_NEAR(equations.Gradient()[i], (above - below) / (2 * kStep),
                1e-4 * scale);
  }
}

TEST_F(NormalEquationsTest, AreSolvedAsWithoutSparseness) {
  for (const double weight : {0.0, 0.001, 0.1, 10.0}) {
    SetWeight(weight);
    const MatrixXd matrix = Photometric() + Smoothness();
    const VectorXd expected = -matrix.ldlt().solve(Gradient());
    const VectorXd solution = AsVector(Equations().Solve({1e-9, 10000}));
    EXPECT_LT((solution - expected).norm(), 1e-3 * expected.norm()) << weight;
    EXPECT_LT((matrix * solution + Gradient()).norm(), 1e-4 * Gradient().norm())
        << weight;
  }
}

TEST_F(NormalEquationsTest, LeaveWhatNothingSpeaksOfWhereItIs) {
  mesh_.vertices.emplace_back(5, 5, 5);
  rings_ = MakeVertexRings(mesh_);
  SetWeight(0);
  // Terms on the first facets only.
  std::vector<bool> is_named(mesh_.vertices.size(), false);
  for (size_t i = 0; i < mesh_.facets.size(); ++i) {
    if (i < mesh_.facets.size() / 2) {
      for (const uint32_t vertex : mesh_.facets[i]) {
        is_named[vertex] = true;
      }
    } else {
      terms_.facets[i].slopes = {};
      terms_.facets[i].curvatures = {};
    }
  }
  const std::vector<double> solution = Equations().Solve({1e-6, 1000});
  size_t num_left = 0;
  for (size_t i = 0; i < solution.size(); ++i) {
    EXPECT_EQ(solution[i] != 0, is_named[i]);
    num_left += is_named[i] ? 0 : 1;
  }
  EXPECT_GT(num_left, 10);
  EXPECT_EQ(solution.back(), 0);
}

TEST_F(NormalEquationsTest, DetermineNothingWhereTheImagesSayNothing) {
  for (FacetTerms& facet : terms_.facets) {
    for (float& curvature : facet.curvatures) {
      curvature *= 1e-4f;
    }
  }
  SetWeight(10);
  const auto num_border = std::ranges::count(rings_.is_border, 1);
  EXPECT_LT(NumDetermined(1e-8, 100000), 0.3 * static_cast<double>(num_border));
}

// Without borders.
struct ClosedNormalEquationsTest : NormalEquationsTest {
  ClosedNormalEquationsTest() : NormalEquationsTest(MakeBumpySphere(0.3f)) {}
};

TEST_F(ClosedNormalEquationsTest, DetermineAllWithoutSmoothness) {
  SetWeight(1e-12);
  EXPECT_NEAR(NumDetermined(1e-6, 1000), Size(), 1e-3);
}

// MacKay's number, as the eigenvalues say; the estimate from one vector of
// signs has a variance of twice the sum of the squares beside the diagonal.
TEST_F(ClosedNormalEquationsTest, DetermineAsManyVerticesAsTheEigenvaluesSay) {
  double last = static_cast<double>(Size());
  for (const double weight : {1e-4, 1e-2, 1e-1, 1.0, 100.0}) {
    SetWeight(weight);
    const MatrixXd smoothness = Smoothness();
    const MatrixXd share =
        (Photometric() + smoothness).ldlt().solve(smoothness);
    const double expected = static_cast<double>(Size()) - share.trace();
    MatrixXd symmetric = (share + share.transpose()) / 2;
    symmetric.diagonal().setZero();
    const double deviation = std::sqrt(2 * symmetric.squaredNorm());
    EXPECT_LT(deviation, 0.1 * static_cast<double>(Size()));
    const double estimate = NumDetermined(1e-8, 10000);
    EXPECT_NEAR(estimate, expected, 3 * deviation) << weight;
    EXPECT_GE(estimate, 0);
    EXPECT_LE(estimate, Size());
    EXPECT_LT(expected, last);
    EXPECT_LT(estimate, last + 3 * deviation);
    last = expected;
  }
  EXPECT_LT(last, 0.5 * static_cast<double>(Size()));
}

// Those of one half of a surface that the images do not show.
TEST_F(ClosedNormalEquationsTest, DetermineWhatTheImagesShow) {
  std::vector<bool> is_shown(mesh_.vertices.size(), false);
  for (size_t i = 0; i < mesh_.facets.size(); ++i) {
    const bool shows = mesh_.vertices[mesh_.facets[i][0]].x() > 0;
    for (const uint32_t vertex : mesh_.facets[i]) {
      is_shown[vertex] = is_shown[vertex] || shows;
    }
    for (float& curvature : terms_.facets[i].curvatures) {
      curvature *= shows ? 1 : 1e-6f;
    }
  }
  SetWeight(1e-3);
  const std::vector<double> determined = Equations().Determined({1e-8, 100000});
  double sums[2] = {};
  double counts[2] = {};
  for (size_t i = 0; i < determined.size(); ++i) {
    sums[is_shown[i] ? 1 : 0] += determined[i];
    counts[is_shown[i] ? 1 : 0] += 1;
  }
  EXPECT_GT(sums[1], 0.8 * counts[1]);
  EXPECT_LT(sums[0], 0.3 * counts[0]);
}

struct LargeNormalEquationsTest : NormalEquationsTest {
  LargeNormalEquationsTest() : NormalEquationsTest(MakeBumpyCap(0.03f)) {}
};

TEST_F(LargeNormalEquationsTest, DoNotDependOnThreads) {
  ASSERT_GT(Size(), 2 * 4096);
  ExpectSameForAnyThreads([&] {
    const NormalEquations equations = Equations();
    return std::tuple(equations.Gradient(), equations.Diagonal(),
                      equations.Solve({0, 8}), equations.Determined({0, 8}));
  });
}

}  // namespace colmap_ext::normal_equations_test
