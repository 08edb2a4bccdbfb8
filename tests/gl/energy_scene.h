#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <memory>
#include <numeric>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "labeling/facet_labels.h"
#include "photometry/image_pyramid.h"
#include "photometry/photometric_energy.h"
#include "raster/facet_frames.h"
#include "tests/refine/refinement_scene.h"

namespace colmap_ext {

// A synthetic scene as the photometric energy takes it.
class EnergyScene {
 public:
  EnergyScene(const std::string& shape, int num_images, int width) {
    synthetic::DenseSceneOptions options;
    options.scene.shape = shape;
    options.scene.num_images = num_images;
    options.scene.width = width;
    options.scene.height = width * 3 / 4;
    options.keep_true_depths = false;
    options.sparse.num_points = 300;
    scene_ = MakeRefinementScene(options);
  }

  const std::vector<View>& Views() const { return scene_.Views(); }
  const TriangleMesh& Truth() const { return scene_.Truth(); }

  // Of the scene's images; the scene has to outlive it.
  // \param scale  of the views' positions.
  // \param read_mask  see ImagePyramid.
  std::shared_ptr<ImagePyramid> Pyramid(double scale = 1,
                                        ReadGrayImage read_mask = {}) const {
    std::vector<View> views = Views();
    for (View& view : views) {
      view.cam_from_world_translation *= scale;
    }
    return std::make_shared<ImagePyramid>(
        views, [this](size_t view) { return scene_.images[view]; }, SIZE_MAX,
        std::move(read_mask));
  }

  // The truth with each vertex moved along its normal.
  // \param deviation  of the moves, px
  TriangleMesh Perturbed(double deviation, uint32_t seed) const {
    std::mt19937 random(seed);
    std::normal_distribution<float> noise(
        0, static_cast<float>(deviation * scene_.dense.scene.footprint));
    TriangleMesh mesh = Truth();
    for (size_t i = 0; i < mesh.vertices.size(); ++i) {
      mesh.vertices[i] += noise(random) * scene_.dense.scene.normals[i];
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
    std::vector<uint32_t> order(labels.pairs.size());
    for (size_t facet = 0; facet < frames.size(); ++facet) {
      std::iota(order.begin(), order.end(), 0);
      std::stable_sort(order.begin(), order.end(), [&](uint32_t a, uint32_t b) {
        return Cosine(frames[facet], labels.pairs[a]) >
               Cosine(frames[facet], labels.pairs[b]);
      });
      if (facet % 10 != 0) {
        labels.labels.values.insert(
            labels.labels.values.end(), order.begin(),
            order.begin() + std::min(pairs_per_facet, order.size()));
      }
      labels.labels.EndRow();
    }
    return labels;
  }

 private:
  // The smaller one of two, of the angles between the normal and the rays.
  double Cosine(const FacetFrame& frame, const ViewPair& pair) const {
    double smaller = 1;
    for (const uint32_t view : {pair.first, pair.second}) {
      const Eigen::Vector3d ray = Views()[view].Center() - frame.corner;
      smaller = std::min(smaller, frame.normal.dot(ray.normalized()));
    }
    return smaller;
  }

  RefinementScene scene_;
};

// How far two evaluations of the same energy are apart.
struct TermsDifference {
  double relative_energy = 0;
  double gradient_cosine = 0;   // of the slopes, all facets' in one vector
  double gradient_ratio = 0;    // of their lengths
  double curvature_cosine = 0;  // likewise
  double relative_weight = 0;
  double relative_pixels = 0;
};

inline TermsDifference Compare(const PhotometricTerms& terms,
                               const PhotometricTerms& reference) {
  // Over all facets, of the products of a part of them.
  const auto dot = [](const auto& part, const PhotometricTerms& a,
                      const PhotometricTerms& b) {
    double sum = 0;
    for (size_t i = 0; i < a.facets.size(); ++i) {
      const auto& of_a = a.facets[i].*part;
      const auto& of_b = b.facets[i].*part;
      sum += std::inner_product(of_a.begin(), of_a.end(), of_b.begin(), 0.0);
    }
    return sum;
  };
  const auto cosine = [&](const auto& part) {
    return dot(part, terms, reference) /
           std::sqrt(dot(part, terms, terms) * dot(part, reference, reference));
  };
  const auto excess = [&](float FacetTerms::*part) {
    double sum = 0;
    double expected = 0;
    for (size_t i = 0; i < terms.facets.size(); ++i) {
      sum += terms.facets[i].*part;
      expected += reference.facets[i].*part;
    }
    return sum / expected - 1;
  };
  return {terms.energy / reference.energy - 1,
          cosine(&FacetTerms::slopes),
          std::sqrt(dot(&FacetTerms::slopes, terms, terms) /
                    dot(&FacetTerms::slopes, reference, reference)),
          cosine(&FacetTerms::curvatures),
          excess(&FacetTerms::weight),
          excess(&FacetTerms::num_pixels)};
}

}  // namespace colmap_ext
