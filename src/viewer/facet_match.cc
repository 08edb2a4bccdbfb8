#include "viewer/shown_mesh.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include <Eigen/Geometry>

#include "base/indices.h"
#include "photometry/pair_warp.h"
#include "photometry/photometric_energy.h"
#include "photometry/window_correlation.h"
#include "raster/facet_id_buffer.h"

namespace colmap_ext {
namespace {

// Side lengths [px] of the patch shown and of the area searched. Chosen by
// hand.
constexpr int kPatchSize = 48;
constexpr int kSearchSize = 256;

// Part of an image with its camera.
struct Crop {
  View view;
  GrayImage image;
};

Eigen::Vector3d CenterOf(const TriangleMesh& mesh, uint32_t facet) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (const uint32_t vertex : mesh.facets[facet]) {
    sum += mesh.vertices[vertex].cast<double>();
  }
  return sum / 3;
}

// Pixels outside of the image are black, which are never compared.
Crop CropAround(const View& view, const GrayImage& image,
                const Eigen::Vector3d& point, int size) {
  const Eigen::Vector2d center = view.ImageFromCam(view.CamFromWorld(point));
  const int first_col = static_cast<int>(std::floor(center.x())) - size / 2;
  const int first_row = static_cast<int>(std::floor(center.y())) - size / 2;
  Crop crop{view, {size, size, {}}};
  crop.view.width = crop.view.height = size;
  crop.view.cx -= first_col;
  crop.view.cy -= first_row;
  for (int row = first_row; row < first_row + size; ++row) {
    for (int col = first_col; col < first_col + size; ++col) {
      const bool is_inside =
          row >= 0 && row < image.height && col >= 0 && col < image.width;
      crop.image.pixels.push_back(is_inside ? image.Row(row)[col] : 0);
    }
  }
  return crop;
}

// Sets the pixels that show the facet as centers; for a facet that is too
// small, the middle pixel, unless it is occluded.
// \param depth  of the facet, scene units
void SetCenters(const FacetIdBuffer& drawn, uint32_t facet, double depth,
                int radius, CorrelationTile* tile) {
  constexpr double kHidden = 1.01;  // of its inverse depth; chosen by hand
  for (int row = 0; row < tile->height; ++row) {
    for (int col = 0; col < tile->width; ++col) {
      const bool is_margin = row < radius || col < radius ||
                             row >= tile->height - radius ||
                             col >= tile->width - radius;
      const size_t i = tile->Index(row, col);
      tile->is_center[i] = !is_margin && drawn.facets[i] == facet ? 1 : 0;
    }
  }
  const size_t middle = tile->Index(tile->height / 2, tile->width / 2);
  if (std::ranges::count(tile->is_center, 1) == 0 &&
      drawn.inverse_depths[middle] * depth < kHidden) {
    tile->is_center[middle] = 1;
  }
}

// Twice the area of a facet in a view, px^2; negative: not visible.
double AreaIn(const View& view, const TriangleMesh& mesh, uint32_t facet) {
  std::array<Eigen::Vector2d, 3> pixels;
  for (int k = 0; k < 3; ++k) {
    const Eigen::Vector3d point =
        view.CamFromWorld(mesh.vertices[mesh.facets[facet][k]].cast<double>());
    if (!(point.z() > 0)) {
      return -1;
    }
    pixels[k] = view.ImageFromCam(point);
  }
  const Eigen::Vector2d a = pixels[1] - pixels[0];
  const Eigen::Vector2d b = pixels[2] - pixels[0];
  return a.y() * b.x() - a.x() * b.y();  // the v axis points down
}

// The pair that "IMAGE IMAGE" names; names may have spaces.
std::optional<ViewPair> PairByNames(const std::string& names,
                                    const std::vector<View>& views) {
  const auto find = [&](const std::string& name) {
    return static_cast<uint32_t>(std::ranges::find(views, name, &View::name) -
                                 views.begin());
  };
  for (size_t space = names.find(' '); space != std::string::npos;
       space = names.find(' ', space + 1)) {
    const uint32_t first = find(names.substr(0, space));
    const uint32_t second = find(names.substr(space + 1));
    if (std::max(first, second) < views.size()) {
      return ViewPair{first, second};
    }
  }
  return std::nullopt;
}

}  // namespace

std::vector<uint32_t> ViewsOfFacet(const ShownMesh& mesh, uint32_t facet) {
  std::vector<uint32_t> views;
  for (const uint32_t vertex : mesh.mesh.facets[facet]) {
    if (vertex < mesh.views.size()) {
      const auto row = mesh.views[vertex];
      views.insert(views.end(), row.begin(), row.end());
    }
  }
  SortUnique(&views);
  return views;
}

std::optional<ViewPair> PairOfFacet(const ShownMesh& mesh, uint32_t facet,
                                    const std::vector<View>& views) {
  if (facet < mesh.labels.size() && mesh.labels[facet] >= 0 &&
      static_cast<size_t>(mesh.labels[facet]) < mesh.label_names.size()) {
    return PairByNames(mesh.label_names[mesh.labels[facet]], views);
  }
  std::vector<std::pair<double, uint32_t>> by_area;
  for (const uint32_t view : ViewsOfFacet(mesh, facet)) {
    if (view < views.size()) {
      by_area.emplace_back(-AreaIn(views[view], mesh.mesh, facet), view);
    }
  }
  if (by_area.size() < 2) {
    return std::nullopt;
  }
  std::ranges::partial_sort(by_area, by_area.begin() + 2);
  return ViewPair{by_area[0].second, by_area[1].second};
}

FacetMatch MatchFacet(const TriangleMesh& mesh, uint32_t facet,
                      const View& first, const GrayImage& first_image,
                      const View& second, const GrayImage& second_image) {
  const PhotometricOptions options;
  const Eigen::Vector3d center = CenterOf(mesh, facet);
  if (!(first.CamFromWorld(center).z() > 0) ||
      !(second.CamFromWorld(center).z() > 0)) {
    return {};
  }
  const Crop i = CropAround(first, first_image, center, kPatchSize);
  const Crop j = CropAround(second, second_image, center, kSearchSize);
  const FacetIdBuffer drawn_i = DrawFacets(i.view, mesh, options.min_cosine);
  const FacetIdBuffer drawn_j = DrawFacets(j.view, mesh, options.min_cosine);
  CorrelationTile tile;
  TileGeometry geometry;
  tile.Resize(kPatchSize, kPatchSize);
  SetCenters(drawn_i, facet, first.CamFromWorld(center).z(),
             options.window_radius, &tile);
  std::ranges::fill(tile.is_reached, 1);  // All of it is shown.
  PairWarp({i.view, i.image, drawn_i}, {j.view, j.image, drawn_j}, mesh)
      .Compute(&tile, &geometry);
  FacetMatch match{i.image, {kPatchSize, kPatchSize, {}}, std::nullopt};
  for (size_t k = 0; k < tile.warped.size(); ++k) {
    match.warped.pixels.push_back(tile.is_valid[k] > 0
                                      ? static_cast<uint8_t>(std::clamp(
                                            tile.warped[k] + 0.5F, 0.F, 255.F))
                                      : 0);
  }
  WindowCorrelation(options).Compute(MaxRelativeDepth(options, i.view), &tile);
  const double energy =
      std::accumulate(tile.energies.begin(), tile.energies.end(), 0.0);
  const double weight =
      std::accumulate(tile.weights.begin(), tile.weights.end(), 0.0);
  if (weight > 0) {
    match.zncc = MeanZncc(energy, weight, options);
  }
  return match;
}

}  // namespace colmap_ext
