#pragma once

#include <cstddef>
#include <vector>

#include <Eigen/Core>

#include "mesh/triangle_mesh.h"
#include "mesh/vertex_rings.h"
#include "photometry/photometric_energy.h"
#include "refine/thin_plate.h"

namespace colmap_ext {

// Gauss-Newton's quadratic model of the photometric energy and the smoothness,
// in how far each vertex moves along its normal.
class NormalEquations {
 public:
  // \param mesh, normals, rings, terms, plate  of the same mesh.
  NormalEquations(const TriangleMesh& mesh,
                  const std::vector<Eigen::Vector3f>& normals,
                  const VertexRings& rings, const PhotometricTerms& terms,
                  const ThinPlate& plate);

  // The gradient, [V], 1 / scene unit.
  const std::vector<double>& Gradient() const { return gradient_; }

  // The diagonal, [V], 1 / scene unit^2.
  const std::vector<double>& Diagonal() const { return diagonal_; }

  // The minimum of the model by conjugate gradients, preconditioned by the
  // diagonal, until the residual is `tolerance` of the gradient: [V] scene
  // units. Where nothing says anything, 0.
  std::vector<double> Solve(double tolerance, int max_iterations) const;

  // How far the images determine each of the smoothness' residuals, rather than
  // the smoothness itself: [V]. Their sum estimates how many are determined
  // (MacKay 1992): their number minus the trace of matrix^-1 times the
  // smoothness' part of the matrix, from one vector of random signs (Hutchinson
  // 1990); each by itself estimates its element of the diagonal, with much
  // noise. 0 for vertices that the smoothness says nothing of, at borders:
  // nothing is learned of its weight from them.
  std::vector<double> Determined(double tolerance, int max_iterations) const;

 private:
  void AddPhotometric(const TriangleMesh& mesh, const PhotometricTerms& terms);
  void AddSmoothness();

  // out = matrix * in, all [V]; of the smoothness' part alone where
  // `is_smoothness_only`.
  void Multiply(const std::vector<double>& in, bool is_smoothness_only,
                std::vector<double>* out) const;

  // matrix^-1 * right_hand_side
  std::vector<double> Solve(std::vector<double> right_hand_side,
                            double tolerance, int max_iterations) const;

  const std::vector<Eigen::Vector3f>& normals_;
  const VertexRings& rings_;
  const ThinPlate& plate_;
  std::vector<double> gradient_;
  std::vector<double> diagonal_;
  std::vector<double> photometric_diagonal_;
  // Aligned with rings_.neighbors: the photometric second derivatives by the
  // vertex and the neighbor, and by how much the one's residual of the
  // smoothness changes as the other moves: the vertex's as the neighbor does,
  // and the neighbor's as the vertex does.
  std::vector<float> photometric_;
  std::vector<float> outgoing_;
  std::vector<float> incoming_;
};

}  // namespace colmap_ext
