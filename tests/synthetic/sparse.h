#pragma once

#include <cstdint>
#include <vector>

#include <Eigen/Core>

#include "scene/point_cloud.h"
#include "tests/synthetic/render.h"
#include "tests/synthetic/scene.h"

namespace colmap_ext::synthetic {

struct SparseOptions {
  // The number of points that are tried; fewer are seen often enough.
  int num_points = 3000;

  // Deviation of a feature's position, px.
  double noise = 0.4;

  // The share of the views that see a point whose features are matched.
  double match_share = 0.8;
};

struct Feature {
  uint32_t view;
  Eigen::Vector2d position;  // pixel coordinates in COLMAP's convention
};

struct SparsePoint {
  Eigen::Vector3d position;    // world frame, triangulated from the features
  Color color{};               // black where there are no images
  double error = 0;            // mean reprojection error, px
  std::vector<Feature> track;  // one for each view, three or more
};

// Points of the true surface with tracks of features, as structure from motion
// leaves them: without the half pixel of the depth maps.
// \param images of all views, or empty
std::vector<SparsePoint> MakeSparsePoints(const Scene& scene,
                                          const std::vector<Visible>& visible,
                                          const std::vector<ColorImage>& images,
                                          const SparseOptions& options,
                                          uint64_t seed);

}  // namespace colmap_ext::synthetic
