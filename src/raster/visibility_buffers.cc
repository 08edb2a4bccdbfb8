#include "raster/visibility_buffers.h"

#include <algorithm>
#include <utility>

#include <tbb/parallel_for.h>

#include "mesh/mesh_in_image.h"

namespace colmap_ext {
namespace {

Eigen::Vector3d Centroid(const TriangleMesh& mesh, const Facet& facet) {
  const auto& [a, b, c] = facet;
  return (mesh.vertices[a].cast<double>() + mesh.vertices[b].cast<double>() +
          mesh.vertices[c].cast<double>()) /
         3;
}

// Whether a view shows the middle of the part of a facet that lies within.
bool IsPartVisible(const TriangleMesh& mesh, uint32_t facet,
                   const FacetFrame& frame, const View& view,
                   const FacetIdBuffer& drawn, double border) {
  const std::vector<Eigen::Vector3d> part =
      ClipToImage(view, mesh, mesh.facets[facet], ImageBox(view, border));
  Eigen::Vector2d pixel = Eigen::Vector2d::Zero();
  double inverse_depth = 0;  // linear over the image
  for (const Eigen::Vector3d& corner : part) {
    pixel += view.ImageFromCam(corner) / static_cast<double>(part.size());
    inverse_depth += 1 / corner.z() / static_cast<double>(part.size());
  }
  return !part.empty() && IsWithin(view, pixel, border) &&
         IsNearest(view, drawn, facet, PlaneSlope(view, frame), pixel.x(),
                   pixel.y(), inverse_depth);
}

// [F] whether a view shows the facet. Bits: there are many views and facets.
std::vector<bool> FindVisible(const TriangleMesh& mesh,
                              const std::vector<FacetFrame>& frames,
                              const View& view, const FacetIdBuffer& drawn,
                              double border) {
  std::vector<bool> is_visible(mesh.facets.size(), false);
  for (uint32_t i = 0; i < mesh.facets.size(); ++i) {
    if (!drawn.is_facing[i]) {
      continue;
    }
    const Eigen::Vector3d in_camera =
        view.CamFromWorld(Centroid(mesh, mesh.facets[i]));
    const Eigen::Vector2d pixel = view.ImageFromCam(in_camera);
    if (IsWithin(view, pixel, border)) {
      is_visible[i] = IsNearest(view, drawn, i, PlaneSlope(view, frames[i]),
                                pixel.x(), pixel.y(), 1 / in_camera.z());
    }
  }
  for (const uint32_t i : drawn.clipped) {
    is_visible[i] = drawn.is_facing[i] &&
                    IsPartVisible(mesh, i, frames[i], view, drawn, border);
  }
  return is_visible;
}

}  // namespace

VisibilityBuffers::VisibilityBuffers(TriangleMesh mesh, std::vector<View> views,
                                     double min_cosine, size_t max_memory,
                                     ViewMask mask)
    : mesh_(std::move(mesh)),
      views_(std::move(views)),
      min_cosine_(min_cosine),
      max_memory_(max_memory),
      mask_(std::move(mask)),
      drawn_(max_memory) {}

std::shared_ptr<const FacetIdBuffer> VisibilityBuffers::Get(size_t view) const {
  return drawn_.Get(view, Memory(view), [&] {
    auto buffer = std::make_shared<FacetIdBuffer>(
        DrawFacets(views_[view], mesh_, min_cosine_));
    const std::shared_ptr<const GrayImage> mask = mask_ ? mask_(view) : nullptr;
    if (mask) {
      EraseMasked(*mask, buffer.get());
    }
    return std::shared_ptr<const FacetIdBuffer>(std::move(buffer));
  });
}

void VisibilityBuffers::DrawAhead() const {
  size_t memory = 0;
  size_t num_views = 0;
  for (; num_views < views_.size(); ++num_views) {
    memory += Memory(num_views);
    if (memory > max_memory_) {
      break;
    }
  }
  tbb::parallel_for(size_t{0}, num_views, [&](size_t view) { Get(view); });
}

// Of a FacetIdBuffer: facets and depths of pixels, a bit a facet.
size_t VisibilityBuffers::Memory(size_t view) const {
  constexpr size_t kBytesPerPixel = sizeof(uint32_t) + sizeof(float);
  return kBytesPerPixel * views_[view].width * views_[view].height +
         mesh_.facets.size() / 8;
}

FacetVisibility FindVisibleFacets(const VisibilityBuffers& buffers,
                                  double border) {
  const TriangleMesh& mesh = buffers.Mesh();
  const std::vector<View>& views = buffers.Views();
  const std::vector<FacetFrame> frames = ComputeFacetFrames(mesh);
  std::vector<std::vector<bool>> is_visible(views.size());
  tbb::parallel_for(size_t{0}, views.size(), [&](size_t i) {
    is_visible[i] =
        FindVisible(mesh, frames, views[i], *buffers.Get(i), border);
  });
  size_t num_visible = 0;
  for (const std::vector<bool>& row : is_visible) {
    num_visible += std::ranges::count(row, true);
  }
  FacetVisibility visibility;
  visibility.Reserve(mesh.facets.size(), num_visible);
  for (size_t facet = 0; facet < mesh.facets.size(); ++facet) {
    for (uint32_t i = 0; i < views.size(); ++i) {
      if (is_visible[i][facet]) {
        visibility.values.push_back(i);
      }
    }
    visibility.EndRow();
  }
  return visibility;
}

}  // namespace colmap_ext
