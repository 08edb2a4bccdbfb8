#pragma once

#include <memory>
#include <string>
#include <vector>

#include "labeling/facet_labels.h"
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
  // \param read_mask  see ImagePyramid
  std::shared_ptr<ImagePyramid> Pyramid(size_t max_memory = SIZE_MAX,
                                        ReadGrayImage read_mask = {}) const;
  // The same by other cameras.
  std::shared_ptr<ImagePyramid> PyramidOf(std::vector<View> views) const;

  // The truth with each vertex moved along its normal at random.
  // \param deviation  of the moves, px
  TriangleMesh Perturbed(double deviation, uint32_t seed = 1) const;

  // The `pairs_per_facet` pairs of neighbouring views that face each facet
  // best; one facet of ten has none.
  FacetLabels Labels(size_t pairs_per_facet) const;
};

// \param shape  see SceneOptions
// \param width  of the images, px; their height is 3/4 of it
RefinementScene MakeRefinementScene(const std::string& shape = "statue",
                                    int num_images = 8, int width = 160);

// A room seen from inside, of painted walls that reach behind the cameras.
// \param scale  of the size of RoomViews()
RefinementScene MakeRoomScene(int scale);

// Each facet by all of the pairs, where a predicate says so of its index.
template <typename Predicate>
FacetLabels LabelWhere(const std::vector<ViewPair>& pairs, size_t num_facets,
                       const Predicate& is_labeled) {
  FacetLabels labels{pairs, {}, {}};
  for (size_t facet = 0; facet < num_facets; ++facet) {
    for (uint32_t pair = 0; pair < pairs.size() && is_labeled(facet); ++pair) {
      labels.labels.values.push_back(pair);
    }
    labels.labels.EndRow();
  }
  return labels;
}

inline FacetLabels LabelAll(const std::vector<ViewPair>& pairs,
                            size_t num_facets) {
  return LabelWhere(pairs, num_facets, [](size_t) { return true; });
}

}  // namespace colmap_ext
