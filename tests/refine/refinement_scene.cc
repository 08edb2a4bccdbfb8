#include "tests/refine/refinement_scene.h"

namespace colmap_ext {

std::shared_ptr<ImagePyramid> RefinementScene::Pyramid(
    size_t max_memory) const {
  return std::make_shared<ImagePyramid>(
      Views(), [this](size_t view) { return images[view]; }, max_memory);
}

RefinementScene MakeRefinementScene(
    const synthetic::DenseSceneOptions& options) {
  RefinementScene scene{synthetic::MakeDenseScene(options), {}};
  for (const ColorImage& color : scene.dense.images) {
    GrayImage gray{color.width, color.height, {}};
    for (const Color& pixel : color.pixels) {
      gray.pixels.push_back(static_cast<uint8_t>(
          (299 * pixel[0] + 587 * pixel[1] + 114 * pixel[2] + 500) / 1000));
    }
    scene.images.push_back(std::move(gray));
  }
  return scene;
}

RefinementScene MakeRefinementScene() {
  synthetic::DenseSceneOptions options;
  options.scene.num_images = 8;
  options.scene.width = 160;
  options.scene.height = 120;
  return MakeRefinementScene(options);
}

}  // namespace colmap_ext
