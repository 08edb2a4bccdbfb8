#pragma once

#include <cstddef>
#include <list>
#include <memory>

#include "gl/facet_drawer.h"
#include "gl/gl_objects.h"
#include "mesh/triangle_mesh.h"
#include "photometry/image_pyramid.h"

namespace colmap_ext {

// What OpenGL needs of a view: its image, and the mesh drawn into it.
struct ViewTextures {
  ViewTextures(const GrayImage& gray_image, int width, int height);

  GlTexture image;  // R8UI
  FacetTextures drawn;
  bool is_drawn = false;  // the mesh at hand
};

// Views on the graphics card, as many at a time as memory allows: those that
// were not used for the longest time make room.
class ViewTextureCache {
 public:
  // \param min_cosine  see DrawFacets().
  // \param max_memory  bytes; two views are kept whatever they take.
  ViewTextureCache(std::shared_ptr<ImagePyramid> images, double min_cosine,
                   size_t max_memory);

  // Drops all views; their size has changed.
  void Clear();

  // What is to be drawn.
  void SetMesh(const TriangleMesh& mesh);
  const GlBuffer& Vertices() const { return vertices_; }  // [V][3] float
  const GlBuffer& Facets() const { return facets_; }      // [F][3] uint

  // Valid until the next but one call.
  const ViewTextures& Get(size_t view);

 private:
  struct Entry {
    Entry(size_t index, size_t num_bytes, const GrayImage& image, int width,
          int height)
        : view(index), memory(num_bytes), textures(image, width, height) {}

    size_t view;
    size_t memory;  // bytes
    ViewTextures textures;
  };

  void MakeRoom(size_t num_bytes);

  std::shared_ptr<ImagePyramid> images_;
  size_t max_memory_;
  FacetDrawer drawer_;
  TriangleMesh mesh_;
  GlBuffer vertices_;
  GlBuffer facets_;
  std::list<Entry> entries_;  // the last used first
  size_t memory_ = 0;         // of the entries, bytes
};

}  // namespace colmap_ext
