#include "photometry/pair_warp.h"

#include <algorithm>

#include <Eigen/Geometry>

#include "photometry/interpolation.h"

namespace colmap_ext {

PairWarp::PairWarp(const DrawnView& i, const DrawnView& j,
                   const std::vector<FacetFrame>& frames)
    : i_(i),
      j_(j),
      frames_(frames),
      center_i_(i.view.Center()),
      ray_from_pixel_i_(i.view.RayFromPixel()),
      pixel_j_from_pixel_i_(j.view.PixelFromRay() * ray_from_pixel_i_),
      epipole_(j.view.PixelFromRay() * (center_i_ - j.view.Center())) {}

Eigen::Vector3d PairWarp::Point(const FacetFrame& frame, int row,
                                int col) const {
  const Eigen::Vector3d ray =
      ray_from_pixel_i_ * Eigen::Vector3d(col + 0.5, row + 0.5, 1);
  const double depth =
      frame.normal.dot(frame.corner - center_i_) / frame.normal.dot(ray);
  return center_i_ + depth * ray;
}

PairWarp::Plane PairWarp::PlaneOf(uint32_t facet) const {
  const FacetFrame& frame = frames_[facet];
  Plane plane;
  plane.facet = facet;
  plane.is_facing = i_.drawn.is_facing[facet] && j_.drawn.is_facing[facet];
  plane.nearness = 1 / frame.normal.dot(frame.corner - center_i_);
  plane.inverse_depth =
      plane.nearness * (ray_from_pixel_i_.transpose() * frame.normal);
  plane.slope = PlaneSlope(j_.view, frame);
  return plane;
}

// Homogeneous pixel in j: p = M (u, v, 1) + e w (docs/method.md, section 5.2),
// w the inverse depth, in units of the depth in i.
PairWarp::Sample PairWarp::Warp(const Plane& plane,
                                const Eigen::Vector3d& pixel_i) const {
  Sample sample;
  const double inverse_depth = plane.inverse_depth.dot(pixel_i);
  if (!plane.is_facing || !(inverse_depth > 0)) {
    return sample;
  }
  const Eigen::Vector3d ray_in_j = pixel_j_from_pixel_i_ * pixel_i;
  const Eigen::Vector3d p = ray_in_j + epipole_ * inverse_depth;
  if (!(p.z() > 0)) {
    return sample;
  }
  const double scale = 1 / p.z();
  const double u = p.x() * scale;
  const double v = p.y() * scale;
  const int width = j_.image.width;
  const int height = j_.image.height;
  if (!(u >= 0.5 && v >= 0.5 && u < width - 0.5 && v < height - 0.5)) {
    return sample;
  }
  if (!IsNearest(j_.view, j_.drawn, plane.facet, plane.slope, u, v,
                 inverse_depth * scale)) {
    return sample;
  }
  const Interpolated interpolated = Interpolate(j_.image, u, v);
  sample.is_valid = true;
  sample.value = interpolated.value;
  sample.motion = static_cast<float>(
      (interpolated.by_u * (ray_in_j.x() - u * ray_in_j.z()) +
       interpolated.by_v * (ray_in_j.y() - v * ray_in_j.z())) *
      scale * plane.nearness);
  return sample;
}

void PairWarp::ComputeRow(int row, int first_col, int last_col,
                          CorrelationTile* tile, TileGeometry* geometry) const {
  const int image_row = geometry->first_row + row;
  Plane plane;
  for (int col = first_col; col <= last_col; ++col) {
    const int image_col = geometry->first_col + col;
    const size_t at = tile->Index(row, col);
    const size_t pixel = i_.drawn.Index(image_row, image_col);
    const uint32_t facet = i_.drawn.facets[pixel];
    const uint8_t gray = i_.image.Row(image_row)[image_col];
    if (tile->is_reached[at] == 0 || facet == kNoFacet || IsSaturated(gray)) {
      continue;
    }
    if (facet != plane.facet) {
      plane = PlaneOf(facet);
    }
    const Sample sample = Warp(plane, {image_col + 0.5, image_row + 0.5, 1});
    if (!sample.is_valid) {
      continue;
    }
    geometry->facets[at] = facet;
    geometry->motion[at] = sample.motion;
    tile->image[at] = gray;
    tile->warped[at] = sample.value;
    tile->is_valid[at] = 1;
    // As drawn, so that no mask changes as the surface moves.
    tile->inverse_depths[at] = i_.drawn.inverse_depths[pixel];
  }
}

void PairWarp::Compute(CorrelationTile* tile, TileGeometry* geometry) const {
  const size_t size = static_cast<size_t>(tile->width) * tile->height;
  geometry->facets.assign(size, kNoFacet);
  geometry->motion.assign(size, 0);
  for (auto* plane :
       {&tile->image, &tile->warped, &tile->is_valid, &tile->inverse_depths}) {
    plane->assign(size, 0);
  }
  const int first_row = std::max(0, -geometry->first_row);
  const int last_row =
      std::min(tile->height, i_.image.height - geometry->first_row) - 1;
  const int first_col = std::max(0, -geometry->first_col);
  const int last_col =
      std::min(tile->width, i_.image.width - geometry->first_col) - 1;
  for (int row = first_row; row <= last_row; ++row) {
    ComputeRow(row, first_col, last_col, tile, geometry);
  }
}

}  // namespace colmap_ext
