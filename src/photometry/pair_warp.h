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

// A view, its image, and the mesh drawn into it. References are kept.
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
  // [height * width] grey values / scene unit: derivative of I_ij by the
  // distance that the surface moves along its normal, mu of docs/method.md,
  // section 5.2; 0 where it is not valid.
  std::vector<float> motion;
};

// Image I_j seen from i by way of the surface (docs/method.md, section 5.2).
class PairWarp {
 public:
  // \param frames  [F] of the present mesh; kept by reference.
  PairWarp(const DrawnView& i, const DrawnView& j,
           const std::vector<FacetFrame>& frames);

  // Fills the tile's image, warped image, validity and inverse depths, and the
  // geometry's arrays, of tile.width and height from geometry.first_row and
  // first_col on. A pixel is valid if a window reaches it, it is not saturated
  // in i, its facet faced both cameras when the mesh was drawn, and in the
  // facet's present position the inverse depth is positive and j sees the
  // point: nothing is drawn there in front of it.
  void Compute(CorrelationTile* tile, TileGeometry* geometry) const;

  // The point on a facet's plane that pixel (row, col) of i shows.
  Eigen::Vector3d Point(const FacetFrame& frame, int row, int col) const;

 private:
  // What the pixels of a facet have in common.
  struct Plane {
    uint32_t facet = kNoFacet;
    bool is_facing = false;         // both cameras
    Eigen::Vector3d inverse_depth;  // by (u, v, 1) in i
    double nearness = 0;            // 1 / (n . (corner - centre of i)), 1 /
                                    // scene unit
    double slope = 0;               // in j, see PlaneSlope()
  };

  // A sample of I_j.
  struct Sample {
    bool is_valid = false;
    float value = 0;   // grey value
    float motion = 0;  // see TileGeometry
  };

  // Row `row` of the tile, columns first_col to last_col.
  void ComputeRow(int row, int first_col, int last_col, CorrelationTile* tile,
                  TileGeometry* geometry) const;
  Plane PlaneOf(uint32_t facet) const;
  // \param pixel_i  (u, v, 1)
  Sample Warp(const Plane& plane, const Eigen::Vector3d& pixel_i) const;

  DrawnView i_;
  DrawnView j_;
  const std::vector<FacetFrame>& frames_;
  Eigen::Vector3d center_i_;
  Eigen::Matrix3d ray_from_pixel_i_;  // (u, v, 1) -> world ray with z 1
  Eigen::Matrix3d
      pixel_j_from_pixel_i_;  // M: of points at infinity, homogeneous
  Eigen::Vector3d epipole_;   // e: of camera i in j, homogeneous
};

}  // namespace colmap_ext
