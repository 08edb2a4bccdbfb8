#include "refine/normal_equations.h"

#include <algorithm>
#include <functional>
#include <utility>

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include "base/mix_bits.h"
#include "raster/facet_frames.h"

namespace colmap_ext {
namespace {

// Where corners k <= l of a facet stand in its curvatures.
int CurvatureIndex(int k, int l) {
  constexpr int kIndex[3][3] = {{0, 1, 2}, {1, 3, 4}, {2, 4, 5}};
  return kIndex[k][l];
}

// 1 or -1.
double RandomSign(uint64_t index) {
  return (MixBits(index + kSplitMixStep) >> 63) != 0 ? 1 : -1;
}

}  // namespace

NormalEquations::NormalEquations(const TriangleMesh& mesh,
                                 const std::vector<Eigen::Vector3f>& normals,
                                 const VertexRings& rings,
                                 const PhotometricTerms& terms,
                                 const ThinPlate& plate, FixedVertices fixed)
    : normals_(normals),
      rings_(rings),
      plate_(plate),
      fixed_(std::move(fixed)) {
  AddPhotometric(mesh, terms);
  FindSmoothnessChanges();
  AddSmoothness();
  ClearFixed(&gradient_);
}

void NormalEquations::ClearFixed(std::vector<double>* values) const {
  for (uint32_t i = 0; i < fixed_.size(); ++i) {
    if (IsFixed(fixed_, i)) {
      (*values)[i] = 0;
    }
  }
}

void NormalEquations::AddPhotometric(const TriangleMesh& mesh,
                                     const PhotometricTerms& terms) {
  const size_t size = mesh.vertices.size();
  gradient_.assign(size, 0);
  photometric_diagonal_.assign(size, 0);
  photometric_.assign(rings_.neighbors.values.size(), 0);
  const std::vector<FacetFrame> frames = ComputeFacetFrames(mesh);
  tbb::parallel_for(size_t{0}, size, [&](size_t vertex) {
    const auto ring = rings_.neighbors[vertex];
    const size_t row = rings_.neighbors.offsets[vertex];
    const Eigen::Vector3d normal = normals_[vertex].cast<double>();
    for (const uint32_t corner : rings_.corners[vertex]) {
      const uint32_t facet = corner / 3;
      const int k = static_cast<int>(corner % 3);
      // How far the facet moves along its normal as its corners do.
      const Eigen::Vector3d& facet_normal = frames[facet].normal;
      const double along = facet_normal.dot(normal);
      gradient_[vertex] += terms.facets[facet].slopes[k] * along;
      photometric_diagonal_[vertex] +=
          terms.facets[facet].curvatures[CurvatureIndex(k, k)] * along * along;
      for (int l = 0; l < 3; ++l) {
        const uint32_t other = mesh.facets[facet][l];
        if (l == k) {
          continue;
        }
        const size_t place =
            row + (std::ranges::lower_bound(ring, other) - ring.begin());
        photometric_[place] += static_cast<float>(
            terms.facets[facet].curvatures[CurvatureIndex(k, l)] * along *
            facet_normal.dot(normals_[other].cast<double>()));
      }
    }
  });
}

// The residuals are N_V . (weighted mean of the neighbors - V); their changes
// are taken with the normals and the shares held.
void NormalEquations::FindSmoothnessChanges() {
  outgoing_.resize(rings_.neighbors.values.size());
  incoming_.resize(rings_.neighbors.values.size());
  tbb::parallel_for(size_t{0}, gradient_.size(), [&](size_t vertex) {
    const auto ring = rings_.neighbors[vertex];
    const size_t row = rings_.neighbors.offsets[vertex];
    for (size_t i = 0; i < ring.size(); ++i) {
      const auto other_ring = rings_.neighbors[ring[i]];
      const size_t back =
          rings_.neighbors.offsets[ring[i]] +
          (std::ranges::lower_bound(other_ring, vertex) - other_ring.begin());
      const float cosine = normals_[vertex].dot(normals_[ring[i]]);
      outgoing_[row + i] = plate_.shares[row + i] * cosine;
      incoming_[row + i] = plate_.shares[back] * cosine;
    }
  });
}

void NormalEquations::AddSmoothness() {
  diagonal_ = photometric_diagonal_;
  tbb::parallel_for(size_t{0}, gradient_.size(), [&](size_t vertex) {
    double gradient = -plate_.coefficients[vertex] * plate_.residuals[vertex];
    double diagonal = plate_.coefficients[vertex];
    const auto ring = rings_.neighbors[vertex];
    const size_t row = rings_.neighbors.offsets[vertex];
    for (size_t i = 0; i < ring.size(); ++i) {
      const uint32_t other = ring[i];
      const double share = incoming_[row + i];
      gradient += plate_.coefficients[other] * plate_.residuals[other] * share;
      diagonal += plate_.coefficients[other] * share * share;
    }
    gradient_[vertex] += gradient;
    diagonal_[vertex] += diagonal;
  });
}

void NormalEquations::Multiply(const std::vector<double>& in,
                               bool is_smoothness_only,
                               std::vector<double>* out) const {
  std::vector<double> weighted_changes(in.size());
  const double share = is_smoothness_only ? 0 : 1;
  const tbb::blocked_range<size_t> all(0, in.size(), 4096);
  tbb::parallel_for(all, [&](const tbb::blocked_range<size_t>& range) {
    for (size_t i = range.begin(); i != range.end(); ++i) {
      const auto ring = rings_.neighbors[i];
      const size_t row = rings_.neighbors.offsets[i];
      double photometric = photometric_diagonal_[i] * in[i];
      double mean = 0;
      for (size_t k = 0; k < ring.size(); ++k) {
        photometric += photometric_[row + k] * in[ring[k]];
        mean += outgoing_[row + k] * in[ring[k]];
      }
      (*out)[i] = share * photometric;
      weighted_changes[i] = plate_.coefficients[i] * (mean - in[i]);
    }
  });
  tbb::parallel_for(all, [&](const tbb::blocked_range<size_t>& range) {
    for (size_t i = range.begin(); i != range.end(); ++i) {
      const auto ring = rings_.neighbors[i];
      const size_t row = rings_.neighbors.offsets[i];
      double sum = -weighted_changes[i];
      for (size_t k = 0; k < ring.size(); ++k) {
        sum += incoming_[row + k] * weighted_changes[ring[k]];
      }
      (*out)[i] += sum;
    }
  });
  ClearFixed(out);
}

LinearSolution NormalEquations::Solve(const SolverOptions& options) const {
  std::vector<double> descent(gradient_.size());
  std::ranges::transform(gradient_, descent.begin(), std::negate());
  return Solve(std::move(descent), options);
}

LinearSolution NormalEquations::Determined(const SolverOptions& options) const {
  std::vector<double> signs(gradient_.size());
  for (size_t i = 0; i < signs.size(); ++i) {
    signs[i] = RandomSign(i);
  }
  ClearFixed(&signs);
  std::vector<double> image(signs.size());
  Multiply(signs, true, &image);
  LinearSolution determined = Solve(std::move(image), options);
  for (size_t i = 0; i < signs.size(); ++i) {
    determined.values[i] =
        plate_.coefficients[i] > 0 ? 1 - signs[i] * determined.values[i] : 0.0;
  }
  ClearFixed(&determined.values);
  return determined;
}

LinearSolution NormalEquations::Solve(std::vector<double> right_hand_side,
                                      const SolverOptions& options) const {
  using Vector = std::vector<double>;
  return SolveByConjugateGradients(
      options, std::move(right_hand_side),
      [&](const Vector& in, Vector* out) { Multiply(in, false, out); },
      [&](const Vector& residual, Vector* out) {
        tbb::parallel_for(size_t{0}, residual.size(), [&](size_t i) {
          (*out)[i] = diagonal_[i] > 0 ? residual[i] / diagonal_[i] : 0.0;
        });
      });
}

}  // namespace colmap_ext
