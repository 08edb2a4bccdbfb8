#pragma once

#include <vector>

#include <Eigen/Core>

#include "mesh/adjacency.h"
#include "mesh/surface.h"
#include "mesh/triangle_mesh.h"
#include "optim/conjugate_gradients.h"
#include "refine/smoothness_model.h"
#include "spatial/facet_tree.h"

namespace colmap_ext {

// When the conjugate gradients end. Early: the steps are limited anyway, and a
// later iteration makes up for what an earlier one leaves. Found by trial;
// tests/benchmarks/vary_constants.py tables what other values do.
inline constexpr double kSolverTolerance = 0.03;
inline constexpr SolverOptions kEarlyEnd{kSolverTolerance, 100};

// Gauss-Newton's quadratic model of the photometric energy and the smoothness,
// in how far each vertex moves along its normal (docs/method.md, section 6.3).
class NormalEquations {
 public:
  // \param surface, domain, plate  of the same mesh; references are kept. Fixed
  //        vertices are Dirichlet constraints.
  NormalEquations(const EvaluatedSurface& surface,
                  const SmoothnessDomain& domain, const ThinPlate& plate);

  // The gradient, [V], 1 / scene unit.
  const std::vector<double>& Gradient() const { return gradient_; }

  // The diagonal, [V], 1 / scene unit^2.
  const std::vector<double>& Diagonal() const { return diagonal_; }

  // The minimum of the model, [V] scene units, by conjugate gradients,
  // preconditioned by the diagonal. 0 where nothing says anything.
  std::vector<double> Solve(const SolverOptions& options = kEarlyEnd) const;

  // The effective degrees of freedom: how far the images, rather than the
  // smoothness, determine where each vertex is: [V]. Their sum estimates how
  // many vertices the images determine [MacKay1992]: the trace of matrix^-1
  // times the photometric part of the matrix, from one vector of random signs
  // [Hutchinson1990]. Each by itself estimates its element of the diagonal,
  // with much noise. 0 where a vertex has no smoothness. It needs a more exact
  // solution than a step does: on planes the images determine next to nothing.
  std::vector<double> Determined(const SolverOptions& options = {
                                     kSolverTolerance / 3, 300}) const;

 private:
  void AddPhotometric();
  void FindSmoothnessChanges();
  void AddSmoothness();

  // out = matrix * in, all [V]; of the photometric part alone where
  // `is_photometric_only`.
  void Multiply(const std::vector<double>& in, bool is_photometric_only,
                std::vector<double>* out) const;

  // matrix^-1 * right_hand_side
  std::vector<double> Solve(std::vector<double> right_hand_side,
                            const SolverOptions& options) const;

  // Sets the values of fixed vertices to 0.
  void ClearFixed(std::vector<double>* values) const;

  const EvaluatedSurface& surface_;
  const SmoothnessDomain& domain_;
  const ThinPlate& plate_;
  std::vector<double> gradient_;
  std::vector<double> diagonal_;
  std::vector<double> photometric_diagonal_;

  // Aligned with the rings' neighbors.values. The photometric second derivative
  // by the vertex and the neighbor; the change of the vertex's smoothness
  // residual as the neighbor moves; and that of the neighbor's as the vertex
  // moves.
  std::vector<float> photometric_;
  std::vector<float> outgoing_;
  std::vector<float> incoming_;

  mutable std::vector<double> weighted_changes_;  // [V] scratch of Multiply()
};

// Limits each vertex's motion along its normal to 0.4 times the mean length of
// its edges (with less than half of it no two neighbors can pass each other)
// and to the footprint of a pixel.
// \param footprints  [V] scene units
// \param motion  [V] scene units
void LimitMotion(const TriangleMesh& mesh, const VertexRings& rings,
                 const std::vector<float>& footprints,
                 std::vector<double>* motion);

struct MovedMesh {
  TriangleMesh mesh;
  std::vector<double> motion;  // [V] along the normals, scene units
};

// Moves the vertices along their normals. Those of facets that would turn by
// more than 60 degrees, or that would intersect (FindSelfIntersections) and do
// not so far, go half as far, up to four times, then not at all. So the result
// has no self-intersection that the mesh does not have.
// \param rings  MakeVertexRings(mesh)
// \param normals  [V] unit
// \param motion  [V] scene units
// \param tree  of the mesh's facets; its boxes change
MovedMesh MoveSafely(const TriangleMesh& mesh, const VertexRings& rings,
                     const std::vector<Eigen::Vector3f>& normals,
                     std::vector<double> motion, FacetTree* tree);

// The mean of the motion of the vertices that may move, px.
double MeanMotion(const std::vector<double>& motion,
                  const std::vector<float>& footprints,
                  const FixedVertices& fixed = {});

}  // namespace colmap_ext
