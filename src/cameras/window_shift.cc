#include "cameras/surface_patches.h"

#include <algorithm>
#include <cmath>
#include <set>

#include "photometry/pair_work.h"

namespace colmap_ext {
namespace {

// The planes of the facets that a window shows, displaced with its patch, and
// what they show in j (docs/method.md, section 5.2).
class DisplacedWarp {
 public:
  DisplacedWarp(const DrawnView& i, const DrawnView& j,
                const SurfacePatch& patch)
      : i_(i),
        j_(j),
        offset_(patch.displacement * patch.footprint * patch.normal),
        pair_(i.view, j.view) {}

  // Sets the facet of the next calls.
  void SetFacet(uint32_t facet) {
    if (facet == facet_) {
      return;
    }
    const Facet& corners = i_.mesh.facets[facet];
    const FacetFrame frame = ComputeFacetFrame(i_.mesh, corners);
    facet_ = facet;
    is_facing_ = IsFacing(i_.view, i_.mesh, i_.drawn, facet) &&
                 IsFacing(j_.view, j_.mesh, j_.drawn, facet);
    const double distance = frame.normal.dot(frame.corner - pair_.center_i);
    const double displaced = distance + frame.normal.dot(offset_);
    inverse_depth_ =
        (pair_.ray_from_pixel_i.transpose() * frame.normal) / displaced;
    drawn_factor_ = displaced / distance;
    slope_ = PlaneSlope(j_.view, j_.mesh, corners);
  }

  // The inverse depth in i of the facet's plane as it was drawn.
  double DrawnDepth(int row, int col) const {
    return drawn_factor_ *
           inverse_depth_.dot(Eigen::Vector3d(col + 0.5, row + 0.5, 1));
  }

  // \return whether j sees what the pixel shows
  bool Sample(int row, int col, Interpolated* sample) const {
    const Eigen::Vector3d pixel(col + 0.5, row + 0.5, 1);
    const double inverse_depth = inverse_depth_.dot(pixel);
    const Eigen::Vector3d p =
        pair_.pixel_j_from_pixel_i * pixel + pair_.epipole * inverse_depth;
    if (!is_facing_ || !(inverse_depth > 0) || !(p.z() > 0)) {
      return false;
    }
    const double u = p.x() / p.z();
    const double v = p.y() / p.z();
    if (!IsWithin(j_.view, {u, v}, 0.5) ||
        !IsNearest(j_.view, j_.mesh, j_.drawn, facet_, slope_, u, v,
                   inverse_depth / p.z())) {
      return false;
    }
    *sample = Interpolate(j_.image, u, v);
    return true;
  }

 private:
  const DrawnView& i_;
  const DrawnView& j_;
  Eigen::Vector3d offset_;  // of the patch, scene units
  PairGeometry pair_;
  // Of the facet.
  uint32_t facet_ = kNone;
  bool is_facing_ = false;
  Eigen::Vector3d inverse_depth_;  // by (u, v, 1) in i
  double drawn_factor_ = 1;        // the drawn inverse depth over it
  double slope_ = 0;               // in j, see PlaneSlope()
};

// Sums over a window's pixels of I, J and the gradient (u, v) of J.
struct WindowSums {
  int count = 0;
  // Rows and columns: 1, I, J, J_u, J_v.
  Eigen::Matrix<double, 5, 5> products = Eigen::Matrix<double, 5, 5>::Zero();

  void Add(double image, const Interpolated& warped) {
    Eigen::Matrix<double, 5, 1> values;
    values << 1, image, warped.value, warped.by_u, warped.by_v;
    products.noalias() += values * values.transpose();
    ++count;
  }
};

// With c = covariance sums, |I|^2 = c_II and so on:
//   G = (grad J - mean - n_J (n_J . grad J)) / |J|,   r = n_J - n_I,
//   G^T r = -(c_Ig / |I| - Z c_Jg / |J|) / |J|,
//   G^T G = (c_gg - c_Jg c_Jg^T / c_JJ) / c_JJ.
WindowShift Correlate(const WindowSums& sums) {
  const Eigen::Matrix<double, 5, 5>& products = sums.products;
  const Eigen::Matrix4d c = products.bottomRightCorner<4, 4>() -
                            products.bottomLeftCorner<4, 1>() *
                                products.topRightCorner<1, 4>() / sums.count;
  WindowShift shift;
  shift.num_pixels = sums.count;
  const double min_sum = sums.count * static_cast<double>(kMinVariance);
  if (!(c(0, 0) > min_sum && c(1, 1) > min_sum)) {
    return shift;
  }
  const double norm_i = std::sqrt(c(0, 0));
  const double norm_j = std::sqrt(c(1, 1));
  const Eigen::Vector2d image_gradient = c.bottomLeftCorner<2, 1>();
  const Eigen::Vector2d warped_gradient = c.block<2, 1>(2, 1);
  shift.is_valid = true;
  shift.zncc = c(0, 1) / (norm_i * norm_j);
  shift.slope =
      -(image_gradient / norm_i - shift.zncc * warped_gradient / norm_j) /
      norm_j;
  shift.curvature = (c.bottomRightCorner<2, 2>() -
                     warped_gradient * warped_gradient.transpose() / c(1, 1)) /
                    c(1, 1);
  return shift;
}

}  // namespace

Eigen::Vector3d PatchPoint(const View& view, const FacetFrame& frame,
                           const SurfacePatch& patch) {
  const Eigen::Vector3d center = view.Center();
  const Eigen::Vector3d ray =
      view.RayFromPixel() *
      Eigen::Vector3d(patch.col + 0.5, patch.row + 0.5, 1);
  const Eigen::Vector3d corner =
      frame.corner + patch.displacement * patch.footprint * patch.normal;
  return center +
         frame.normal.dot(corner - center) / frame.normal.dot(ray) * ray;
}

WindowShift CompareWindow(const PhotometricOptions& options, int radius,
                          const DrawnView& i, const DrawnView& j,
                          const SurfacePatch& patch) {
  DisplacedWarp warp(i, j, patch);
  warp.SetFacet(patch.facet);
  const double center = warp.DrawnDepth(patch.row, patch.col);
  const double max_difference =
      MaxRelativeDepth(options, i.view, radius) * center;
  // Correlation does not depend on means; without them less is lost to
  // rounding.
  const double mean = i.image.Row(patch.row)[patch.col];
  WindowSums sums;
  for (int row = patch.row - radius; row <= patch.row + radius; ++row) {
    const uint8_t* line = i.image.Row(row);
    for (int col = patch.col - radius; col <= patch.col + radius; ++col) {
      const uint32_t facet = i.drawn.facets[i.drawn.Index(row, col)];
      if (facet == kNone || IsSaturated(line[col])) {
        continue;
      }
      warp.SetFacet(facet);
      Interpolated sample;
      if (std::abs(warp.DrawnDepth(row, col) - center) <= max_difference &&
          warp.Sample(row, col, &sample)) {
        sample.value -= static_cast<float>(mean);
        sums.Add(line[col] - mean, sample);
      }
    }
  }
  const int side = 2 * radius + 1;
  return 2 * sums.count > side * side ? Correlate(sums) : WindowShift();
}

std::vector<WindowShift> ComparePatches(const PhotometricOptions& photometric,
                                        int radius, const DrawnScene& scene,
                                        const std::vector<View>& views,
                                        const SurfacePatches& patches) {
  std::vector<std::set<uint32_t>> partners_of(views.size());
  for (size_t k = 0; k < patches.patches.size(); ++k) {
    partners_of[patches.patches[k].view].insert(patches.partners[k].begin(),
                                                patches.partners[k].end());
  }
  Rows<uint32_t> partners;
  for (const std::set<uint32_t>& row : partners_of) {
    partners.AddRow(row);
  }
  std::vector<ViewPair> order;
  for (const uint32_t view : OrderByPartners(partners)) {
    for (const uint32_t partner : partners[view]) {
      order.push_back({view, partner});
    }
  }
  std::vector<WindowShift> shifts(patches.partners.values.size());
  // Two views at a time: not all of a view's partners may fit into memory.
  ForEachInOrder(order, [&](const ViewPair& pair) {
    const auto [i, j] = pair;
    const auto image_i = scene.images->Image(i);
    const auto image_j = scene.images->Image(j);
    const auto drawn_i = scene.buffers.Get(i);
    const auto drawn_j = scene.buffers.Get(j);
    const TriangleMesh& mesh = scene.buffers.Mesh();
    const DrawnView view_i{views[i], *image_i, *drawn_i, mesh};
    const DrawnView view_j{views[j], *image_j, *drawn_j, mesh};
    for (size_t k = std::ranges::lower_bound(patches.patches, i, {},
                                             &SurfacePatch::view) -
                    patches.patches.begin();
         k < patches.patches.size() && patches.patches[k].view == i; ++k) {
      const auto row = patches.partners[k];
      const auto found = std::ranges::find(row, j);
      if (found != row.end()) {
        shifts[patches.partners.offsets[k] + (found - row.begin())] =
            CompareWindow(photometric, radius, view_i, view_j,
                          patches.patches[k]);
      }
    }
  });
  return shifts;
}

}  // namespace colmap_ext
