#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>

#include "base/lru_cache.h"
#include "gl/facet_drawer.h"
#include "gl/gl_objects.h"
#include "mesh/triangle_mesh.h"
#include "photometry/image_pyramid.h"

namespace colmap_ext {

// What OpenGL needs of a view: its image, and the mesh drawn into it.
struct ViewTextures {
  ViewTextures(const GrayImage& gray_image, int width, int height);

  // On the card, bytes.
  static size_t Memory(const View& view, size_t num_facets);

  GlTexture image;  // R8UI
  FacetTextures drawn;
  uint64_t drawn_mesh = 0;  // number of the mesh, see ViewTextureCache; 0: none
};

// Views on the graphics card, as many as memory allows; the least recently used
// ones are dropped. To be used by one thread at a time.
class ViewTextureCache {
 public:
  // \param min_cosine  see DrawFacets().
  // \param max_memory  bytes; views in use are always kept.
  ViewTextureCache(std::shared_ptr<ImagePyramid> images, double min_cosine,
                   size_t max_memory);

  // Drops all views; their size has changed.
  void Clear() { views_.Clear(); }

  // \param max_memory  as of the constructor.
  void SetMaxMemory(size_t max_memory) { views_.SetMaxBytes(max_memory); }

  // What is to be drawn.
  void SetMesh(std::shared_ptr<const TriangleMesh> mesh);
  const GlBuffer& Vertices() const { return vertices_; }  // [V][3] float
  const GlBuffer& Facets() const { return facets_; }      // [F][3] uint

  // With the mesh drawn into it.
  std::shared_ptr<const ViewTextures> Get(size_t view);

 private:
  std::shared_ptr<ImagePyramid> images_;
  FacetDrawer drawer_;
  std::shared_ptr<const TriangleMesh> mesh_;
  uint64_t num_meshes_ = 0;  // the number of the mesh at hand
  GlBuffer vertices_;
  GlBuffer facets_;
  LruCache<ViewTextures> views_;
};

}  // namespace colmap_ext
