#pragma once

#include <array>
#include <cstddef>
#include <memory>
#include <string>
#include <vector>

#include "labeling/view_pairs.h"
#include "mesh/triangle_mesh.h"
#include "photometry/image_pyramid.h"
#include "raster/visibility_buffers.h"
#include "scene/view.h"

namespace colmap_ext {

struct PhotometricOptions {
  // Pixels of a correlation window to each side of its centre: 2 is 5 x 5, as
  // [Romanoni2020, section II-A]. From 1 to 7, a choice.
  int window_radius = 2;

  // Variance of the images' noise, grey values (0 ... 255) squared. A window
  // whose variance equals it has the weight 1/2. Positive.
  double noise_variance = 2;

  // Share of a window's variance that stays unexplained at best, r of
  // docs/method.md, section 5.1. The smaller, the more those windows count that
  // match well; with a large one all count alike, which is the energy of
  // [Romanoni2020, section II-A, equation (1)]. Positive. What it does:
  // docs/experiments.md, rows "energy -ZNCC".
  double residual_floor = 0.05;

  // Leave pixels out of a window that lie across a depth discontinuity from
  // its centre.
  bool occlusion_masking = true;

  // A facet is compared in an image only where the cosine between its normal
  // and the ray to the camera is above this: 0.1 is 84 degrees. In [0, 1).
  double min_cosine = 0.1;
};

// Sums over the pixels that show a facet, of one direction of a pair or of all.
struct FacetTerms {
  float energy = 0;
  float weight = 0;      // sum of w
  float num_pixels = 0;  // that are compared

  // For each corner k, the derivative of E by the distance that the corner
  // moves along the facet's unit normal (docs/method.md, section 5.5). 1 /
  // scene unit.
  std::array<float, 3> slopes{};

  // Gauss-Newton's second derivatives by two of these distances, corners 00,
  // 01, 02, 11, 12, 22; positive semidefinite. 1 / scene unit^2.
  std::array<float, 6> curvatures{};

  bool operator==(const FacetTerms&) const = default;
};

// The photometric energy of a mesh under a labelling of its facets
// (docs/method.md, section 5.1),
//
//   E = sum over pairs {i, j}, over their directions, both or one
//       (FacetLabels::directions), over the pixels x of image i that show a
//       facet labelled with the pair and compared in the direction
//       of w(x) c(ZNCC(I_i, I_ij; window of x)),   c(Z) = s log(1 - Z / s),
//
// I_ij being the image I_j seen from i by way of the surface, w = m / (m +
// noise_variance), m the smaller of the window's two variances, and s = 1 +
// residual_floor. [Romanoni2020] has c(Z) = -Z. Sums are kept facet by facet,
// so that the caller can gather them for vertices.
struct PhotometricTerms {
  double energy = 0;               // the sum of the facets'
  std::vector<FacetTerms> facets;  // [F] zeros where not seen or not labelled

  bool operator==(const PhotometricTerms&) const = default;
};

// The mean correlation of the pixels that have the given sums of energies and
// weights, by their weights: the inverse of the energy's logarithm, of the mean
// (docs/method.md, section 5.1). 0 without weight.
double MeanZncc(double energy, double weight,
                const PhotometricOptions& options);

// Evaluates the energy at one level of the images' pyramids.
class PhotometricEnergy {
 public:
  virtual ~PhotometricEnergy() = default;

  // The level that the images are to be used at.
  virtual void SetLevel(int level) = 0;

  // Other cameras of the same pictures, of their full size. What was drawn is
  // forgotten: Render() has to be called before Evaluate().
  virtual void SetViews(std::vector<View> views) = 0;

  // The mesh drawn by the processor into the views of the level, for others to
  // use. A Render() of the same mesh takes these buffers over if it draws
  // alike. Render() has to be called before Evaluate() then.
  virtual std::shared_ptr<const VisibilityBuffers> Visibility(
      const TriangleMesh& mesh) = 0;

  // Draws the mesh into every view. Until the next call, visibility, facing and
  // depths are taken from this mesh, so that the energy of a moved mesh is
  // differentiable.
  virtual void Render(const TriangleMesh& mesh) = 0;

  // \pre Render() was called with a mesh of the same facets, at this level.
  virtual PhotometricTerms Evaluate(const TriangleMesh& mesh,
                                    const FacetLabels& labels) = 0;

  // What computes it, for the log: "CPU, 2 threads".
  virtual std::string Description() const = 0;
};

// The energy by the processor alone, in parallel over the pairs' directions.
// Results do not depend on the number of threads.
//
// \param max_memory  of the visibility buffers that are kept, bytes; others are
//        drawn again when they are needed.
// \pre options in their ranges
std::unique_ptr<PhotometricEnergy> MakeCpuPhotometricEnergy(
    const PhotometricOptions& options, std::shared_ptr<ImagePyramid> images,
    size_t max_memory);

}  // namespace colmap_ext
