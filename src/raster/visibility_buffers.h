#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <vector>

#include "base/lru_cache.h"
#include "base/rows.h"
#include "mesh/triangle_mesh.h"
#include "raster/facet_clusters.h"
#include "raster/facet_id_buffer.h"
#include "scene/images.h"
#include "scene/view.h"

namespace colmap_ext {

// The mask of a view, of its size; nothing where it has none.
using ViewMask = std::function<std::shared_ptr<const GrayImage>(size_t view)>;

// A mesh drawn into views, each view on first use. Subdivision, labelling and
// energy share the buffers of a mesh. As many as memory allows are kept, the
// least recently used ones are drawn again. Thread-safe.
class VisibilityBuffers {
 public:
  // \param min_cosine  see DrawFacets().
  // \param max_memory  of the buffers that are kept, bytes; those in use
  //        are always kept.
  // \param mask  of the views, whose masked pixels show nothing, see
  //        EraseMasked(); may be empty.
  VisibilityBuffers(TriangleMesh mesh, std::vector<View> views,
                    double min_cosine, size_t max_memory, ViewMask mask = {});

  const TriangleMesh& Mesh() const { return mesh_; }
  const std::vector<View>& Views() const { return views_; }

  // \param view  index into Views().
  std::shared_ptr<const FacetIdBuffer> Get(size_t view) const;

  // Draws the first views, as many as memory keeps, in parallel.
  void DrawAhead() const;

 private:
  size_t Memory(size_t view) const;

  TriangleMesh mesh_;
  FacetClusters clusters_;  // of the mesh
  std::vector<View> views_;
  double min_cosine_;
  size_t max_memory_;
  ViewMask mask_;
  mutable LruCache<const FacetIdBuffer> drawn_;
};

// Draws a mesh into the views of the callee.
using DrawMesh = std::function<std::shared_ptr<const VisibilityBuffers>(
    const TriangleMesh&)>;

// [F] the views that show each facet, ascending. If more than kMaxViewsOfFacet
// show it, only those that show it largest.
using FacetVisibility = Rows<uint32_t>;

// A choice: what a facet takes is then bounded, however many images there are.
inline constexpr size_t kMaxViewsOfFacet = 24;

// How far a facet's centroid has to keep from the image's border: a window of
// radius 2 around it, and the pixel beyond it that bicubic sampling takes, lie
// within the image.
inline constexpr double kVisibilityBorder = 3;  // px

// Which views show the facets' centroids (docs/method.md, section 4.2): nothing
// is drawn in front of the centroid, the facet faces the camera, and the
// centroid is not at the image's border. Of a facet that is drawn by a part
// (FindClippedFacets) the middle of what lies within the border counts.
FacetVisibility FindVisibleFacets(const VisibilityBuffers& buffers);

// The same of parts of the facets, as subdivision makes them: they are visible
// where the drawn ones are, and nothing is drawn anew.
// \param parts  a mesh on the surface that was drawn
// \param drawn_facets [F of parts] the facet that each is a part of; ascending
FacetVisibility FindVisibleParts(const VisibilityBuffers& buffers,
                                 const TriangleMesh& parts,
                                 const std::vector<uint32_t>& drawn_facets);

}  // namespace colmap_ext
