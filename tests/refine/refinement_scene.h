#pragma once

#include <algorithm>
#include <functional>
#include <memory>
#include <random>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "labeling/view_pairs.h"
#include "photometry/image_pyramid.h"
#include "raster/facet_id_buffer.h"
#include "tests/random.h"
#include "tests/raster/visible_facets.h"
#include "tests/synthetic/dense_scene.h"

namespace colmap_ext {

// The smaller one of two, of the angles between the normal and the rays.
inline double Cosine(const FacetFrame& frame, const ViewPair& pair,
                     const std::vector<View>& views) {
  double smaller = 1;
  for (const uint32_t view : {pair.first, pair.second}) {
    const Eigen::Vector3d ray = views[view].Center() - frame.corner;
    smaller = std::min(smaller, frame.normal.dot(ray.normalized()));
  }
  return smaller;
}

// A small dense scene with photographs in grey, as the refinement takes it.
struct RefinementScene {
  synthetic::DenseScene dense;
  std::vector<GrayImage> images;  // [views]

  const TriangleMesh& Truth() const { return dense.scene.surface; }
  const std::vector<View>& Views() const { return dense.scene.views; }

  // Of the scene's images, which it has to outlive.
  // \param read_mask  see ImagePyramid
  std::shared_ptr<ImagePyramid> Pyramid(size_t max_memory = SIZE_MAX,
                                        ReadGrayImage read_mask = {}) const {
    return std::make_shared<ImagePyramid>(
        Views(), [this](size_t view) { return images[view]; }, max_memory,
        std::move(read_mask));
  }
  // The same by other cameras.
  std::shared_ptr<ImagePyramid> PyramidOf(std::vector<View> views) const {
    std::shared_ptr<ImagePyramid> pyramid = Pyramid();
    pyramid->SetViews(std::move(views));
    return pyramid;
  }

  // The truth with each vertex moved along its normal at random.
  // \param deviation  of the moves, px
  TriangleMesh Perturbed(double deviation, uint32_t seed = 1) const {
    std::mt19937 random(seed);
    std::normal_distribution<float> noise;
    TriangleMesh mesh = Truth();
    for (size_t i = 0; i < mesh.vertices.size(); ++i) {
      mesh.vertices[i] +=
          static_cast<float>(deviation * dense.scene.footprint) *
          noise(random) * dense.scene.normals[i];
    }
    return mesh;
  }

  // The `pairs_per_facet` pairs of neighbouring views that face each facet
  // best; one facet of ten has none.
  FacetLabels Labels(size_t pairs_per_facet) const {
    FacetLabels labels;
    for (uint32_t i = 0; i + 1 < Views().size(); ++i) {
      labels.pairs.push_back({i, i + 1});
    }
    const std::vector<FacetFrame> frames = ComputeFacetFrames(Truth());
    for (size_t facet = 0; facet < frames.size(); ++facet) {
      std::vector<uint32_t> order = Iota(labels.pairs.size());
      std::ranges::stable_sort(order, std::greater(), [&](uint32_t pair) {
        return Cosine(frames[facet], labels.pairs[pair], Views());
      });
      const size_t count = std::min(pairs_per_facet, order.size());
      labels.labels.AddRow(std::span(order).first(facet % 10 != 0 ? count : 0));
    }
    return labels;
  }
};

// \param shape  see SceneOptions
// \param width  of the images, px; their height is 3/4 of it
inline RefinementScene MakeRefinementScene(const std::string& shape = "statue",
                                           int num_images = 8,
                                           int width = 160) {
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

// A room seen from inside, of painted walls that reach behind the cameras.
// \param scale  of the size of RoomViews()
inline RefinementScene MakeRoomScene(int scale) {
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

// Ascending.
inline std::vector<ViewPair> AllPairs(size_t num_views) {
  std::vector<ViewPair> pairs;
  for (uint32_t a = 0; a < num_views; ++a) {
    for (uint32_t b = a + 1; b < num_views; ++b) {
      pairs.push_back({a, b});
    }
  }
  return pairs;
}

// Each facet by all of the pairs, where a predicate says so of its index.
template <typename Predicate>
FacetLabels LabelWhere(const std::vector<ViewPair>& pairs, size_t num_facets,
                       const Predicate& is_labeled) {
  FacetLabels labels{pairs, {}, {}};
  for (size_t facet = 0; facet < num_facets; ++facet) {
    labels.labels.AddRow(Iota(is_labeled(facet) ? pairs.size() : 0));
  }
  return labels;
}

inline FacetLabels LabelAll(const std::vector<ViewPair>& pairs,
                            size_t num_facets) {
  return LabelWhere(pairs, num_facets, [](size_t) { return true; });
}

}  // namespace colmap_ext
