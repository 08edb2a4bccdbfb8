#pragma once

#include <cstdint>
#include <vector>

#include <Eigen/Core>

#include "base/rows.h"
#include "labeling/view_pairs.h"
#include "photometry/image_pyramid.h"
#include "photometry/pair_warp.h"
#include "photometry/photometric_energy.h"
#include "raster/visibility_buffers.h"
#include "scene/view.h"

namespace colmap_ext {

// A piece of the surface around what a pixel of a view shows.
struct SurfacePatch {
  uint32_t view = 0;
  int row = 0;  // of the pixel
  int col = 0;
  uint32_t facet = 0;               // that the pixel shows
  Eigen::Vector3d normal{0, 0, 0};  // of the facet, unit, world
  double footprint = 0;             // of the pixel, scene units
  double displacement = 0;          // of the patch along its normal, footprints
};

struct SurfacePatches {
  std::vector<SurfacePatch> patches;  // by their views
  Rows<uint32_t> partners;            // [patches] views it is compared with
};

// Where images are compared to refine their cameras.
struct PatchOptions {
  // Pixels of a window to each side of its centre.
  int radius = 5;
  // Cells of a grid over each image, of which each may give a patch. About.
  int max_patches_per_view = 500;
  // About as many patches in all, shared out over the views; but each view may
  // have min_patches_per_view. A choice: each has so many partners that fewer
  // determine a pose well.
  int max_patches = 25600;
  int min_patches_per_view = 100;
  // Views that a patch is compared with, at most.
  int max_partners = 6;
};

// A mesh drawn into views of one level, and their images. References are kept.
struct DrawnScene {
  const VisibilityBuffers& buffers;  // their views: as they were drawn
  ImagePyramid* images;              // at the level

  FacetFrame FrameOf(uint32_t facet) const {
    return ComputeFacetFrame(buffers.Mesh(), buffers.Mesh().facets[facet]);
  }
};

// Chooses in each cell of a grid over each view the window with the most
// texture, by the smaller eigenvalue of its gradients' covariance
// [ShiTomasi1994], of those that show one surface. A window with less of it
// than the noise gives none. Its partners are views paired with the view that
// see the same facet unoccluded, neither much smaller nor much larger, from
// directions that are evenly spread.
// \param pairs  views that may be compared.
SurfacePatches SelectPatches(const PatchOptions& options,
                             const PhotometricOptions& photometric,
                             const DrawnScene& scene,
                             const std::vector<ViewPair>& pairs);

// How well a window of image i matches image j by way of the surface, and how
// that changes as the window shifts in j. With n the window's values without
// their mean, of unit length, the residuals are n_j - n_i, so that half of
// their squared norm is 1 - ZNCC; G their derivative by the shift, [N][2].
struct WindowShift {
  bool is_valid = false;
  int num_pixels = 0;  // N, not masked
  double zncc = 0;
  Eigen::Vector2d slope;      // G^T r: the derivative of 1 - ZNCC, 1 / px
  Eigen::Matrix2d curvature;  // G^T G, Gauss-Newton's second one, 1 / px^2
};

// The point on the displaced patch that its pixel shows.
// \param frame  of its facet
Eigen::Vector3d PatchPoint(const View& view, const FacetFrame& frame,
                           const SurfacePatch& patch);

// Compares the window of a patch. Pixels of i are masked as the energy masks
// them (photometry/pair_warp.h): they have to show the centre's surface, must
// not be saturated, and j has to see their points. The window is valid if more
// than half of it is left, with more variance than nothing in both.
// \param i, j  the cameras as they are now, and the surface as it was drawn.
WindowShift CompareWindow(const PhotometricOptions& options, int radius,
                          const DrawnView& i, const DrawnView& j,
                          const SurfacePatch& patch);

// Compares each patch with each of its partners (CompareWindow()).
// \param radius  of the windows, px
// \param views  the cameras as they are now
// \return [values of patches.partners]
std::vector<WindowShift> ComparePatches(const PhotometricOptions& photometric,
                                        int radius, const DrawnScene& scene,
                                        const std::vector<View>& views,
                                        const SurfacePatches& patches);

}  // namespace colmap_ext
