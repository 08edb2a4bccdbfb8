#include "raster/facet_id_buffer.h"

#include <array>
#include <bit>
#include <limits>
#include <tuple>
#include <utility>

namespace colmap_ext {
namespace {

// As many as graphics cards have (8 bits), 1 / px.
constexpr int kSubpixelBits = 8;
constexpr int64_t kSubpixels = 1 << kSubpixelBits;

// px. Then coordinates are 2^28 subpixels at most, and a facet's area and edge
// functions, sums of products of two differences, 2^60.
constexpr double kFar = 1 << 20;

// A vertex in a view.
struct Projected {
  int64_t u = 0;  // 1 / kSubpixels px
  int64_t v = 0;
  // 1 / scene unit. 0: behind the camera; negative: before it, but kFar or more
  // from the image's corner.
  double inverse_depth = 0;
};

// \param vertex  in the world frame.
Projected Project(const View& view, const Eigen::Vector3d& vertex) {
  const Eigen::Vector3d point = view.CamFromWorld(vertex);
  if (!(point.z() > 0)) {
    return {};
  }
  const Eigen::Vector2d pixel = view.ImageFromCam(point);
  if (!(pixel.cwiseAbs().maxCoeff() < kFar)) {
    return {0, 0, -1};
  }
  return {std::llrint(pixel.x() * kSubpixels),
          std::llrint(pixel.y() * kSubpixels), 1 / point.z()};
}

// The vertices of a mesh in a view. Keeps those used last, which the next
// facets share: all of them would be too many for each of many threads.
class ProjectedVertices {
 public:
  ProjectedVertices(const View& view, const TriangleMesh& mesh)
      : view_(view),
        mesh_(mesh),
        slots_(std::bit_ceil(std::min(mesh.vertices.size(), kMaxSlots))) {}

  std::array<Projected, 3> CornersOf(const Facet& facet) {
    return {Find(facet[0]), Find(facet[1]), Find(facet[2])};
  }

 private:
  struct Slot {
    uint32_t vertex = kNone;
    Projected projected;
  };

  const Projected& Find(uint32_t vertex) {
    Slot& slot = slots_[vertex & (slots_.size() - 1)];
    if (slot.vertex != vertex) {
      slot.vertex = vertex;
      slot.projected = Project(view_, mesh_.vertices[vertex].cast<double>());
    }
    return slot.projected;
  }

  // 0.5 MB, what a core's cache holds; a choice.
  static constexpr size_t kMaxSlots = 1 << 14;

  const View& view_;
  const TriangleMesh& mesh_;
  std::vector<Slot> slots_;  // of each vertex the one of its lowest bits
};

// Twice the signed area to the left of an edge, at a pixel's centre, and its
// steps from pixel to pixel. A centre on an edge belongs to the facet below or
// to the right of it (top-left rule).
struct EdgeFunction {
  EdgeFunction(const Projected& from, const Projected& to, int row, int col)
      : col_step((from.v - to.v) * kSubpixels),
        row_step((to.u - from.u) * kSubpixels) {
    const int64_t u = col * kSubpixels + kSubpixels / 2;
    const int64_t v = row * kSubpixels + kSubpixels / 2;
    value = (to.u - from.u) * (v - from.v) - (to.v - from.v) * (u - from.u);
    const bool is_top_left = to.v < from.v || (to.v == from.v && to.u > from.u);
    value -= is_top_left ? 0 : 1;
  }

  int64_t value, col_step, row_step;
};

// \param area  Area(corners), not 0
DrawnDepth MakeDepth(const std::array<Projected, 3>& corners, int64_t area) {
  const auto [a, b, c] = corners;
  const double scale = static_cast<double>(kSubpixels) / area;
  const double ab = b.inverse_depth - a.inverse_depth;
  const double ac = c.inverse_depth - a.inverse_depth;
  DrawnDepth depth;
  depth.col_step = (ab * (c.v - a.v) - ac * (b.v - a.v)) * scale;
  depth.row_step = (ac * (b.u - a.u) - ab * (c.u - a.u)) * scale;
  depth.value = a.inverse_depth +
                (0.5 - a.u * (1.0 / kSubpixels)) * depth.col_step +
                (0.5 - a.v * (1.0 / kSubpixels)) * depth.row_step;
  std::tie(depth.min, depth.max) =
      std::minmax({a.inverse_depth, b.inverse_depth, c.inverse_depth});
  return depth;
}

// The pixels whose centres lie within [low, high], clipped to 0 ... size - 1.
std::pair<int, int> PixelRange(int64_t low, int64_t high, int size) {
  const int64_t half = kSubpixels / 2;
  // Shifts round down, unlike divisions.
  const int64_t first = (low - half + kSubpixels - 1) >> kSubpixelBits;
  const int64_t last = (high - half) >> kSubpixelBits;
  return {static_cast<int>(std::max<int64_t>(first, 0)),
          static_cast<int>(std::min<int64_t>(last, size - 1))};
}

PixelBox BoxOf(const std::array<Projected, 3>& corners, int width, int height) {
  const auto [a, b, c] = corners;
  const auto [low_u, high_u] = std::minmax({a.u, b.u, c.u});
  const auto [low_v, high_v] = std::minmax({a.v, b.v, c.v});
  PixelBox box;
  std::tie(box.first_col, box.last_col) = PixelRange(low_u, high_u, width);
  std::tie(box.first_row, box.last_row) = PixelRange(low_v, high_v, height);
  return box;
}

// Twice the signed area of a facet, 1 / kSubpixels^2 px^2.
int64_t Area(const std::array<Projected, 3>& corners) {
  const auto& [a, b, c] = corners;
  return (b.u - a.u) * (c.v - a.v) - (b.v - a.v) * (c.u - a.u);
}

// Pixels of a row.
// \param edges  at the first of them
void DrawRow(uint32_t facet, const std::array<EdgeFunction, 3>& edges,
             const DrawnDepth& depth, int row, int first_col, int last_col,
             DrawnFacets* buffer) {
  const size_t first = buffer->Index(row, first_col);
  for (int col = 0; col <= last_col - first_col; ++col) {
    const int64_t outside =  // Negative if any of them is.
        (edges[0].value + col * edges[0].col_step) |
        (edges[1].value + col * edges[1].col_step) |
        (edges[2].value + col * edges[2].col_step);
    if (outside < 0) {
      continue;
    }
    const auto inverse_depth =
        static_cast<float>(depth.At(row, first_col + col));
    float& drawn_depth = buffer->inverse_depths[first + col];
    if (inverse_depth > drawn_depth ||
        (inverse_depth == drawn_depth && facet < buffer->facets[first + col])) {
      drawn_depth = inverse_depth;
      buffer->facets.Set(first + col, facet);
    }
  }
}

void DrawFacet(uint32_t facet, std::array<Projected, 3> corners,
               DrawnFacets* buffer) {
  const PixelBox box = BoxOf(corners, buffer->width, buffer->height);
  if (box.IsEmpty()) {  // as many facets are, in small images
    return;
  }
  int64_t area = Area(corners);
  if (area == 0) {
    return;
  }
  if (area < 0) {
    std::swap(corners[1], corners[2]);
    area = -area;
  }
  std::array<EdgeFunction, 3> edges = {
      EdgeFunction(corners[0], corners[1], box.first_row, box.first_col),
      EdgeFunction(corners[1], corners[2], box.first_row, box.first_col),
      EdgeFunction(corners[2], corners[0], box.first_row, box.first_col)};
  const DrawnDepth depth = MakeDepth(corners, area);
  for (int row = box.first_row; row <= box.last_row; ++row) {
    DrawRow(facet, edges, depth, row, box.first_col, box.last_col, buffer);
    for (EdgeFunction& edge : edges) {
      edge.value += edge.row_step;
    }
  }
}

// The part of a facet that is less than kFar from the image's corner. Where it
// ends no other facet's border is moved: no pixel falls between them.
void DrawClipped(const View& view, const TriangleMesh& mesh, uint32_t facet,
                 DrawnFacets* buffer) {
  const Eigen::AlignedBox2d box(Eigen::Vector2d::Constant(-kFar),
                                Eigen::Vector2d::Constant(kFar));
  std::vector<Projected> corners;
  for (const Eigen::Vector3d& corner :
       ClipToImage(view, mesh, mesh.facets[facet], box)) {
    const Eigen::Vector2d pixel =  // rounding can leave the box
        view.ImageFromCam(corner).cwiseMax(-kFar).cwiseMin(kFar);
    corners.push_back({std::llrint(pixel.x() * kSubpixels),
                       std::llrint(pixel.y() * kSubpixels), 1 / corner.z()});
  }
  for (size_t k = 2; k < corners.size(); ++k) {
    DrawFacet(facet, {corners[0], corners[k - 1], corners[k]}, buffer);
  }
}

// Whether a facet is drawn as a whole, as far as it lies in the image.
bool IsWhole(const std::array<Projected, 3>& corners) {
  const auto& [a, b, c] = corners;
  return a.inverse_depth > 0 && b.inverse_depth > 0 && c.inverse_depth > 0;
}

// Whether a part of a facet may lie within the image and its margin.
bool MayReachImage(const std::array<Projected, 3>& corners,
                   const FacetIdBuffer& buffer) {
  const auto [a, b, c] = corners;
  constexpr int64_t kMargin = kImageMargin * kSubpixels;
  return std::max({a.u, b.u, c.u}) >= -kMargin &&
         std::max({a.v, b.v, c.v}) >= -kMargin &&
         std::min({a.u, b.u, c.u}) <= buffer.width * kSubpixels + kMargin &&
         std::min({a.v, b.v, c.v}) <= buffer.height * kSubpixels + kMargin;
}

// Whether a facet that is not drawn as a whole is drawn by its part.
bool IsClipped(const View& view, const TriangleMesh& mesh, const Facet& facet,
               const std::array<Projected, 3>& corners) {
  const auto& [a, b, c] = corners;
  return (a.inverse_depth != 0 || b.inverse_depth != 0 ||
          c.inverse_depth != 0) &&
         !ClipToImage(view, mesh, facet, ImageBox(view)).empty();
}

// How far off the farthest surface is in each square of pixels.
class FarthestSurface {
 public:
  explicit FarthestSurface(const DrawnFacets& buffer)
      : width_((buffer.width + kSide - 1) / kSide),
        columns_(static_cast<size_t>(width_) * kSide),
        depths_(static_cast<size_t>(width_) *
                ((buffer.height + kSide - 1) / kSide)) {}

  // After the surface was drawn.
  void Update(const DrawnFacets& buffer) {
    for (int top = 0; top < buffer.height; top += kSide) {
      // First of the columns, which is done in vectors.
      std::ranges::fill(columns_, std::numeric_limits<float>::infinity());
      for (int row = top; row < std::min(top + kSide, buffer.height); ++row) {
        const float* drawn = &buffer.inverse_depths[buffer.Index(row, 0)];
        for (int col = 0; col < buffer.width; ++col) {
          columns_[col] = std::min(columns_[col], drawn[col]);
        }
      }
      for (int square = 0; square < width_; ++square) {
        const auto first = columns_.begin() + kSide * square;
        depths_[static_cast<size_t>(top / kSide) * width_ + square] =
            *std::min_element(first, first + kSide);
      }
    }
  }

  // Whether all that is drawn in a box of pixels is nearer than this.
  bool IsNearer(const PixelBox& box, double inverse_depth) const {
    for (int row = box.first_row / kSide; row <= box.last_row / kSide; ++row) {
      for (int col = box.first_col / kSide; col <= box.last_col / kSide;
           ++col) {
        if (!(depths_[static_cast<size_t>(row) * width_ + col] >
              inverse_depth)) {
          return false;
        }
      }
    }
    return true;
  }

 private:
  static constexpr int kSide = 8;  // px, a choice

  int width_;
  std::vector<float> columns_;  // scratch
  std::vector<float> depths_;   // [squares] the smallest inverse depths
};

}  // namespace

DrawnFacets DrawFacets(const View& view, const TriangleMesh& mesh,
                       const FacetClusters& clusters, double min_cosine) {
  DrawnFacets buffer;
  buffer.width = view.width;
  buffer.height = view.height;
  const size_t num_pixels = static_cast<size_t>(view.width) * view.height;
  buffer.facets = FacetIds(num_pixels, mesh.facets.size());
  buffer.inverse_depths.assign(num_pixels, 0);
  buffer.min_cosine = min_cosine;
  ProjectedVertices vertices(view, mesh);
  const auto draw = [&](uint32_t i) {
    const Facet& facet = mesh.facets[i];
    const std::array<Projected, 3> corners = vertices.CornersOf(facet);
    if (IsWhole(corners)) {
      if (MayReachImage(corners, buffer)) {
        DrawFacet(i, corners, &buffer);
      }
    } else if (IsClipped(view, mesh, facet, corners)) {
      buffer.clipped.push_back(i);
    }
  };
  // Hidden are those behind what was drawn: looked for a few times only.
  constexpr size_t kRounds = 8;  // a choice
  // Times a facet's inverse depth: beyond what IsNearest() takes for nearest,
  // of facets that face the camera.
  const double footprint = 1 / std::min(view.fx, view.fy);  // at depth 1
  const double factor =
      1 + kNearestTolerance * (2 / min_cosine + 1) * footprint;
  FarthestSurface farthest(buffer);
  const std::vector<FacetClusters::Seen> seen = clusters.NearestFirst(view);
  for (size_t round = 0; round < kRounds; ++round) {
    if (round > 0) {
      farthest.Update(buffer);
    }
    for (size_t k = round * seen.size() / kRounds;
         k < (round + 1) * seen.size() / kRounds; ++k) {
      if (round == 0 ||
          !farthest.IsNearer(seen[k].pixels, factor * seen[k].nearest)) {
        ForEachFacet(std::span(&seen[k].facets, 1), draw);
        buffer.ranges.push_back(seen[k].facets);
      }
    }
  }
  std::ranges::sort(buffer.ranges, {}, &FacetRange::first);
  std::ranges::sort(buffer.clipped);
  for (const uint32_t i : buffer.clipped) {
    DrawClipped(view, mesh, i, &buffer);
  }
  return buffer;
}

DrawnFacets DrawFacets(const View& view, const TriangleMesh& mesh,
                       double min_cosine) {
  return DrawFacets(view, mesh, FacetClusters(mesh), min_cosine);
}

std::vector<uint32_t> FindClippedFacets(const View& view,
                                        const TriangleMesh& mesh,
                                        std::span<const FacetRange> ranges) {
  ProjectedVertices vertices(view, mesh);
  std::vector<uint32_t> clipped;
  ForEachFacet(ranges, [&](uint32_t i) {
    const Facet& facet = mesh.facets[i];
    const std::array<Projected, 3> corners = vertices.CornersOf(facet);
    if (!IsWhole(corners) && IsClipped(view, mesh, facet, corners)) {
      clipped.push_back(i);
    }
  });
  return clipped;
}

void EraseMasked(const GrayImage& mask, FacetIdBuffer* buffer) {
  buffer->is_masked.assign(mask.pixels.size(), false);
  for (size_t i = 0; i < mask.pixels.size(); ++i) {
    if (mask.pixels[i] == 0) {
      buffer->facets.Set(i, kNone);
      buffer->is_masked[i] = true;
    }
  }
}

DrawnDepth DepthOf(const View& view, const TriangleMesh& mesh,
                   const Facet& facet) {
  const auto [a, b, c] = CornersOf<double>(mesh, facet);
  const std::array<Projected, 3> corners = {Project(view, a), Project(view, b),
                                            Project(view, c)};
  if (IsWhole(corners)) {
    return MakeDepth(corners, Area(corners));
  }
  const Eigen::Vector3d by_pixel = InverseDepthByPixel(view, mesh, facet);
  return {by_pixel.dot(Eigen::Vector3d(0.5, 0.5, 1)), by_pixel.y(),
          by_pixel.x(), 0, std::numeric_limits<double>::infinity()};
}

bool IsNearer(const View& view, const TriangleMesh& mesh, const Facet& facet,
              int row, int col, double inverse_depth) {
  double nearest = std::numeric_limits<double>::infinity();
  for (const auto& corner : CornersOf<double>(mesh, facet)) {
    nearest =
        std::min(nearest, view.cam_from_world_rotation.row(2).dot(corner) +
                              view.cam_from_world_translation.z());
  }
  // Most facets have no corner that is.
  return nearest * inverse_depth < 1 &&
         DepthOf(view, mesh, facet).At(row, col) > inverse_depth;
}

}  // namespace colmap_ext
