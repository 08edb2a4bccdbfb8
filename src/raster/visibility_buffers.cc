#include "raster/visibility_buffers.h"

#include <utility>

#include <tbb/parallel_for.h>

namespace colmap_ext {

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

}  // namespace colmap_ext
