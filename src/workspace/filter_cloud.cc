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

PointCloud FilterCloud(PlyCloud cloud, Visibility visibility, size_t num_images,
                       FilterReport* report) {
  report->num_points = cloud.positions.size();
  report->num_out_of_range = CountOutOfRange(visibility, num_images);
  PointCloud filtered{std::move(cloud.positions), std::move(cloud.colors),
                      std::move(visibility)};
  const auto edit = [&](size_t point,
                        std::span<uint32_t> row) -> std::optional<size_t> {
    const auto end = std::remove_if(
        row.begin(), row.end(),
        [num_images](uint32_t index) { return index >= num_images; });
    std::sort(row.begin(), end);
    const auto unique_end = std::unique(row.begin(), end);
    report->num_with_repeats += unique_end != end;
    if (!filtered.positions[point].allFinite()) {
      ++report->num_not_finite;
      return std::nullopt;
    }
    if (unique_end == row.begin()) {
      ++report->num_without_views;
      return std::nullopt;
    }
    return static_cast<size_t>(unique_end - row.begin());
  };
  EditPoints(edit, &filtered);
  return filtered;
}

}  // namespace colmap_ext
