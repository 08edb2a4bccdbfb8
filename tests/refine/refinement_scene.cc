#include "tests/refine/refinement_scene.h"

#include <algorithm>
#include <functional>
#include <numeric>
#include <random>
#include <span>
#include <utility>

#include "raster/facet_frames.h"
#include "tests/raster/room.h"

namespace colmap_ext {

namespace {

// The smaller one of two, of the angles between the normal and the rays.
double Cosine(const FacetFrame& frame, const ViewPair& pair,
              const std::vector<View>& views) {
  double smaller = 1;
  for (const uint32_t view : {pair.first, pair.second}) {
    const Eigen::Vector3d ray = views[view].Center() - frame.corner;
    smaller = std::min(smaller, frame.normal.dot(ray.normalized()));
  }
  return smaller;
}

}  // namespace

std::shared_ptr<ImagePyramid> RefinementScene::Pyramid(
    size_t max_memory, ReadGrayImage read_mask) const {
  return std::make_shared<ImagePyramid>(
      Views(), [this](size_t view) { return images[view]; }, max_memory,
      std::move(read_mask));
}

std::shared_ptr<ImagePyramid> RefinementScene::PyramidOf(
    std::vector<View> views) const {
  std::shared_ptr<ImagePyramid> pyramid = Pyramid();
  pyramid->SetViews(std::move(views));
  return pyramid;
}

TriangleMesh RefinementScene::Perturbed(double deviation, uint32_t seed) const {
  std::mt19937 random(seed);
  std::normal_distribution<float> noise;
  TriangleMesh mesh = Truth();
  for (size_t i = 0; i < mesh.vertices.size(); ++i) {
    mesh.vertices[i] += static_cast<float>(deviation * dense.scene.footprint) *
                        noise(random) * dense.scene.normals[i];
  }
  return mesh;
}

FacetLabels RefinementScene::Labels(size_t pairs_per_facet) const {
  FacetLabels labels;
  for (uint32_t i = 0; i + 1 < Views().size(); ++i) {
    labels.pairs.push_back({i, i + 1});
  }
  const std::vector<FacetFrame> frames = ComputeFacetFrames(Truth());
  std::vector<uint32_t> order(labels.pairs.size());
  for (size_t facet = 0; facet < frames.size(); ++facet) {
    std::iota(order.begin(), order.end(), 0);
    std::ranges::stable_sort(order, std::greater(), [&](uint32_t pair) {
      return Cosine(frames[facet], labels.pairs[pair], Views());
    });
    const size_t count = std::min(pairs_per_facet, order.size());
    labels.labels.AddRow(std::span(order).first(facet % 10 != 0 ? count : 0));
  }
  return labels;
}

RefinementScene MakeRefinementScene(const std::string& shape, int num_images,
                                    int width) {
  synthetic::DenseSceneOptions options;
  options.scene.shape = shape;
  options.scene.num_images = num_images;
  options.scene.width = width;
  options.scene.height = width * 3 / 4;
  options.keep_true_depths = false;
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

RefinementScene MakeRoomScene(int scale) {
  RefinementScene scene;
  scene.dense.scene.surface = MakeRoom();
  for (const View& view : RoomViews()) {
    const View resized =
        ResizeView(view, scale * view.width, scale * view.height);
    scene.dense.scene.views.push_back(resized);
    scene.images.push_back(RoomImage(resized));
  }
  return scene;
}

}  // namespace colmap_ext
