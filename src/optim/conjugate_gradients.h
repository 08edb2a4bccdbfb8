#pragma once

#include <cstddef>
#include <functional>
#include <numeric>
#include <vector>

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_reduce.h>

namespace colmap_ext {

// When an iterative linear solver ends.
struct SolverOptions {
  // Of the residual, in the norm of the preconditioner, relative to the first.
  double tolerance = 1e-6;

  int max_iterations = 1000;
};

// The vectors of the solver, to be kept for its next call: allocating and
// clearing millions of elements takes time.
struct SolverVectors {
  using Vector = std::vector<double>;

  Vector residual;  // before: the right-hand side
  Vector values;    // after: the solution
  Vector direction;
  Vector preconditioned;
  Vector image;  // of the direction
};

// Solves matrix * values = right-hand side by preconditioned conjugate
// gradients [Hestenes1952], from 0. Sums have one order, so that the result
// does not depend on threads if that of the callables does not.
// \param multiply  multiply(in, &out) sets out = matrix * in.
// \param precondition  precondition(residual, &out) sets out = the
//        preconditioner's inverse * residual.
// \param v  has the right-hand side; what else it has does not matter.
// \return whether it has converged; else max_iterations ended it, or rounding
// \pre the matrix is symmetric and positive semidefinite, the preconditioner's
//      inverse too; `out` has the size of the right-hand side
template <typename Multiply, typename Precondition>
bool SolveByConjugateGradients(const SolverOptions& options,
                               const Multiply& multiply,
                               const Precondition& precondition,
                               SolverVectors* v) {
  const auto dot = [](const auto& a, const auto& b) {
    return tbb::parallel_deterministic_reduce(
        tbb::blocked_range<size_t>(0, a.size(), 8192), 0.0,
        [&](const tbb::blocked_range<size_t>& range, double sum) {
          return std::inner_product(&a[range.begin()], &a[0] + range.end(),
                                    &b[range.begin()], sum);
        },
        std::plus<>());
  };
  const size_t size = v->residual.size();
  for (auto* vector :
       {&v->values, &v->direction, &v->preconditioned, &v->image}) {
    vector->resize(size);
  }
  precondition(v->residual, &v->preconditioned);
  tbb::parallel_for(size_t{0}, size, [&](size_t i) {
    v->values[i] = 0;
    v->direction[i] = v->preconditioned[i];
  });
  double product = dot(v->residual, v->preconditioned);
  const double enough = options.tolerance * options.tolerance * product;
  for (int iteration = 0;
       product > enough && iteration != options.max_iterations; ++iteration) {
    multiply(v->direction, &v->image);
    const double curvature = dot(v->direction, v->image);
    if (!(curvature > 0)) {
      break;
    }
    const double step = product / curvature;
    tbb::parallel_for(size_t{0}, size, [&](size_t i) {
      v->values[i] += step * v->direction[i];
      v->residual[i] -= step * v->image[i];
    });
    precondition(v->residual, &v->preconditioned);
    const double next = dot(v->residual, v->preconditioned);
    const double ratio = next / product;
    product = next;
    tbb::parallel_for(size_t{0}, size, [&](size_t i) {
      v->direction[i] = v->preconditioned[i] + ratio * v->direction[i];
    });
  }
  return !(product > enough);
}

}  // namespace colmap_ext
