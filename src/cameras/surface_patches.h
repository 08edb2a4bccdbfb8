#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "base/rows.h"
#include "labeling/facet_labels.h"
#include "photometry/image_pyramid.h"
#include "photometry/photometric_energy.h"
#include "raster/facet_frames.h"
#include "raster/visibility_buffers.h"

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
  // Views that a patch is compared with, at most.
  int max_partners = 6;
};

// A mesh drawn into views of one level, and their images. References are kept.
struct DrawnScene {
  const VisibilityBuffers& buffers;       // their views: as they were drawn
  const std::vector<FacetFrame>& frames;  // [F] of the mesh
  ImagePyramid* images;                   // at the level
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

}  // namespace colmap_ext
