#pragma once

#include <memory>
#include <vector>

#include "photometry/image_pyramid.h"
#include "tests/synthetic/dense_scene.h"

namespace colmap_ext {

// A small dense scene with photographs in grey, as the refinement takes it.
struct RefinementScene {
  synthetic::DenseScene dense;
  std::vector<GrayImage> images;  // [views]

  const TriangleMesh& Truth() const { return dense.scene.surface; }
  const std::vector<View>& Views() const { return dense.scene.views; }

  // Of the scene's images, which it has to outlive.
  std::shared_ptr<ImagePyramid> Pyramid(size_t max_memory = SIZE_MAX) const;
};

RefinementScene MakeRefinementScene(
    const synthetic::DenseSceneOptions& options);

// A statue, 8 views of 160 x 120.
RefinementScene MakeRefinementScene();

}  // namespace colmap_ext
