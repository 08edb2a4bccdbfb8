#include "cameras/surface_patches.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <span>
#include <utility>

#include "cameras/camera_set.h"
#include "photometry/pair_work.h"

namespace colmap_ext {
namespace {

// Between rays, degrees: beyond it windows of one surface look too different.
constexpr double kMaxAngle = 60;
// Of a window's area in the partner over that in the view, or the inverse.
constexpr double kMaxAreaRatio = 4;
// Pixels of a cell between windows that are tried, per axis: so many a cell.
constexpr int kTrialsPerAxis = 6;

// [height * width] of what was drawn, 1 / scene unit; 0 where nothing was.
std::vector<float> InverseDepths(const DrawnView& i) {
  std::vector<float> depths(i.drawn.facets.size(), 0);
  uint32_t facet = kNone;
  DrawnDepth depth;  // of the facet
  for (int row = 0; row < i.drawn.height; ++row) {
    for (int col = 0; col < i.drawn.width; ++col) {
      const size_t pixel = i.drawn.Index(row, col);
      const uint32_t shown = i.drawn.facets[pixel];
      if (shown == kNone) {
        continue;
      }
      if (shown != std::exchange(facet, shown)) {
        depth = DepthOf(i.view, i.mesh, i.mesh.facets[shown]);
      }
      depths[pixel] = static_cast<float>(depth.At(row, col));
    }
  }
  return depths;
}

// The smaller eigenvalue of the covariance of the grey values' gradient in a
// window, per pixel; negative if the window shows more than one surface, or a
// facet that does not face the camera.
double Texture(const DrawnView& i, const std::vector<float>& depths, int row,
               int col, int radius, float max_relative_depth) {
  const uint32_t facet = i.drawn.facets[i.drawn.Index(row, col)];
  if (facet == kNone || !IsFacing(i.view, i.mesh, i.drawn, facet)) {
    return -1;
  }
  const float center = depths[i.drawn.Index(row, col)];
  double uu = 0;
  double uv = 0;
  double vv = 0;
  for (int y = row - radius; y <= row + radius; ++y) {
    const uint8_t* above = i.image.Row(y - 1);
    const uint8_t* line = i.image.Row(y);
    const uint8_t* below = i.image.Row(y + 1);
    for (int x = col - radius; x <= col + radius; ++x) {
      const float depth = depths[i.drawn.Index(y, x)];
      if (std::abs(depth - center) > max_relative_depth * center ||
          IsSaturated(line[x])) {
        return -1;
      }
      const double by_u = 0.5 * (line[x + 1] - line[x - 1]);
      const double by_v = 0.5 * (below[x] - above[x]);
      uu += by_u * by_u;
      uv += by_u * by_v;
      vv += by_v * by_v;
    }
  }
  const double half = 0.5 * (uu - vv);
  const double eigenvalue = 0.5 * (uu + vv) - std::sqrt(half * half + uv * uv);
  const int side = 2 * radius + 1;
  return eigenvalue / (side * side);
}

// A range of pixels, both ends included.
struct Range {
  int first = 0;
  int last = -1;
};

Range RangeOfCell(int cell, int num_cells, int size, int margin) {
  return {std::max(margin, cell * size / num_cells),
          std::min(size - margin, (cell + 1) * size / num_cells) - 1};
}

// The window of a cell with the most texture; none if it has too little.
std::optional<SurfacePatch> BestOfCell(const DrawnView& i,
                                       const std::vector<float>& depths,
                                       const Range& rows, const Range& cols,
                                       int radius, float max_relative_depth,
                                       double min_texture) {
  std::optional<SurfacePatch> best;
  double best_texture = min_texture;
  const int row_step = std::max(1, (rows.last - rows.first) / kTrialsPerAxis);
  const int col_step = std::max(1, (cols.last - cols.first) / kTrialsPerAxis);
  for (int row = rows.first; row <= rows.last; row += row_step) {
    for (int col = cols.first; col <= cols.last; col += col_step) {
      const double texture =
          Texture(i, depths, row, col, radius, max_relative_depth);
      if (texture > best_texture) {
        best_texture = texture;
        best = SurfacePatch();
        best->row = row;
        best->col = col;
        best->facet = i.drawn.facets[i.drawn.Index(row, col)];
      }
    }
  }
  return best;
}

std::vector<SurfacePatch> PatchesOfView(const PatchOptions& options,
                                        const PhotometricOptions& photometric,
                                        const DrawnScene& scene,
                                        uint32_t view) {
  const auto drawn = scene.buffers.Get(view);
  const auto image = scene.images->Image(view);
  const View& camera = scene.buffers.Views()[view];
  const DrawnView i{camera, *image, *drawn, scene.buffers.Mesh()};
  const std::vector<float> depths = InverseDepths(i);
  const auto num_views = static_cast<int>(scene.buffers.Views().size());
  const int max_patches = std::min(
      options.max_patches_per_view,
      std::max(options.min_patches_per_view, options.max_patches / num_views));
  const double cell =
      std::max(2.0 * options.radius + 1,
               std::sqrt(1.0 * camera.width * camera.height / max_patches));
  const int num_rows = std::max(1, static_cast<int>(camera.height / cell));
  const int num_cols = std::max(1, static_cast<int>(camera.width / cell));
  const int margin = options.radius + 1;
  const float max_depth = MaxRelativeDepth(photometric, camera, options.radius);
  std::vector<SurfacePatch> patches;
  for (int row = 0; row < num_rows; ++row) {
    for (int col = 0; col < num_cols; ++col) {
      std::optional<SurfacePatch> best = BestOfCell(
          i, depths, RangeOfCell(row, num_rows, camera.height, margin),
          RangeOfCell(col, num_cols, camera.width, margin), options.radius,
          max_depth, photometric.noise_variance);
      if (best) {
        best->view = view;
        best->normal = scene.FrameOf(best->facet).normal;
        const size_t pixel = drawn->Index(best->row, best->col);
        best->footprint = 1 / (depths[pixel] * camera.fx);
        patches.push_back(*best);
      }
    }
  }
  return patches;
}

// A view that sees a patch, by the angle between the rays.
using Seeing = std::pair<double, uint32_t>;

// Whether j sees a patch well enough, and from where.
// \param drawn  into j.
std::optional<Seeing> Sees(const DrawnScene& scene, const FacetIdBuffer& drawn,
                           const SurfacePatch& patch,
                           const Eigen::Vector3d& point, uint32_t j,
                           double border) {
  const View& view_i = scene.buffers.Views()[patch.view];
  const View& view_j = scene.buffers.Views()[j];
  const TriangleMesh& mesh = scene.buffers.Mesh();
  const Eigen::Vector3d in_j = view_j.CamFromWorld(point);
  if (!IsFacing(view_j, mesh, drawn, patch.facet) || !(in_j.z() > 0)) {
    return std::nullopt;
  }
  const Eigen::Vector2d pixel = view_j.ImageFromCam(in_j);
  if (!IsWithin(view_j, pixel, border) ||
      !IsNearest(view_j, mesh, drawn, patch.facet,
                 PlaneSlope(view_j, mesh, mesh.facets[patch.facet]), pixel.x(),
                 pixel.y(), 1 / in_j.z())) {
    return std::nullopt;
  }
  const double area =
      std::abs(ComputeShiftJacobian(view_i, view_j, point, patch.normal)
                   .by_pixel_i.determinant());
  const double cosine = (point - view_i.Center())
                            .normalized()
                            .dot((point - view_j.Center()).normalized());
  const double angle = std::acos(std::clamp(cosine, -1.0, 1.0));
  if (!(area < kMaxAreaRatio && area > 1 / kMaxAreaRatio) ||
      angle > kMaxAngle * M_PI / 180) {
    return std::nullopt;
  }
  return Seeing(angle, j);
}

// [patches] those of the others that see each patch of a view. One after the
// other: their buffers may not all be there at a time.
std::vector<std::vector<Seeing>> FindSeeing(
    const DrawnScene& scene, const std::vector<SurfacePatch>& patches,
    const View& view, std::span<const uint32_t> others, double border) {
  std::vector<Eigen::Vector3d> points;
  for (const SurfacePatch& patch : patches) {
    points.push_back(PatchPoint(view, scene.FrameOf(patch.facet), patch));
  }
  std::vector<std::vector<Seeing>> seeing(patches.size());
  for (const uint32_t j : others) {
    const auto drawn = scene.buffers.Get(j);
    for (size_t k = 0; k < patches.size(); ++k) {
      if (const std::optional<Seeing> sees =
              Sees(scene, *drawn, patches[k], points[k], j, border)) {
        seeing[k].push_back(*sees);
      }
    }
  }
  return seeing;
}

// Of those that see the patch, evenly spread over the angles; the nearest is
// one of them.
std::vector<uint32_t> ChoosePartners(std::vector<Seeing> seeing,
                                     size_t max_partners) {
  std::ranges::sort(seeing);
  const size_t count = std::min(seeing.size(), max_partners);
  std::vector<uint32_t> partners;
  for (size_t k = 0; k < count; ++k) {
    partners.push_back(seeing[k * seeing.size() / count].second);
  }
  std::ranges::sort(partners);
  return partners;
}

}  // namespace

SurfacePatches SelectPatches(const PatchOptions& options,
                             const PhotometricOptions& photometric,
                             const DrawnScene& scene,
                             const std::vector<ViewPair>& pairs) {
  const std::vector<View>& views = scene.buffers.Views();
  const auto paired = GroupInRows<uint32_t>(views.size(), [&](const auto& add) {
    for (const auto& [first, second] : pairs) {
      add(first, second);
      add(second, first);
    }
  });
  std::vector<SurfacePatches> by_view(views.size());
  ForEachInOrder(OrderByPartners(paired), [&](uint32_t view) {
    if (paired[view].empty()) {  // its picture may not be there
      return;
    }
    const std::vector<SurfacePatch> found =
        PatchesOfView(options, photometric, scene, view);
    std::vector<std::vector<Seeing>> seeing =
        FindSeeing(scene, found, views[view], paired[view], options.radius + 1);
    for (size_t k = 0; k < found.size(); ++k) {
      if (!seeing[k].empty()) {
        by_view[view].patches.push_back(found[k]);
        by_view[view].partners.AddRow(
            ChoosePartners(std::move(seeing[k]), options.max_partners));
      }
    }
  });
  SurfacePatches all;
  for (const SurfacePatches& of_view : by_view) {
    Append(of_view.patches, &all.patches);
    for (size_t k = 0; k < of_view.partners.size(); ++k) {
      all.partners.AddRow(of_view.partners[k]);
    }
  }
  return all;
}

}  // namespace colmap_ext
