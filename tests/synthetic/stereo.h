#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "tests/synthetic/render.h"
#include "tests/synthetic/scene.h"

namespace colmap_ext::synthetic {

struct StereoOptions {
  // Deviation of a match in another image, px. It becomes an error of the depth
  // through the baselines to all images that see the point.
  double noise = 0.5;

  // Share of the error's variance that neighboring pixels have in common.
  double correlated_share = 0.9;

  // Deviation of the normals, degrees.
  double normal_noise = 4.0;

  // Smallest number of other images that have to see a point.
  int min_num_sources = 2;

  // Largest angle between a ray and the surface's normal, degrees.
  double max_incidence = 75.0;

  // Largest angle between the rays of two images that are matched, degrees.
  double max_triangulation_angle = 60.0;

  // Share of the pixels without depth, in patches, though all is seen.
  double dropout = 0.04;

  // Maximum growth of the foreground over the background at silhouettes, px.
  double fattening = 5.0;

  // Returns what is wrong with the options, in one line; empty if nothing is.
  std::string Check() const;
};

// The result of multi-view stereo for one image, in COLMAP's form: pixel
// (row, col) stands for the ray through (col, row) of COLMAP's convention, not
// (col + 0.5, row + 0.5).
struct DepthMap : colmap_ext::DepthMap {
  std::vector<Eigen::Vector3f> normals;  // [height * width], world frame, unit
};

// Simulates COLMAP's patch_match_stereo on one view. The content of a pixel is
// seen by its center, but COLMAP attributes it to the pixel's upper left
// corner, in this image and in all others. The depth is the one that fits those
// shifted observations best, in least squares; noise is added to it. Surface
// without texture gets holes and more noise; images with different highlights
// are not matched; windows with a silhouette match the foreground. \param
// visible of all views
DepthMap SimulateStereo(const Scene& scene, const std::vector<Visible>& visible,
                        size_t view, const StereoOptions& options,
                        uint64_t seed);

}  // namespace colmap_ext::synthetic
