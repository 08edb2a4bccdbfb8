#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "base/byte_store.h"
#include "merging/sectioned_mesh.h"
#include "merging/surface_bands.h"
#include "merging/vertex_points.h"
#include "meshing/manifold_meshing.h"
#include "scene/point_cloud.h"
#include "scene/progress.h"
#include "scene/view.h"

namespace colmap_ext {

// A finished mesh that is held elsewhere, section by section.
struct BandedMesh {
  explicit BandedMesh(const MakeStore& make_store)
      : mesh(make_store),
        colors(make_store),
        confidences(make_store),
        num_views(make_store),
        views(make_store) {}

  SectionedMesh mesh;
  StoredVector<Color> colors;        // [V] or empty
  StoredVector<float> confidences;   // [V]
  StoredVector<uint32_t> num_views;  // [V] of each vertex
  StoredVector<uint32_t> views;      // of one vertex after the other
};

// What of the options takes the whole surface, and can not be done in bands;
// empty: nothing.
std::string NeedsWholeSurface(const ManifoldMeshingOptions& options);

// Does what SplitSurface() and FinishSurface() do to the whole surface, one
// band at a time, and with the same result.
// \param report  gets the counts
// \pre NeedsWholeSurface() is empty
// \throw as these
BandedMesh FinishBands(const ManifoldMeshingOptions& options,
                       const SurfaceBands& bands, const ReadAttributes& read,
                       const std::vector<View>& views, const Progress& progress,
                       const MakeStore& make_store,
                       ManifoldMeshingReport* report);

}  // namespace colmap_ext
