#pragma once

#include <cstdint>
#include <vector>

#include <Eigen/Core>

#include "photometry/photometric_energy.h"
#include "photometry/window_correlation.h"
#include "raster/facet_frames.h"
#include "raster/facet_id_buffer.h"
#include "scene/gray_image.h"
#include "scene/view.h"

namespace colmap_ext {

// A view with all that is seen in it.
struct DrawnView {
  const View& view;
  const GrayImage& image;
  const FacetIdBuffer& drawn;
};

// Where the pixels of a tile lie on the surface.
struct TileGeometry {
  int first_row = 0;  // of the tile in image i, may be negative
  int first_col = 0;
  std::vector<uint32_t> facets;  // [height * width] or kNoFacet
  // [height * width] derivative of I_ij by the distance that the surface moves
  // along its normal: grad I_j . DPi_j d / (n . d), where it is valid.
  std::vector<float> motion;
};

// Image I_j seen from i by way of the surface.
class PairWarp {
 public:
  PairWarp(const DrawnView& i, const DrawnView& j,
           const std::vector<FacetFrame>& frames);

  // Fills the tile's image, warped image, validity and inverse depths, and the
  // geometry's arrays, of tile.width and height from geometry.first_row and
  // first_col on. A pixel is valid if it is reached by a window and its facet,
  // in its present position, faces both cameras, and j sees it: nothing is
  // drawn there in front of it.
  void Compute(CorrelationTile* tile, TileGeometry* geometry) const;

  // The point on a facet's plane that pixel (row, col) of i shows.
  Eigen::Vector3d Point(const FacetFrame& frame, int row, int col) const;

 private:
  // What the pixels of a facet have in common.
  struct Plane {
    uint32_t facet = kNoFacet;
    bool is_facing = false;         // both cameras
    Eigen::Vector3d inverse_depth;  // by (u, v, 1) in i
    double nearness = 0;            // 1 / (n . d), d to camera i's centre
    double slope = 0;               // in j, see PlaneSlope()
  };

  // A sample of I_j.
  struct Sample {
    bool is_valid = false;
    float value = 0;
    float motion = 0;
  };

  Plane PlaneOf(uint32_t facet) const;
  Sample Warp(const Plane& plane, const Eigen::Vector3d& ray_in_j,
              double inverse_depth) const;

  DrawnView i_;
  DrawnView j_;
  const std::vector<FacetFrame>& frames_;
  Eigen::Vector3d center_i_;
  Eigen::Matrix3d ray_from_pixel_i_;      // (u, v, 1) -> world ray with z 1
  Eigen::Matrix3d pixel_j_from_pixel_i_;  // of points at infinity, homogeneous
  Eigen::Vector3d epipole_;               // of camera i in j, homogeneous
};

}  // namespace colmap_ext
