#include "optim/conjugate_gradients.h"

#include <cmath>

#include <gtest/gtest.h>

#include "tests/random.h"
#include "tests/threads.h"

namespace colmap_ext::conjugate_gradients_test {

using Vector = std::vector<double>;

constexpr size_t kSize = 500;

double Dot(const Vector& a, const Vector& b) {
  return std::inner_product(a.begin(), a.end(), b.begin(), 0.0);
}

struct Solution {
  Vector values;
  bool is_converged;
};

// The matrix has the diagonal d_i + 2 and -1 beside it.
struct ConjugateGradientsTest : testing::Test {
  ConjugateGradientsTest() {
    Random random(1);
    for (size_t i = 0; i < kSize; ++i) {
      diagonal_.push_back(2 + (i % 5 == 0 ? 100 * random.Unit() : 1e-3));
      right_hand_side_.push_back(2 * random.Unit() - 1);
    }
  }

  Vector Product(const Vector& in) const {
    Vector out(in.size());
    for (size_t i = 0; i < in.size(); ++i) {
      out[i] = diagonal_[i] * in[i] - (i > 0 ? in[i - 1] : 0) -
               (i + 1 < in.size() ? in[i + 1] : 0);
    }
    return out;
  }

  // \param vectors  of any other solution before
  Solution Solve(const SolverOptions& options,
                 SolverVectors vectors = {}) const {
    vectors.residual = right_hand_side_;
    const bool is_converged = SolveByConjugateGradients(
        options, [&](const Vector& in, Vector* out) { *out = Product(in); },
        [&](const Vector& in, Vector* out) { *out = Precondition(in); },
        &vectors);
    return {vectors.values, is_converged};
  }

  Vector Precondition(const Vector& residual) const {
    Vector out = residual;
    for (size_t i = 0; i < out.size(); ++i) {
      out[i] /= diagonal_[i];
    }
    return out;
  }

  // In the norm of the preconditioner, relative to that of 0.
  double RelativeResidual(const Vector& values) const {
    Vector residual = Product(values);
    for (size_t i = 0; i < residual.size(); ++i) {
      residual[i] -= right_hand_side_[i];
    }
    return std::sqrt(Dot(residual, Precondition(residual)) /
                     Dot(right_hand_side_, Precondition(right_hand_side_)));
  }

  Vector diagonal_;
  Vector right_hand_side_;
};

TEST_F(ConjugateGradientsTest, StopsAtTheToleranceOrAfterTheIterations) {
  for (const double tolerance : {0.3, 0.03, 1e-3, 1e-9}) {
    const Solution solution = Solve({tolerance, 10000});
    EXPECT_TRUE(solution.is_converged);
    const double residual = RelativeResidual(solution.values);
    EXPECT_LT(residual, 1.01 * tolerance);
    EXPECT_GT(residual, 0.01 * tolerance);
  }
  EXPECT_EQ(Solve({0.1, 0}).values, Vector(kSize, 0));
  EXPECT_FALSE(Solve({0.1, 0}).is_converged);
  EXPECT_FALSE(Solve({1e-9, 3}).is_converged);
}

// Each iteration lowers 1/2 x A x - b x.
TEST_F(ConjugateGradientsTest, EveryIterationLowersTheModel) {
  double last = 0;
  for (int iterations = 1; iterations <= 16; ++iterations) {
    const Vector x = Solve({0, iterations}).values;
    const double model = 0.5 * Dot(x, Product(x)) - Dot(right_hand_side_, x);
    EXPECT_LT(model, last);
    last = model;
  }
}

TEST_F(ConjugateGradientsTest, NothingToSolveIsSolved) {
  right_hand_side_.assign(kSize, 0);
  const Solution solution = Solve({});
  EXPECT_TRUE(solution.is_converged);
  EXPECT_EQ(solution.values, right_hand_side_);
}

// Directions without curvature end the iterations.
TEST_F(ConjugateGradientsTest, DoesNotConvergeWhereTheMatrixIsSingular) {
  const auto identity = [](const Vector& in, Vector* out) { *out = in; };
  SolverVectors vectors;
  vectors.residual = {1, 1};
  EXPECT_FALSE(SolveByConjugateGradients(
      {},
      [](const Vector& in, Vector* out) {
        *out = {in[0] - in[1], in[1] - in[0]};
      },
      identity, &vectors));
  EXPECT_EQ(vectors.values, Vector(2, 0));
}

TEST_F(ConjugateGradientsTest, DoesNotDependOnTheVectorsBefore) {
  const Vector used(2 * kSize, 7);
  EXPECT_EQ(Solve({1e-9}, {used, used, used, used, used}).values,
            Solve({1e-9}).values);
}

TEST_F(ConjugateGradientsTest, DoesNotDependOnThreads) {
  ExpectSameForAnyThreads([&] { return Solve({0, 8}).values; });
}

}  // namespace colmap_ext::conjugate_gradients_test
