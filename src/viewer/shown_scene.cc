#include "viewer/shown_scene.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <unordered_map>

#include "base/indices.h"
#include "base/mix_bits.h"
#include "mesh/normals.h"
#include "photometry/pair_warp.h"
#include "photometry/photometric_energy.h"
#include "photometry/window_correlation.h"
#include "pictures/pictures.h"
#include "raster/facet_id_buffer.h"

namespace colmap_ext {
namespace {

uint32_t Pack(const Color& color) {
  return color[0] | color[1] << 8 | color[2] << 16 | 0xFF000000U;
}

template <typename Value, typename Function>
std::vector<uint32_t> PackAll(const std::vector<Value>& values,
                              const Function& color_of) {
  std::vector<uint32_t> packed;
  packed.reserve(values.size());
  for (const Value& value : values) {
    packed.push_back(Pack(color_of(value)));
  }
  return packed;
}

double AreaOf(const TriangleMesh& mesh) {
  double area = 0;
  for (const Facet& facet : mesh.facets) {
    area += 0.5 * AreaVector(mesh, facet).norm();
  }
  return area;
}

// [V] the first vertex in the same cube of a grid.
std::vector<uint32_t> FirstInCube(const TriangleMesh& mesh, double side) {
  std::vector<uint32_t> firsts;
  firsts.reserve(mesh.vertices.size());
  std::unordered_map<uint64_t, uint32_t> first_of_cube;
  for (uint32_t i = 0; i < mesh.vertices.size(); ++i) {
    uint64_t key = 0;
    for (int axis = 0; axis < 3; ++axis) {
      const auto place =
          static_cast<int64_t>(std::floor(mesh.vertices[i][axis] / side));
      key = MixBits(key ^ static_cast<uint64_t>(place));
    }
    firsts.push_back(first_of_cube.try_emplace(key, i).first->second);
  }
  return firsts;
}

// Side lengths [px] of the patch shown and of the area searched. Choices.
constexpr int kPatchSize = 48;
constexpr int kSearchSize = 256;

// Part of an image with its camera.
struct Crop {
  View view;
  GrayImage image;
};

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
void SetCenters(const DrawnFacets& drawn, uint32_t facet, double depth,
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

const char* NameOf(MeshMode mode) {
  constexpr const char* kNames[] = {"shaded", "color", "normals",
                                    "labels", "error", "confidence"};
  return kNames[static_cast<int>(mode)];
}

MeshColors ColorsByMode(const ShownMesh& mesh, MeshMode mode) {
  // Shading of colors of a scale, so that the shape stays visible. A choice.
  constexpr float kHalf = 0.5F;
  if (!MissingData(mesh, mode).empty()) {
    return {};
  }
  switch (mode) {
    case MeshMode::kShaded:
      return {};
    case MeshMode::kColor:
      return {ColorsOf::kVertices, PackAll(mesh.colors, std::identity()), 0};
    case MeshMode::kNormals:
      return {ColorsOf::kNormals, {}, 0};
    case MeshMode::kLabels:
      return {ColorsOf::kFacets, PackAll(mesh.labels, LabelColor), 1};
    case MeshMode::kErrors:
      return {ColorsOf::kVertices, PackAll(mesh.error_colors, std::identity()),
              kHalf};
    case MeshMode::kConfidence:
      return {
          ColorsOf::kVertices,
          PackAll(mesh.confidences,
                  [](float confidence) { return ErrorColor(confidence, 1); }),
          kHalf};
  }
  return {};
}

std::string MissingData(const ShownMesh& mesh, MeshMode mode) {
  if (mode == MeshMode::kColor && mesh.colors.empty()) {
    return mesh.name + " has no vertex colors";
  }
  if (mode == MeshMode::kLabels && mesh.labels.empty()) {
    return mesh.name +
           " has no labels; facetwise_refiner --labels_path writes them";
  }
  if (mode == MeshMode::kErrors && mesh.error_colors.empty()) {
    return mesh.name +
           " has no errors; mesh_evaluator --error_mesh_path writes them";
  }
  if (mode == MeshMode::kConfidence && mesh.confidences.empty()) {
    return mesh.name + " has no confidences";
  }
  return "";
}

ShownMesh CoarseMesh(const ShownMesh& mesh, size_t max_facets) {
  // Two facets for a square of a cube's side.
  const double side =
      std::sqrt(2 * AreaOf(mesh.mesh) / static_cast<double>(max_facets));
  const std::vector<uint32_t> firsts =
      FirstInCube(mesh.mesh, side > 0 ? side : 1);
  ShownMesh coarse;
  coarse.name = mesh.name;
  coarse.mesh.vertices = mesh.mesh.vertices;
  for (uint32_t i = 0; i < mesh.mesh.facets.size(); ++i) {
    const auto& [a, b, c] = mesh.mesh.facets[i];
    const Facet facet = {firsts[a], firsts[b], firsts[c]};
    if (!RepeatsVertex(facet)) {
      coarse.mesh.facets.push_back(facet);
      AppendIfAny(mesh.labels, i, &coarse.labels);
    }
  }
  for (const uint32_t vertex : DropUnusedVertices(&coarse.mesh)) {
    AddAttributes(mesh, vertex, &coarse);
    AppendIfAny(mesh.error_colors, vertex, &coarse.error_colors);
  }
  coarse.mesh.vertices.shrink_to_fit();
  return coarse;
}

std::vector<uint32_t> ViewsOfFacet(const ShownMesh& mesh, uint32_t facet) {
  std::vector<uint32_t> views;
  for (const uint32_t vertex : mesh.mesh.facets[facet]) {
    if (vertex < mesh.views.size()) {
      Append(mesh.views[vertex], &views);
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
  const auto [a, b, c] = CornersOf<double>(mesh, mesh.facets[facet]);
  const Eigen::Vector3d center = (a + b + c) / 3;
  if (!(first.CamFromWorld(center).z() > 0) ||
      !(second.CamFromWorld(center).z() > 0)) {
    return {};
  }
  const Crop i = CropAround(first, first_image, center, kPatchSize);
  const Crop j = CropAround(second, second_image, center, kSearchSize);
  const DrawnFacets drawn_i = DrawFacets(i.view, mesh, options.min_cosine);
  const DrawnFacets drawn_j = DrawFacets(j.view, mesh, options.min_cosine);
  CorrelationTile tile;
  TileGeometry geometry;
  tile.Resize(kPatchSize, kPatchSize);
  SetCenters(drawn_i, facet, first.CamFromWorld(center).z(),
             options.window_radius, &tile);
  std::ranges::fill(tile.is_reached, 1);  // All of it is shown.
  PairWarp({i.view, i.image, drawn_i, mesh}, {j.view, j.image, drawn_j, mesh},
           mesh)
      .Compute(&tile, &geometry);
  FacetMatch match{i.image, {kPatchSize, kPatchSize, {}}, std::nullopt};
  for (size_t k = 0; k < tile.warped.size(); ++k) {
    match.warped.pixels.push_back(tile.is_valid[k] > 0
                                      ? static_cast<uint8_t>(std::clamp(
                                            tile.warped[k] + 0.5F, 0.F, 255.F))
                                      : 0);
  }
  WindowCorrelation(options).Compute(
      MaxRelativeDepth(options, i.view, options.window_radius), &tile);
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
