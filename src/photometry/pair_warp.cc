#include "photometry/pair_warp.h"

#include <algorithm>
#include <cstddef>
#include <cstring>

namespace colmap_ext {
namespace {

// Four values side by side (GCC and Clang).
using Float4 = float __attribute__((vector_size(16)));
using Byte4 = uint8_t __attribute__((vector_size(4)));

// Weights of the four samples around a point a fraction `x` behind the second
// one [Catmull1974].
Float4 CubicWeights(float x) {
  constexpr Float4 kCubed{-0.5F, 1.5F, -1.5F, 0.5F};
  constexpr Float4 kSquared{1, -2.5F, 2, -0.5F};
  constexpr Float4 kLinear{-0.5F, 0, 0.5F, 0};
  constexpr Float4 kConstant{0, 1, 0, 0};
  return ((kCubed * x + kSquared) * x + kLinear) * x + kConstant;
}

// Their derivatives by x.
Float4 CubicSlopes(float x) {
  constexpr Float4 kSquared{-1.5F, 4.5F, -4.5F, 1.5F};
  constexpr Float4 kLinear{2, -5, 4, -1};
  constexpr Float4 kConstant{-0.5F, 0, 0.5F, 0};
  return (kSquared * x + kLinear) * x + kConstant;
}

Float4 Grays(const uint8_t* pixels) {
  Byte4 bytes;
  std::memcpy(&bytes, pixels, sizeof(bytes));
  return __builtin_convertvector(bytes, Float4);
}

float Sum(Float4 values) {
  return (values[0] + values[2]) + (values[1] + values[3]);
}

// The sixteen pixels from (row, col) on, of which the image need not have all.
void CopyClamped(const GrayImage& image, int row, int col,
                 std::array<uint8_t, 16>* pixels) {
  for (int k = 0; k < 4; ++k) {
    const uint8_t* line = image.Row(std::clamp(row + k, 0, image.height - 1));
    for (int l = 0; l < 4; ++l) {
      (*pixels)[4 * k + l] = line[std::clamp(col + l, 0, image.width - 1)];
    }
  }
}

}  // namespace

Interpolated Interpolate(const GrayImage& image, double u, double v) {
  const int col = std::min(static_cast<int>(u - 0.5), image.width - 2);
  const int row = std::min(static_cast<int>(v - 0.5), image.height - 2);
  std::array<uint8_t, 16> copy;
  const uint8_t* pixels = copy.data();
  ptrdiff_t stride = 4;
  if (col >= 1 && row >= 1 && col + 2 < image.width && row + 2 < image.height) {
    pixels = image.Row(row - 1) + col - 1;
    stride = image.width;
  } else {
    CopyClamped(image, row - 1, col - 1, &copy);
  }
  const auto x = static_cast<float>(u - 0.5 - col);
  const auto y = static_cast<float>(v - 0.5 - row);
  const Float4 by_row = CubicWeights(y);
  const Float4 slopes_by_row = CubicSlopes(y);
  Float4 values{};  // of the four columns
  Float4 slopes{};
  for (int k = 0; k < 4; ++k) {
    const Float4 grays = Grays(pixels + k * stride);
    values += by_row[k] * grays;
    slopes += slopes_by_row[k] * grays;
  }
  const Float4 by_col = CubicWeights(x);
  return {Sum(by_col * values), Sum(CubicSlopes(x) * values),
          Sum(by_col * slopes)};
}

PairGeometry::PairGeometry(const View& i, const View& j)
    : center_i(i.Center()),
      ray_from_pixel_i(i.RayFromPixel()),
      pixel_j_from_pixel_i(j.PixelFromRay() * ray_from_pixel_i),
      epipole(j.PixelFromRay() * (center_i - j.Center())) {}

PairWarp::PairWarp(const DrawnView& i, const DrawnView& j,
                   const TriangleMesh& mesh)
    : i_(i), j_(j), mesh_(mesh), pair_(i.view, j.view) {}

PairWarp::Plane PairWarp::PlaneOf(uint32_t facet) const {
  const FacetFrame frame = ComputeFacetFrame(mesh_, mesh_.facets[facet]);
  const Eigen::Vector3d from_corner = pair_.center_i - frame.corner;
  const Eigen::Matrix3d pixel_from_ray = pair_.ray_from_pixel_i.transpose();
  Plane plane;
  plane.facet = facet;
  plane.is_facing = IsFacing(i_.view, i_.mesh, i_.drawn, facet) &&
                    IsFacing(j_.view, j_.mesh, j_.drawn, facet);
  plane.nearness = -1 / frame.normal.dot(from_corner);
  plane.inverse_depth = plane.nearness * (pixel_from_ray * frame.normal);
  plane.slope = PlaneSlope(j_.view, mesh_, mesh_.facets[facet]);
  plane.drawn = DepthOf(i_.view, i_.mesh, i_.mesh.facets[facet]);
  plane.barycentric = {frame.gradient_1.dot(from_corner),
                       frame.gradient_2.dot(from_corner)};
  plane.barycentric_by_depth = {pixel_from_ray * frame.gradient_1,
                                pixel_from_ray * frame.gradient_2};
  return plane;
}

// Gives the pixels of a row that may be valid places in a list of the tile's
// facets, to which it appends those that are new. A facet that is shown beside
// or above a pixel too has its place already, as a rule; else it gets another.
// \param places  [width] in: of the row above, out: of this row.
void PairWarp::FindPlaces(int row, int first_col, int last_col,
                          const CorrelationTile& tile,
                          const TileGeometry& geometry,
                          std::vector<uint32_t>* facets,
                          std::vector<uint32_t>* places) const {
  const int image_row = geometry.first_row + row;
  const FacetIds& shown = i_.drawn.facets;
  const size_t first = i_.drawn.Index(image_row, geometry.first_col);
  const size_t first_above = first - i_.drawn.width;
  const uint8_t* grays = i_.image.Row(image_row) + geometry.first_col;
  const uint8_t* is_reached = tile.is_reached.data() + tile.Index(row, 0);
  uint32_t left = kNone;
  uint32_t above_left = kNone;
  for (int col = first_col; col <= last_col; ++col) {
    const uint32_t above = (*places)[col];
    const uint32_t above_right = col < last_col ? (*places)[col + 1] : kNone;
    const uint32_t facet = shown[first + col];
    uint32_t place = kNone;
    if (is_reached[col] != 0 && facet != kNone && !IsSaturated(grays[col])) {
      if (left != kNone && shown[first + col - 1] == facet) {
        place = left;
      } else if (above != kNone && shown[first_above + col] == facet) {
        place = above;
      } else if (above_left != kNone && shown[first_above + col - 1] == facet) {
        place = above_left;
      } else if (above_right != kNone &&
                 shown[first_above + col + 1] == facet) {
        place = above_right;
      } else {
        place = static_cast<uint32_t>(facets->size());
        facets->push_back(facet);
        __builtin_prefetch(&mesh_.facets[facet]);  // Of all new ones at a time.
      }
    }
    above_left = above;
    left = place;
    (*places)[col] = place;
  }
}

void PairWarp::ComputePixel(const Row& row, int col, const Plane& plane,
                            CorrelationTile* tile,
                            TileGeometry* geometry) const {
  const double u_i = geometry->first_col + col + 0.5;
  const auto value_of = [&](const Eigen::Vector3d& form) {
    return form.x() * u_i + (form.y() * row.v + form.z());
  };
  const double inverse_depth = value_of(plane.inverse_depth);
  const Eigen::Vector3d ray_in_j =
      pair_.pixel_j_from_pixel_i.col(0) * u_i + row.p;
  const Eigen::Vector3d p = ray_in_j + pair_.epipole * inverse_depth;
  if (!plane.is_facing || !(inverse_depth > 0) || !(p.z() > 0)) {
    return;
  }
  const double scale = 1 / p.z();
  const double u = p.x() * scale;
  const double v = p.y() * scale;
  if (!IsWithin(j_.view, {u, v}, 0.5) ||
      !IsNearest(j_.view, j_.mesh, j_.drawn, plane.facet, plane.slope, u, v,
                 inverse_depth * scale)) {
    return;
  }
  const Interpolated sample = Interpolate(j_.image, u, v);
  const size_t at = tile->Index(row.row, col);
  geometry->facets[at] = plane.facet;
  geometry->motion[at] =
      static_cast<float>((sample.by_u * (ray_in_j.x() - u * ray_in_j.z()) +
                          sample.by_v * (ray_in_j.y() - v * ray_in_j.z())) *
                         scale * plane.nearness);
  const double depth = 1 / inverse_depth;
  const auto second = static_cast<float>(
      plane.barycentric[0] + depth * value_of(plane.barycentric_by_depth[0]));
  const auto third = static_cast<float>(
      plane.barycentric[1] + depth * value_of(plane.barycentric_by_depth[1]));
  geometry->barycentric[at] = {1 - second - third, second, third};
  tile->warped[at] = sample.value;
  tile->is_valid[at] = 1;
}

void PairWarp::ComputeRow(int row, int first_col, int last_col,
                          const std::vector<Plane>& planes,
                          const std::vector<uint32_t>& places,
                          CorrelationTile* tile, TileGeometry* geometry) const {
  const int image_row = geometry->first_row + row;
  const double v = image_row + 0.5;
  const Row of_row{row, v,
                   pair_.pixel_j_from_pixel_i.col(1) * v +
                       pair_.pixel_j_from_pixel_i.col(2)};
  const uint8_t* grays = i_.image.Row(image_row) + geometry->first_col;
  for (int col = first_col; col <= last_col; ++col) {
    if (places[col] == kNone) {
      continue;
    }
    const Plane& plane = planes[places[col]];
    ComputePixel(of_row, col, plane, tile, geometry);
    const size_t at = tile->Index(row, col);
    if (tile->is_valid[at] > 0) {
      tile->image[at] = grays[col];
      // As drawn, so that no mask changes as the surface moves.
      tile->inverse_depths[at] = static_cast<float>(
          plane.drawn.At(image_row, geometry->first_col + col));
    }
  }
}

void PairWarp::Compute(CorrelationTile* tile, TileGeometry* geometry) const {
  const size_t size = static_cast<size_t>(tile->width) * tile->height;
  geometry->facets.assign(size, kNone);
  geometry->motion.assign(size, 0);
  geometry->barycentric.resize(size);
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
  std::vector<uint32_t> facets;
  std::vector<Plane> planes;  // [facets]
  std::vector<uint32_t> places(tile->width, kNone);
  for (int row = first_row; row <= last_row; ++row) {
    FindPlaces(row, first_col, last_col, *tile, *geometry, &facets, &places);
    while (planes.size() < facets.size()) {
      planes.push_back(PlaneOf(facets[planes.size()]));
    }
    ComputeRow(row, first_col, last_col, planes, places, tile, geometry);
  }
}

}  // namespace colmap_ext
