#pragma once

#include <string>
#include <vector>

#include "tests/synthetic/fuse.h"
#include "tests/synthetic/pose_noise.h"
#include "tests/synthetic/render.h"
#include "tests/synthetic/scene.h"
#include "tests/synthetic/sparse.h"
#include "tests/synthetic/stereo.h"

namespace colmap_ext::synthetic {

struct DenseSceneOptions {
  SceneOptions scene;
  RenderOptions render;
  StereoOptions stereo;
  FusionOptions fusion;
  SparseOptions sparse;
  PoseNoiseOptions pose_noise;

  // Whether images are rendered; without them points have no colors.
  bool render_images = true;

  // Whether the depth maps of the stereo are kept.
  bool keep_depth_maps = false;

  // Whether the true depths at the pixel centers are kept.
  bool keep_true_depths = true;

  // Returns what is wrong with the options, in one line; empty if nothing is.
  std::string Check() const;
};

// A dense workspace in memory: `scene.surface` is the truth, `model_views` and
// `fused.cloud` are the input of a mesher.
struct DenseScene {
  Scene scene;
  std::vector<View> model_views;     // scene.views, or disturbed ones
  std::vector<ColorImage> images;    // [views] or empty
  std::vector<DepthMap> depth_maps;  // [views] or empty
  std::vector<Visible> visible;      // [views] or empty, the truth
  FusedPoints fused;
  std::vector<SparsePoint> sparse_points;
};

// The same options give the same bytes for any number of threads.
// \throw std::invalid_argument for options that do not check.
DenseScene MakeDenseScene(const DenseSceneOptions& options);

// Returns copies of a scene side by side, each seen by its own views, whose
// names begin with the number of the copy. Without depth maps and true depths.
// \param offset  between neighbors, scene units
DenseScene MakeSceneRow(const DenseScene& scene, int num_copies,
                        const Eigen::Vector3d& offset);

}  // namespace colmap_ext::synthetic
