#include "raster/facet_visibility.h"

#include <algorithm>

#include <tbb/parallel_for.h>

#include "raster/facet_frames.h"
#include "raster/facet_id_buffer.h"

namespace colmap_ext {

namespace {

// [F] whether a view shows each facet.
std::vector<uint8_t> FindVisible(const FacetVisibilityOptions& options,
                                 const TriangleMesh& mesh,
                                 const std::vector<FacetFrame>& frames,
                                 const View& view) {
  const FacetIdBuffer drawn = DrawFacets(view, mesh, options.min_cosine);
  std::vector<uint8_t> is_visible(mesh.facets.size(), 0);
  for (uint32_t i = 0; i < mesh.facets.size(); ++i) {
    const auto [a, b, c] = mesh.facets[i];
    const Eigen::Vector3d point =
        (mesh.vertices[a].cast<double>() + mesh.vertices[b].cast<double>() +
         mesh.vertices[c].cast<double>()) /
        3;
    if (!drawn.is_facing[i]) {
      continue;
    }
    const Eigen::Vector3d in_camera = view.CamFromWorld(point);
    const Eigen::Vector2d pixel = view.ImageFromCam(in_camera);
    if (!(pixel.x() >= options.border && pixel.y() >= options.border &&
          pixel.x() < view.width - options.border &&
          pixel.y() < view.height - options.border)) {
      continue;
    }
    is_visible[i] = IsNearest(view, drawn, i, PlaneSlope(view, frames[i]),
                              pixel.x(), pixel.y(), 1 / in_camera.z());
  }
  return is_visible;
}

}  // namespace

FacetVisibility FindVisibleFacets(const FacetVisibilityOptions& options,
                                  const TriangleMesh& mesh,
                                  const std::vector<View>& views) {
  const std::vector<FacetFrame> frames = ComputeFacetFrames(mesh);
  std::vector<std::vector<uint8_t>> is_visible(views.size());
  tbb::parallel_for(size_t{0}, views.size(), [&](size_t i) {
    is_visible[i] = FindVisible(options, mesh, frames, views[i]);
  });
  FacetVisibility visibility;
  visibility.offsets.reserve(mesh.facets.size() + 1);
  for (size_t facet = 0; facet < mesh.facets.size(); ++facet) {
    for (uint32_t i = 0; i < views.size(); ++i) {
      if (is_visible[i][facet] != 0) {
        visibility.values.push_back(i);
      }
    }
    visibility.EndRow();
  }
  return visibility;
}

}  // namespace colmap_ext
