#include "labeling/view_pairs.h"

#include <tbb/parallel_for.h>

#include "mesh/mesh_in_image.h"

namespace colmap_ext {
namespace {

// The views that share the most points with a view, at most `count`.
std::vector<uint32_t> FindPartners(const PointCloud& points,
                                   const Rows<uint32_t>& points_of, size_t view,
                                   size_t count) {
  std::vector<uint32_t> num_shared(points_of.size(), 0);
  for (const uint32_t point : points_of[view]) {
    for (const uint32_t other : points.views[point]) {
      ++num_shared[other];
    }
  }
  num_shared[view] = 0;
  std::vector<uint32_t> partners;
  for (uint32_t other = 0; other < num_shared.size(); ++other) {
    if (num_shared[other] > 0) {
      partners.push_back(other);
    }
  }
  std::ranges::stable_sort(partners, [&](uint32_t a, uint32_t b) {
    return num_shared[a] > num_shared[b];
  });
  partners.resize(std::min(partners.size(), count));
  return partners;
}

}  // namespace

std::vector<ViewPair> SelectViewPairs(const PointCloud& points,
                                      size_t num_views, int partners_per_view) {
  const auto points_of = GroupInRows<uint32_t>(num_views, [&](const auto& add) {
    for (uint32_t i = 0; i < points.size(); ++i) {
      for (const uint32_t view : points.views[i]) {
        add(view, i);
      }
    }
  });
  std::vector<std::vector<uint32_t>> partners(num_views);
  tbb::parallel_for(size_t{0}, num_views, [&](size_t view) {
    partners[view] = FindPartners(points, points_of, view, partners_per_view);
  });
  std::vector<ViewPair> pairs;
  for (uint32_t view = 0; view < num_views; ++view) {
    for (const uint32_t other : partners[view]) {
      pairs.push_back({std::min(view, other), std::max(view, other)});
    }
  }
  SortUnique(&pairs);
  return pairs;
}

FacetLabels InSmallerView(FacetLabels labels, const TriangleMesh& mesh,
                          const std::vector<View>& views) {
  const Rows<uint32_t>& rows = labels.labels;
  labels.directions.resize(rows.values.size());
  tbb::parallel_for(size_t{0}, labels.NumFacets(), [&](size_t facet) {
    const auto area_in = [&](uint32_t view) {
      return AreaInImage(mesh, mesh.facets[facet], views[view]);
    };
    for (uint64_t i = rows.offsets[facet]; i < rows.offsets[facet + 1]; ++i) {
      const auto [first, second] = labels.pairs[rows.values[i]];
      labels.directions[i] =
          area_in(first) < area_in(second) ? kInFirst : kInSecond;
    }
  });
  return labels;
}

}  // namespace colmap_ext
