#include "raster/visibility_buffers.h"

#include <algorithm>
#include <optional>
#include <span>
#include <utility>

#include <tbb/parallel_for.h>

#include "mesh/mesh_in_image.h"

namespace colmap_ext {
namespace {

// Some facets of a mesh, each a part of one that was drawn.
struct FacetParts {
  const TriangleMesh& mesh;
  // [F] the drawn facet that each is a part of, ascending; null: itself
  const std::vector<uint32_t>* drawn_facets;

  uint32_t DrawnFacet(uint32_t facet) const {
    return drawn_facets != nullptr ? (*drawn_facets)[facet] : facet;
  }

  // The parts of a range of drawn facets.
  FacetRange PartsOf(const FacetRange& range) const {
    if (drawn_facets == nullptr) {
      return range;
    }
    const auto index = [&](uint32_t facet) {
      return static_cast<uint32_t>(
          std::ranges::lower_bound(*drawn_facets, facet) -
          drawn_facets->begin());
    };
    return {index(range.first), index(range.end)};
  }
};

// Whether a view shows a facet's centroid; of a facet that is drawn by a part,
// the middle of what lies within the border.
bool IsVisible(const FacetParts& parts, uint32_t index, bool is_clipped,
               const View& view, const TriangleMesh& drawn_mesh,
               const FacetIdBuffer& drawn) {
  const Facet& facet = parts.mesh.facets[index];
  Eigen::Vector2d pixel = Eigen::Vector2d::Zero();
  double inverse_depth = 0;  // linear over the image; 0: not before the camera
  if (is_clipped) {
    const std::vector<Eigen::Vector3d> part =
        ClipToImage(view, parts.mesh, facet, ImageBox(view, kVisibilityBorder));
    for (const Eigen::Vector3d& corner : part) {
      const auto size = static_cast<double>(part.size());
      pixel += view.ImageFromCam(corner) / size;
      inverse_depth += 1 / corner.z() / size;
    }
  } else {
    const auto [a, b, c] = CornersOf<double>(parts.mesh, facet);
    const Eigen::Vector3d in_camera = view.CamFromWorld((a + b + c) / 3);
    if (in_camera.z() > 0) {
      pixel = view.ImageFromCam(in_camera);
      inverse_depth = 1 / in_camera.z();
    }
  }
  return inverse_depth > 0 && IsWithin(view, pixel, kVisibilityBorder) &&
         IsNearest(view, drawn_mesh, drawn, parts.DrawnFacet(index),
                   PlaneSlope(view, parts.mesh, facet), pixel.x(), pixel.y(),
                   inverse_depth);
}

// The facets that a view shows, ascending.
std::vector<uint32_t> FindVisible(const FacetParts& parts,
                                  const VisibilityBuffers& buffers,
                                  size_t index) {
  const View& view = buffers.Views()[index];
  const auto buffer = buffers.Get(index);
  const FacetIdBuffer& drawn = *buffer;
  const Eigen::Vector3d center = view.Center();
  std::vector<uint32_t> visible;
  for (const FacetRange& range : drawn.ranges) {
    const auto [first, end] = parts.PartsOf(range);
    for (uint32_t i = first; i < end; ++i) {
      const uint32_t drawn_facet = parts.DrawnFacet(i);
      const bool is_part =
          std::ranges::binary_search(drawn.clipped, drawn_facet);
      if (IsFacing(parts.mesh, parts.mesh.facets[i], center,
                   is_part ? 0 : drawn.min_cosine) &&
          IsVisible(parts, i, is_part, view, buffers.Mesh(), drawn)) {
        visible.push_back(i);
      }
    }
  }
  return visible;
}

// Leaves the views that show a facet largest, ascending.
// \return how many they are
size_t KeepLargest(const TriangleMesh& mesh, const std::vector<View>& views,
                   size_t facet, std::span<uint32_t> row) {
  if (row.size() <= kMaxViewsOfFacet) {
    return row.size();
  }
  std::vector<std::pair<double, uint32_t>> largest;
  largest.reserve(row.size());
  for (const uint32_t view : row) {
    largest.emplace_back(-AreaInImage(mesh, mesh.facets[facet], views[view]),
                         view);
  }
  std::ranges::nth_element(largest, largest.begin() + kMaxViewsOfFacet);
  for (size_t k = 0; k < kMaxViewsOfFacet; ++k) {
    row[k] = largest[k].second;
  }
  std::ranges::sort(row.first(kMaxViewsOfFacet));
  return kMaxViewsOfFacet;
}

// Adds views that show facets to the rows of a run of facets.
// \param visible  the facets that each view shows, ascending
// \param first_view  of `visible`; above those in the rows
void AddToRun(const TriangleMesh& mesh, const std::vector<View>& views,
              const std::vector<std::vector<uint32_t>>& visible,
              size_t first_view, size_t first_facet, FacetVisibility* run) {
  const size_t num_facets = run->size();
  std::vector<std::span<const uint32_t>> shown;
  size_t num_shown = 0;
  for (const std::vector<uint32_t>& facets : visible) {
    const auto begin = std::ranges::lower_bound(facets, first_facet);
    const auto end =
        std::lower_bound(begin, facets.end(), first_facet + num_facets);
    num_shown += shown.emplace_back(begin, end).size();
  }
  if (num_shown == 0) {
    return;
  }
  *run = GroupInRows<uint32_t>(num_facets, [&](const auto& add) {
    for (size_t facet = 0; facet < num_facets; ++facet) {
      for (const uint32_t view : (*run)[facet]) {
        add(facet, view);
      }
    }
    for (size_t i = 0; i < shown.size(); ++i) {
      for (const uint32_t facet : shown[i]) {
        add(facet - first_facet, static_cast<uint32_t>(first_view + i));
      }
    }
  });
  EditRows(
      [&](size_t i, std::span<uint32_t> row) {
        return std::optional(KeepLargest(mesh, views, first_facet + i, row));
      },
      run);
}

// Views are taken in groups, so that the lists of what each one shows take
// little, however many views there are. A group costs what it shows.
FacetVisibility FindVisible(const VisibilityBuffers& buffers,
                            const FacetParts& parts) {
  constexpr size_t kGroup = 64;     // a choice
  constexpr size_t kRun = 1 << 14;  // facets a task; a choice
  const std::vector<View>& views = buffers.Views();
  const size_t num_facets = parts.mesh.facets.size();
  std::vector<FacetVisibility> runs;
  for (size_t first = 0; first < num_facets; first += kRun) {
    runs.emplace_back(std::min(kRun, num_facets - first));
  }
  for (size_t first = 0; first < views.size(); first += kGroup) {
    std::vector<std::vector<uint32_t>> visible(
        std::min(kGroup, views.size() - first));
    tbb::parallel_for(size_t{0}, visible.size(), [&](size_t i) {
      visible[i] = FindVisible(parts, buffers, first + i);
    });
    tbb::parallel_for(size_t{0}, runs.size(), [&](size_t k) {
      AddToRun(parts.mesh, views, visible, first, k * kRun, &runs[k]);
    });
  }
  return JoinRows(std::move(runs));
}

}  // namespace

VisibilityBuffers::VisibilityBuffers(TriangleMesh mesh, std::vector<View> views,
                                     double min_cosine, size_t max_memory,
                                     ViewMask mask)
    : mesh_(std::move(mesh)),
      clusters_(mesh_),
      views_(std::move(views)),
      min_cosine_(min_cosine),
      max_memory_(max_memory),
      mask_(std::move(mask)),
      drawn_(max_memory) {}

std::shared_ptr<const FacetIdBuffer> VisibilityBuffers::Get(size_t view) const {
  return drawn_.Get(view, Memory(view), [&] {
    auto buffer = std::make_shared<FacetIdBuffer>(
        DrawFacets(views_[view], mesh_, clusters_, min_cosine_));
    if (const auto mask = mask_ ? mask_(view) : nullptr) {
      EraseMasked(*mask, buffer.get());
    }
    return std::shared_ptr<const FacetIdBuffer>(std::move(buffer));
  });
}

void VisibilityBuffers::DrawAhead() const {
  size_t memory = 0;
  size_t num_views = 0;
  while (num_views < views_.size() &&
         memory + Memory(num_views) <= max_memory_) {
    memory += Memory(num_views++);
  }
  tbb::parallel_for(size_t{0}, num_views, [&](size_t view) { Get(view); });
}

size_t VisibilityBuffers::Memory(size_t view) const {
  return FacetIds::BytesOfOne(mesh_.facets.size()) * views_[view].width *
         views_[view].height;
}

FacetVisibility FindVisibleFacets(const VisibilityBuffers& buffers) {
  return FindVisible(buffers, {buffers.Mesh(), nullptr});
}

FacetVisibility FindVisibleParts(const VisibilityBuffers& buffers,
                                 const TriangleMesh& parts,
                                 const std::vector<uint32_t>& drawn_facets) {
  return FindVisible(buffers, {parts, &drawn_facets});
}

}  // namespace colmap_ext
