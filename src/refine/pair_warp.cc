#include "refine/pair_warp.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Geometry>

namespace colmap_ext {

namespace {

Eigen::Matrix3d Calibration(const View& view) {
  Eigen::Matrix3d matrix;
  matrix << view.fx, 0, view.cx, 0, view.fy, view.cy, 0, 0, 1;
  return matrix;
}

Eigen::Matrix3d RayFromPixel(const View& view) {
  return view.cam_from_world_rotation.transpose() *
         Calibration(view).inverse();
}

}  // namespace

PairWarp::PairWarp(const PhotometricOptions& options, const DrawnView& i,
                   const DrawnView& j, const std::vector<FacetFrame>& frames)
    : min_cosine_squared_(options.min_cosine * options.min_cosine),
      i_(i),
      j_(j),
      frames_(frames),
      center_i_(i.view.Center()),
      center_j_(j.view.Center()),
      ray_from_pixel_i_(RayFromPixel(i.view)),
      ray_from_pixel_j_(RayFromPixel(j.view)),
      pixel_j_from_pixel_i_(Calibration(j.view) *
                            j.view.cam_from_world_rotation *
                            ray_from_pixel_i_),
      epipole_(Calibration(j.view) * j.view.CamFromWorld(center_i_)) {}

Eigen::Vector3d PairWarp::Point(const FacetFrame& frame, int row,
                                int col) const {
  const Eigen::Vector3d ray =
      ray_from_pixel_i_ * Eigen::Vector3d(col + 0.5, row + 0.5, 1);
  const double depth =
      frame.normal.dot(frame.corner - center_i_) / frame.normal.dot(ray);
  return center_i_ + depth * ray;
}

// By the depths that are drawn at the pixel: nothing may be nearer than the
// facet's plane goes within two pixels around, and two pixels' footprints more.
bool PairWarp::IsSeenByJ(uint32_t facet, double u, double v,
                         double inverse_depth) const {
  const size_t pixel =
      j_.drawn.Index(static_cast<int>(v), static_cast<int>(u));
  if (j_.drawn.facets[pixel] == facet) {
    return true;
  }
  const FacetFrame& frame = frames_[facet];
  const double distance = frame.normal.dot(frame.corner - center_j_);
  const Eigen::Vector3d slopes =
      ray_from_pixel_j_.transpose() * frame.normal / distance;
  const double footprint =
      inverse_depth / std::min(j_.view.fx, j_.view.fy);
  const double bound =
      2 * (std::abs(slopes.x()) + std::abs(slopes.y()) + footprint);
  return j_.drawn.inverse_depths[pixel] <= inverse_depth + bound;
}

// With inverse depth w, p = H (u, v, 1) + e w is the pixel in j, homogeneous,
// in units of the depth in i. It moves with the point along the ray by
// (H_u - u_j H_z, H_v - v_j H_z) / p_z a depth of i; n . d is the plane's
// distance from camera i.
PairWarp::Sample PairWarp::Warp(uint32_t facet, const Eigen::Vector3d& ray,
                                const Eigen::Vector3d& ray_in_j,
                                double inverse_depth, double distance) const {
  Sample sample;
  // Towards i?
  const double cosine = -distance * inverse_depth;  // times the ray's length
  if (!(cosine > 0) ||
      cosine * cosine < min_cosine_squared_ * ray.squaredNorm()) {
    return sample;
  }
  const Eigen::Vector3d p = ray_in_j + epipole_ * inverse_depth;
  if (!(p.z() > 0)) {
    return sample;
  }
  const double u = p.x() / p.z();
  const double v = p.y() / p.z();
  const int width = j_.image.width;
  const int height = j_.image.height;
  if (!(u >= 0.5 && v >= 0.5 && u < width - 0.5 && v < height - 0.5)) {
    return sample;
  }
  // Towards j?
  const FacetFrame& frame = frames_[facet];
  const Eigen::Vector3d from_j = center_i_ + ray / inverse_depth - center_j_;
  const double cosine_j = -frame.normal.dot(from_j);
  if (!(cosine_j > 0) ||
      cosine_j * cosine_j < min_cosine_squared_ * from_j.squaredNorm()) {
    return sample;
  }
  if (!IsSeenByJ(facet, u, v, inverse_depth / p.z())) {
    return sample;
  }
  const int col = std::min(static_cast<int>(u - 0.5), width - 2);
  const int row = std::min(static_cast<int>(v - 0.5), height - 2);
  const auto x = static_cast<float>(u - 0.5 - col);
  const auto y = static_cast<float>(v - 0.5 - row);
  const uint8_t* upper = j_.image.Row(row) + col;
  const uint8_t* lower = upper + width;
  const float top = upper[0] + x * (upper[1] - upper[0]);
  const float bottom = lower[0] + x * (lower[1] - lower[0]);
  const float by_u = (1 - y) * static_cast<float>(upper[1] - upper[0]) +
                     y * static_cast<float>(lower[1] - lower[0]);
  const float by_v = bottom - top;
  sample.is_valid = true;
  sample.value = top + y * by_v;
  sample.motion = static_cast<float>(
      (by_u * (ray_in_j.x() - u * ray_in_j.z()) +
       by_v * (ray_in_j.y() - v * ray_in_j.z())) /
      (p.z() * distance));
  return sample;
}

void PairWarp::Compute(CorrelationTile* tile, TileGeometry* geometry) const {
  const size_t size = static_cast<size_t>(tile->width) * tile->height;
  geometry->facets.assign(size, kNoFacet);
  geometry->motion.assign(size, 0);
  for (auto* plane : {&tile->image, &tile->warped, &tile->is_valid,
                      &tile->inverse_depths}) {
    plane->assign(size, 0);
  }
  const int first_col = std::max(0, -geometry->first_col);
  const int last_col =
      std::min(tile->width, i_.image.width - geometry->first_col) - 1;
  for (int row = 0; row < tile->height; ++row) {
    const int image_row = geometry->first_row + row;
    if (image_row < 0 || image_row >= i_.image.height) {
      continue;
    }
    for (int col = first_col; col <= last_col; ++col) {
      const int image_col = geometry->first_col + col;
      const size_t at = tile->Index(row, col);
      const uint32_t facet =
          i_.drawn.facets[i_.drawn.Index(image_row, image_col)];
      if (facet == kNoFacet) {
        continue;
      }
      const FacetFrame& frame = frames_[facet];
      const Eigen::Vector3d pixel(image_col + 0.5, image_row + 0.5, 1);
      const Eigen::Vector3d ray = ray_from_pixel_i_ * pixel;
      const double distance = frame.normal.dot(frame.corner - center_i_);
      const double inverse_depth = frame.normal.dot(ray) / distance;
      if (!(inverse_depth > 0)) {
        continue;
      }
      const Sample sample = Warp(facet, ray, pixel_j_from_pixel_i_ * pixel,
                                 inverse_depth, distance);
      if (!sample.is_valid) {
        continue;
      }
      geometry->facets[at] = facet;
      geometry->motion[at] = sample.motion;
      tile->image[at] = i_.image.Row(image_row)[image_col];
      tile->warped[at] = sample.value;
      tile->is_valid[at] = 1;
      tile->inverse_depths[at] = static_cast<float>(inverse_depth);
    }
  }
}

}  // namespace colmap_ext
