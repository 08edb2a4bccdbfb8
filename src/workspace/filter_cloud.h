#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

#include "formats/read_ply.h"
#include "formats/read_visibility.h"
#include "scene/point_cloud.h"

namespace colmap_ext {

struct FilterReport {
  size_t num_points = 0;         // that came in
  size_t num_not_finite = 0;     // dropped
  size_t num_without_views = 0;  // dropped
  size_t num_with_repeats = 0;   // that listed an image more than once
  size_t num_out_of_range = 0;   // that listed an image which is not there
};

// Shortens the views of points, or drops the points.
// \param edit  of a point and its views, as EditRows() has it
template <typename Edit>
void EditPoints(const Edit& edit, PointCloud* cloud) {
  size_t num_kept = 0;
  EditRows(
      [&](size_t point, std::span<uint32_t> views) {
        const std::optional<size_t> num_views = edit(point, views);
        if (num_views) {
          cloud->positions[num_kept] = cloud->positions[point];
          if (!cloud->colors.empty()) {
            cloud->colors[num_kept] = cloud->colors[point];
          }
          ++num_kept;
        }
        return num_views;
      },
      &cloud->views);
  cloud->positions.resize(num_kept);
  cloud->colors.resize(cloud->colors.empty() ? 0 : num_kept);
}

// How many points list an image index that is not below num_images.
size_t CountOutOfRange(const Visibility& visibility, size_t num_images);

// The points that can be meshed: finite, and seen by some image. Image indices
// that are out of range or repeated are dropped, the rest sorted.
PointCloud FilterCloud(PlyCloud cloud, Visibility visibility, size_t num_images,
                       FilterReport* report);

}  // namespace colmap_ext
