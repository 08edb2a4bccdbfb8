#include "spatial/facet_tree.h"

#include <tbb/parallel_for.h>
#include <tbb/parallel_invoke.h>

namespace colmap_ext {
namespace {

// Both are choices.
constexpr size_t kFacetsPerLeaf = 4;
constexpr size_t kMinParallelLeaves = 256;  // of a part that is sorted in tasks

}  // namespace

Eigen::AlignedBox3f BoxOf(const TriangleMesh& mesh, const Facet& facet) {
  Eigen::AlignedBox3f box;
  for (const uint32_t vertex : facet) {
    box.extend(mesh.vertices[vertex]);
  }
  return box;
}

Eigen::AlignedBox3f BoxOf(const TriangleMesh& mesh, uint32_t facet) {
  return BoxOf(mesh, mesh.facets[facet]);
}

FacetTree::FacetTree(const TriangleMesh& mesh)
    : FacetTree(mesh, Iota(mesh.facets.size())) {
  places_.resize(facets_.size());
  for (uint32_t i = 0; i < facets_.size(); ++i) {
    places_[facets_[i]] = i;
  }
}

FacetTree::FacetTree(const TriangleMesh& mesh, std::span<const uint32_t> facets)
    : facets_(Iota(facets.size())), boxes_(facets.size()) {
  const size_t num_leaves =
      std::bit_ceil((facets.size() + kFacetsPerLeaf - 1) / kFacetsPerLeaf);
  nodes_.resize(2 * num_leaves - 1);
  std::vector<Box> boxes(facets.size());
  tbb::parallel_for(size_t{0}, boxes.size(),
                    [&](size_t i) { boxes[i] = BoxOf(mesh, facets[i]); });
  Sort(0, num_leaves, boxes);
  for (size_t i = 0; i < boxes_.size(); ++i) {
    boxes_[i] = boxes[facets_[i]];
    facets_[i] = facets[facets_[i]];
  }
  FillNodes();
}

void FacetTree::Enclose(const TriangleMesh& from, const TriangleMesh& to) {
  tbb::parallel_for(size_t{0}, boxes_.size(), [&](size_t i) {
    boxes_[i] = BoxOf(from, facets_[i]).merged(BoxOf(to, facets_[i]));
  });
  FillNodes();
}

void FacetTree::Extend(const TriangleMesh& mesh,
                       const std::vector<uint32_t>& facets) {
  for (const uint32_t facet : facets) {
    const Box box = BoxOf(mesh, facet);
    const size_t place = places_[facet];
    boxes_[place].extend(box);
    for (size_t i = NumLeaves() + LeafOf(place); i > 0; i /= 2) {
      nodes_[i - 1].extend(box);
    }
  }
}

// Halves the facets along the longest extent of their boxes' centres.
void FacetTree::Sort(size_t first_leaf, size_t last_leaf,
                     const std::vector<Box>& boxes) {
  if (last_leaf - first_leaf == 1) {
    return;
  }
  const auto first = facets_.begin() + static_cast<int64_t>(First(first_leaf));
  const auto last = facets_.begin() + static_cast<int64_t>(First(last_leaf));
  Box centers;
  for (auto facet = first; facet != last; ++facet) {
    centers.extend(boxes[*facet].center());
  }
  int axis = 0;
  centers.sizes().maxCoeff(&axis);
  const size_t middle_leaf = first_leaf + (last_leaf - first_leaf) / 2;
  std::nth_element(first,
                   facets_.begin() + static_cast<int64_t>(First(middle_leaf)),
                   last, [&](uint32_t a, uint32_t b) {
                     return boxes[a].min()[axis] + boxes[a].max()[axis] <
                            boxes[b].min()[axis] + boxes[b].max()[axis];
                   });
  const auto sort_first = [&] { Sort(first_leaf, middle_leaf, boxes); };
  const auto sort_second = [&] { Sort(middle_leaf, last_leaf, boxes); };
  if (last_leaf - first_leaf < kMinParallelLeaves) {
    sort_first();
    sort_second();
  } else {
    tbb::parallel_invoke(sort_first, sort_second);
  }
}

void FacetTree::FillNodes() {
  tbb::parallel_for(size_t{0}, NumLeaves(), [&](size_t leaf) {
    Box& box = nodes_[NumLeaves() - 1 + leaf];
    box.setEmpty();
    for (size_t i = First(leaf); i < First(leaf + 1); ++i) {
      box.extend(boxes_[i]);
    }
  });
  for (size_t node = NumLeaves() - 1; node-- > 0;) {
    nodes_[node] = nodes_[2 * node + 1].merged(nodes_[2 * node + 2]);
  }
}

}  // namespace colmap_ext
