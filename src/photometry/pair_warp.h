#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include <Eigen/Core>

#include "mesh/triangle_mesh.h"
#include "photometry/window_correlation.h"
#include "raster/facet_id_buffer.h"
#include "scene/images.h"
#include "scene/view.h"

namespace colmap_ext {

// An image between its pixels' centres, and its gradient.
struct Interpolated {
  float value = 0;  // grey value
  float by_u = 0;   // grey values / px
  float by_v = 0;   // grey values / px
};

// Bicubic [Catmull1974], as bilinear interpolation blurs. Beyond the border,
// the border pixels are repeated.
// \param u, v  pixel coordinates, px, see View.
// \pre (u, v) is not outside of the border pixels' centres
Interpolated Interpolate(const GrayImage& image, double u, double v);

// A view, its image, and a mesh drawn into it. References are kept.
struct DrawnView {
  const View& view;
  const GrayImage& image;
  const FacetIdBuffer& drawn;
  const TriangleMesh& mesh;
};

// What a pixel (u, v, 1) of view i with the inverse depth w, in units of the
// depth in i, is seen at in view j: M (u, v, 1) + e w, homogeneous
// (docs/method.md, section 5.2).
struct PairGeometry {
  PairGeometry(const View& i, const View& j);

  Eigen::Vector3d center_i;
  Eigen::Matrix3d ray_from_pixel_i;      // (u, v, 1) -> world ray with z 1
  Eigen::Matrix3d pixel_j_from_pixel_i;  // M: of points at infinity
  Eigen::Vector3d epipole;               // e: of camera i in j
};

// Where the pixels of a tile lie on the surface.
struct TileGeometry {
  int first_row = 0;  // of the tile in image i, may be negative
  int first_col = 0;
  std::vector<uint32_t> facets;  // [height * width] or kNone
  // [height * width] grey values / scene unit: derivative of I_ij by the
  // distance that the surface moves along its normal, mu of docs/method.md,
  // section 5.2; 0 where it is not valid.
  std::vector<float> motion;
  // [height * width] barycentric coordinates on the facet, where it is valid.
  std::vector<std::array<float, 3>> barycentric;
};

// Image I_j seen from i by way of the surface (docs/method.md, section 5.2).
class PairWarp {
 public:
  // \param mesh  as it is at present; kept by reference.
  PairWarp(const DrawnView& i, const DrawnView& j, const TriangleMesh& mesh);

  // Fills the tile's image, warped image, validity and inverse depths, and the
  // geometry's arrays, of tile.width and height from geometry.first_row and
  // first_col on. A pixel is valid if a window reaches it, it is not saturated
  // in i, its facet faced both cameras when the mesh was drawn, and in the
  // facet's present position the inverse depth is positive and j sees the
  // point: nothing is drawn there in front of it.
  void Compute(CorrelationTile* tile, TileGeometry* geometry) const;

 private:
  // What the pixels of a facet have in common. Vectors are linear forms of a
  // pixel (u, v, 1) of i.
  struct Plane {
    uint32_t facet = kNone;
    bool is_facing = false;  // both cameras
    Eigen::Vector3d inverse_depth{0, 0, 0};
    double nearness = 0;  // 1 / (n . (corner - centre of i)), 1 / scene unit
    double slope = 0;     // in j, see PlaneSlope()
    DrawnDepth drawn{};   // in i
    // The barycentric coordinates of the second and third corner at the centre
    // of i, and by how much they change with the depth.
    std::array<double, 2> barycentric{};
    std::array<Eigen::Vector3d, 2> barycentric_by_depth{};
  };

  // What the pixels of a row have in common.
  struct Row {
    int row;            // of the tile
    double v;           // px
    Eigen::Vector3d p;  // M (0, v, 1)
  };

  void ComputeRow(int row, int first_col, int last_col,
                  const std::vector<Plane>& planes,
                  const std::vector<uint32_t>& places, CorrelationTile* tile,
                  TileGeometry* geometry) const;
  void ComputePixel(const Row& row, int col, const Plane& plane,
                    CorrelationTile* tile, TileGeometry* geometry) const;
  void FindPlaces(int row, int first_col, int last_col,
                  const CorrelationTile& tile, const TileGeometry& geometry,
                  std::vector<uint32_t>* facets,
                  std::vector<uint32_t>* places) const;
  Plane PlaneOf(uint32_t facet) const;

  DrawnView i_;
  DrawnView j_;
  const TriangleMesh& mesh_;
  PairGeometry pair_;
};

}  // namespace colmap_ext
