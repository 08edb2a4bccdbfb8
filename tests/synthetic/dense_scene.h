#pragma once

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

  // Whether the photographs are made; without them points have no colours.
  bool render_images = true;

  // Whether the depth maps of the stereo are kept.
  bool keep_depth_maps = false;

  // Whether what the pixels' centres see is kept.
  bool keep_true_depths = true;

  // What is wrong with the options, in one line; empty when all is well.
  std::string Check() const;
};

// A dense workspace in memory: `scene.surface` is the truth, `model_views` and
// `fused.cloud` are what a mesher takes.
struct DenseScene {
  Scene scene;
  std::vector<View> model_views;     // scene.views, or disturbed ones
  std::vector<ColorImage> images;    // [views] or empty
  std::vector<DepthMap> depth_maps;  // [views] or empty
  std::vector<Visible> visible;      // [views] or empty, the truth
  FusedPoints fused;
  std::vector<SparsePoint> sparse_points;
};

// Same options, same bytes, whatever the number of threads.
// \throw std::invalid_argument for options that do not check.
DenseScene MakeDenseScene(const DenseSceneOptions& options);

}  // namespace colmap_ext::synthetic
