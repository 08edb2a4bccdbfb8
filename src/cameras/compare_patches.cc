#include "cameras/compare_patches.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <utility>

#include "base/rows.h"
#include "photometry/view_order.h"

namespace colmap_ext {

namespace {

// A patch with one of its partners.
struct Comparison {
  uint32_t view = 0;
  uint32_t partner = 0;
  uint32_t patch = 0;
  uint64_t index = 0;  // into partners.values

  bool IsOfSameViews(const Comparison& other) const {
    return view == other.view && partner == other.partner;
  }
};

// Rows of the same two views.
Rows<Comparison> GroupByViews(const SurfacePatches& patches) {
  std::vector<Comparison> all;
  for (uint32_t k = 0; k < patches.patches.size(); ++k) {
    for (size_t l = 0; l < patches.partners[k].size(); ++l) {
      all.push_back({patches.patches[k].view, patches.partners[k][l], k,
                     patches.partners.offsets[k] + l});
    }
  }
  std::stable_sort(
      all.begin(), all.end(), [](const Comparison& a, const Comparison& b) {
        return std::pair(a.view, a.partner) < std::pair(b.view, b.partner);
      });
  Rows<Comparison> rows;
  for (size_t i = 0; i < all.size(); ++i) {
    if (i > 0 && !all[i].IsOfSameViews(all[i - 1])) {
      rows.EndRow();
    }
    rows.values.push_back(all[i]);
  }
  if (!all.empty()) {
    rows.EndRow();
  }
  return rows;
}

// Groups of the same view one after the other, and views by their partners.
// \param groups  see GroupByViews().
std::vector<uint32_t> OrderOf(const Rows<Comparison>& groups,
                              size_t num_views) {
  Rows<uint32_t> partners;  // the values are as many as the groups
  for (uint32_t view = 0; view < num_views; ++view) {
    for (size_t i = partners.values.size();
         i < groups.size() && groups[i].front().view == view; ++i) {
      partners.values.push_back(groups[i].front().partner);
    }
    partners.EndRow();
  }
  std::vector<uint32_t> order;
  for (const uint32_t view : OrderByPartners(partners)) {
    for (uint64_t i = partners.offsets[view]; i < partners.offsets[view + 1];
         ++i) {
      order.push_back(static_cast<uint32_t>(i));
    }
  }
  return order;
}

}  // namespace

// Two views at a time: not all of a view's partners may be there at once.
std::vector<WindowShift> ComparePatches(const PhotometricOptions& photometric,
                                        int radius, const DrawnScene& scene,
                                        const std::vector<View>& views,
                                        const SurfacePatches& patches) {
  const Rows<Comparison> groups = GroupByViews(patches);
  std::vector<WindowShift> shifts(patches.partners.values.size());
  ForEachInOrder(OrderOf(groups, views.size()), [&](uint32_t group) {
    const uint32_t i = groups[group].front().view;
    const uint32_t j = groups[group].front().partner;
    const auto image_i = scene.images->Image(i);
    const auto image_j = scene.images->Image(j);
    const auto drawn_i = scene.buffers.Get(i);
    const auto drawn_j = scene.buffers.Get(j);
    for (const Comparison& comparison : groups[group]) {
      shifts[comparison.index] =
          CompareWindow(photometric, radius, {views[i], *image_i, *drawn_i},
                        {views[j], *image_j, *drawn_j}, scene.frames,
                        patches.patches[comparison.patch]);
    }
  });
  return shifts;
}

}  // namespace colmap_ext
