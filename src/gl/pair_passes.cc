#include "gl/pair_passes.h"

#include <algorithm>
#include <array>
#include <string>

#include "photometry/pair_warp.h"
#include "photometry/window_correlation.h"

namespace colmap_ext {
namespace {

// px; a tile's pixels are the threads of a workgroup. A choice: OpenGL 4.5 is
// sure to have workgroups of 1024.
constexpr int kTileWidth = 32;
constexpr int kTileHeight = 16;

// The shaders' buffers.
enum StorageBinding : GLuint {
  kDrawnVertices = 0,
  kFacets = 1,
  kNormals = 2,
  kChosenFacets = 3,
  kLabelStamps = 4,
  kTiles = 5,
  kTileStamps = 6,
  kVertices = 7,
  kSums = 8,
  kFacingI = 9,
  kFacingJ = 10,
};

// Parts of buffers begin at multiples of so many numbers: 256 bytes, the most
// that OpenGL 4.5 may ask for.
constexpr size_t kAlignedNumbers = 64;

constexpr size_t kTileListHeader = 4;  // numbers before the tiles

ShaderConstants TileConstants(const PhotometricOptions& options) {
  return {{"kTileWidth", kTileWidth},
          {"kTileHeight", kTileHeight},
          {"kWindowRadius", options.window_radius}};
}

// Of the direction, in the part of chosen_facets that is bound for it.
unsigned int FirstFacet(const PairDirection& direction) {
  return static_cast<unsigned int>(direction.first_facet % kAlignedNumbers);
}

Eigen::Vector2i Size(const View& view) { return {view.width, view.height}; }

int NumTileColumns(const View& view) {
  return (view.width + kTileWidth - 1) / kTileWidth;
}

size_t NumTiles(const View& view) {
  const int num_rows = (view.height + kTileHeight - 1) / kTileHeight;
  return static_cast<size_t>(NumTileColumns(view)) * num_rows;
}

void CheckNumGroups(size_t num_groups) {
  GLint max_groups = 0;
  glGetIntegeri_v(GL_MAX_COMPUTE_WORK_GROUP_COUNT, 0, &max_groups);
  if (num_groups > static_cast<size_t>(max_groups)) {
    throw GlError("An image is too large for this OpenGL: it has " +
                  std::to_string(num_groups) + " tiles, of " +
                  std::to_string(max_groups));
  }
}

}  // namespace

PairPasses::PairPasses(const PhotometricOptions& options,
                       const GlLimits& limits)
    : options_(options),
      limits_(limits),
      find_tiles_({"find_tiles.comp"}, TileConstants(options)),
      warp_({"warp.comp"}, TileConstants(options)),
      correlate_({"correlate.comp"}, TileConstants(options)),
      differentiate_({"differentiate.comp"}, TileConstants(options)),
      gather_({"gather.comp"}) {}

size_t PairPasses::Memory(const std::vector<View>& views) {
  constexpr size_t kBytesPerPixel = 4 * 12;  // 12 numbers of Planes
  size_t width = 0;
  size_t height = 0;
  for (const View& view : views) {
    width = std::max<size_t>(width, view.width);
    height = std::max<size_t>(height, view.height);
  }
  return kBytesPerPixel * width * height;
}

// The windows' planes and the tiles are as large as the largest view was.
void PairPasses::Reserve(const View& view_i, size_t num_facets) {
  if (label_stamps_.NumBytes() != num_facets * sizeof(uint32_t)) {
    label_stamps_.Resize(num_facets * sizeof(uint32_t));
    label_stamps_.SetZero();
  }
  const size_t num_tiles = NumTiles(view_i);
  if (tile_stamps_.NumBytes() < num_tiles * sizeof(uint32_t)) {
    CheckNumGroups(num_tiles);
    tile_stamps_.Resize(num_tiles * sizeof(uint32_t));
    tile_stamps_.SetZero();
    tiles_.Resize((kTileListHeader + num_tiles) * sizeof(uint32_t));
  }
  if (!planes_ || planes_->warped.Width() < view_i.width ||
      planes_->warped.Height() < view_i.height) {
    const int width =
        std::max(planes_ ? planes_->warped.Width() : 0, view_i.width);
    const int height =
        std::max(planes_ ? planes_->warped.Height() : 0, view_i.height);
    planes_.reset();  // Before the others are made.
    planes_ = Planes{{GL_RGBA32F, width, height},
                     {GL_RGBA32F, width, height},
                     {GL_RG32F, width, height},
                     {GL_RG32F, width, height}};
  }
}

void PairPasses::SetFacetBox(const PairDirection& direction,
                             Program* program) const {
  const View& view = direction.view_i;
  program->Set("first_facet", FirstFacet(direction));
  program->Set("num_facets",
               static_cast<unsigned int>(direction.facets.size()));
  program->Set("pixel_from_world_i",
               Eigen::Matrix3f(view.PixelFromRay().cast<float>()));
  program->Set("size_i", Size(view));
  program->Set("center_i", view.Center());
}

void PairPasses::FindTiles(const PairDirection& direction) {
  SetFacetBox(direction, &find_tiles_);
  find_tiles_.Set("stamp", stamp_);
  find_tiles_.Set("num_tile_columns", NumTileColumns(direction.view_i));
  const std::array<uint32_t, kTileListHeader> no_tiles = {0, 1, 1, 0};
  tiles_.Write(no_tiles.data(), sizeof(no_tiles));
  Dispatch(find_tiles_, direction.facets.size());
}

void PairPasses::Warp(const PairDirection& direction) {
  const View& i = direction.view_i;
  const View& j = direction.view_j;
  const PairGeometry pair(i, j);
  warp_.Set("num_tile_columns", NumTileColumns(i));
  warp_.Set("size_i", Size(i));
  warp_.Set("size_j", Size(j));
  warp_.Set("center_i", pair.center_i);
  warp_.Set("ray_from_pixel_i", pair.ray_from_pixel_i);
  warp_.Set("pixel_j_from_pixel_i", pair.pixel_j_from_pixel_i);
  warp_.Set("epipole", pair.epipole);
  warp_.Set("i_from_j", Eigen::Vector3d(pair.center_i - j.Center()));
  warp_.Set("rotation_j",
            Eigen::Matrix3f(j.cam_from_world_rotation.cast<float>()));
  warp_.Set("focal_j", Eigen::Vector2f(j.fx, j.fy));
  warp_.Set("depth_scale_i", direction.textures_i.drawn.depth_scale);
  warp_.Set("depth_scale_j", direction.textures_j.drawn.depth_scale);
  direction.textures_i.drawn.facets.BindToSampler(0);
  direction.textures_i.image.BindToSampler(1);
  direction.textures_j.drawn.facets.BindToSampler(2);
  direction.textures_j.image.BindToSampler(3);
  direction.textures_j.drawn.depths.BindToSampler(4);
  direction.textures_i.drawn.depths.BindToSampler(5);
  direction.textures_i.drawn.facing.BindToStorage(kFacingI);
  direction.textures_j.drawn.facing.BindToStorage(kFacingJ);
  planes_->warped.BindToImage(0, GL_WRITE_ONLY);
  DispatchIndirect(warp_, tiles_);
}

// What the passes over windows share.
void PairPasses::SetWindows(const PairDirection& direction,
                            Program* program) const {
  program->Set("stamp", stamp_);
  program->Set("num_tile_columns", NumTileColumns(direction.view_i));
  program->Set("size_i", Size(direction.view_i));
  program->Set(
      "max_relative_depth",
      MaxRelativeDepth(options_, direction.view_i, options_.window_radius));
  direction.textures_i.drawn.facets.BindToSampler(0);
  planes_->warped.BindToSampler(1);
}

void PairPasses::Correlate(const PairDirection& direction) {
  SetWindows(direction, &correlate_);
  correlate_.Set("noise_variance", static_cast<float>(options_.noise_variance));
  correlate_.Set("saturation", static_cast<float>(1 + options_.residual_floor));
  correlate_.Set("min_variance", kMinVariance);
  planes_->windows.BindToImage(0, GL_WRITE_ONLY);
  planes_->energies.BindToImage(1, GL_WRITE_ONLY);
  DispatchIndirect(correlate_, tiles_);
}

void PairPasses::Differentiate(const PairDirection& direction) {
  SetWindows(direction, &differentiate_);
  planes_->windows.BindToSampler(2);
  planes_->derivatives.BindToImage(0, GL_WRITE_ONLY);
  DispatchIndirect(differentiate_, tiles_);
}

// In parts of the sums that shaders can reach, and of the image whose pixels
// they can run over.
void PairPasses::Gather(const PairDirection& direction,
                        const PairBuffers& buffers) {
  const size_t num_facets = buffers.facets.NumBytes() / sizeof(Facet);
  const size_t per_part =
      std::max(kAlignedNumbers, limits_.max_block / sizeof(FacetTerms) /
                                    kAlignedNumbers * kAlignedNumbers);
  const View& view = direction.view_i;
  const int rows_per_part = static_cast<int>(
      std::clamp<size_t>(limits_.max_loops / (view.width + 2), 1, view.height));
  SetFacetBox(direction, &gather_);
  gather_.Set("ray_from_pixel_i", view.RayFromPixel());
  direction.textures_i.drawn.facets.BindToSampler(0);
  planes_->warped.BindToSampler(1);
  planes_->energies.BindToSampler(2);
  planes_->derivatives.BindToSampler(3);
  size_t num_done = 0;
  for (size_t first = 0; first < num_facets; first += per_part) {
    const size_t end = std::min(first + per_part, num_facets);
    const size_t num_below = std::ranges::lower_bound(direction.facets, end) -
                             direction.facets.begin();
    gather_.Set("first_facet",
                FirstFacet(direction) + static_cast<unsigned int>(num_done));
    gather_.Set("num_facets", static_cast<unsigned int>(num_below - num_done));
    gather_.Set("first_sum", static_cast<unsigned int>(first));
    buffers.sums.BindToStorage(kSums, first * sizeof(FacetTerms),
                               (end - first) * sizeof(FacetTerms));
    for (int row = 0; row < view.height; row += rows_per_part) {
      gather_.Set("first_row", row);
      gather_.Set("end_row", std::min(row + rows_per_part, view.height));
      Dispatch(gather_, num_below - num_done);
    }
    num_done = num_below;
  }
}

void PairPasses::Run(const PairDirection& direction,
                     const PairBuffers& buffers) {
  Reserve(direction.view_i, buffers.facets.NumBytes() / sizeof(Facet));
  ++stamp_;
  buffers.drawn_vertices.BindToStorage(kDrawnVertices);
  buffers.facets.BindToStorage(kFacets);
  buffers.normals.BindToStorage(kNormals);
  const unsigned int first = FirstFacet(direction);
  buffers.chosen_facets.BindToStorage(
      kChosenFacets, (direction.first_facet - first) * sizeof(uint32_t),
      (first + direction.facets.size()) * sizeof(uint32_t));
  buffers.vertices.BindToStorage(kVertices);
  label_stamps_.BindToStorage(kLabelStamps);
  tiles_.BindToStorage(kTiles);
  tile_stamps_.BindToStorage(kTileStamps);
  FindTiles(direction);
  Warp(direction);
  Correlate(direction);
  Differentiate(direction);
  Gather(direction, buffers);
}

}  // namespace colmap_ext
