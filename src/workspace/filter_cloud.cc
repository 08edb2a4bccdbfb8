#include "workspace/filter_cloud.h"

#include <algorithm>
#include <utility>

namespace colmap_ext {

size_t CountOutOfRange(const Visibility& visibility, size_t num_images) {
  size_t count = 0;
  for (size_t i = 0; i < visibility.size(); ++i) {
    count += std::any_of(
        visibility[i].begin(), visibility[i].end(),
        [num_images](uint32_t index) { return index >= num_images; });
  }
  return count;
}

// In place: what is kept never lies behind where it came from.
PointCloud FilterCloud(PlyCloud cloud, Visibility visibility, size_t num_images,
                       FilterReport* report) {
  report->num_points = cloud.positions.size();
  report->num_out_of_range = CountOutOfRange(visibility, num_images);
  size_t num_kept = 0;
  const auto indices = visibility.values.begin();
  uint64_t kept_end = 0;  // of the kept image indices
  uint64_t row_begin = 0;
  for (size_t i = 0; i < cloud.positions.size(); ++i) {
    const auto begin = indices + static_cast<std::ptrdiff_t>(row_begin);
    row_begin = visibility.offsets[i + 1];
    auto end = std::remove_if(
        begin, indices + static_cast<std::ptrdiff_t>(row_begin),
        [num_images](uint32_t index) { return index >= num_images; });
    std::sort(begin, end);
    const auto unique_end = std::unique(begin, end);
    report->num_with_repeats += unique_end != end;
    if (!cloud.positions[i].allFinite()) {
      ++report->num_not_finite;
      continue;
    }
    if (begin == unique_end) {
      ++report->num_without_views;
      continue;
    }
    std::move(begin, unique_end,
              indices + static_cast<std::ptrdiff_t>(kept_end));
    kept_end += static_cast<uint64_t>(unique_end - begin);
    cloud.positions[num_kept] = cloud.positions[i];
    if (!cloud.colors.empty()) {
      cloud.colors[num_kept] = cloud.colors[i];
    }
    visibility.offsets[++num_kept] = kept_end;
  }
  cloud.positions.resize(num_kept);
  cloud.colors.resize(cloud.colors.empty() ? 0 : num_kept);
  visibility.offsets.resize(num_kept + 1);
  visibility.values.resize(kept_end);
  return {std::move(cloud.positions), std::move(cloud.colors),
          std::move(visibility)};
}

}  // namespace colmap_ext
