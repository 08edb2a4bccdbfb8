#pragma once

#include <cstddef>
#include <cstdint>

#include "gl/gl_objects.h"
#include "gl/program.h"
#include "mesh/triangle_mesh.h"
#include "scene/gray_image.h"
#include "scene/view.h"

namespace colmap_ext {

// Which facet each pixel of a view shows, and how near.
struct FacetTextures {
  FacetTextures(int width, int height);

  GlTexture facets;       // R32UI, or kNone
  GlTexture depths;       // 32 bit depth; inverse ones times depth_scale, below
                          // 1; 1 where the pixel is masked
  float depth_scale = 1;  // scene units, a power of two
  GlBuffer facing;        // [F] bits, see facing.comp
};

// Draws a mesh into views, as DrawFacets() of raster/facet_id_buffer.h does.
class FacetDrawer {
 public:
  // \param min_cosine  see DrawFacets().
  explicit FacetDrawer(double min_cosine);

  // \param vertices, facets  the arrays of `mesh`.
  // \param mask  whose pixels of 0 show nothing, see EraseMasked(); or null.
  void Draw(const View& view, const TriangleMesh& mesh,
            const GlBuffer& vertices, const GlBuffer& facets,
            FacetTextures* textures, const GrayImage* mask = nullptr);

 private:
  void BeginImages(const View& view, FacetTextures* textures);
  void DrawMask(const GrayImage& mask);
  void DrawImages(const View& view, size_t num_facets, const GlBuffer& vertices,
                  const GlBuffer& facets, FacetTextures* textures);
  // Triangles, each of three of `corners`.
  void DrawClipped(const View& view, size_t num_corners,
                   const GlBuffer& corners, const FacetTextures& textures);
  void FindFacing(const View& view, size_t num_facets, const GlBuffer& vertices,
                  const GlBuffer& facets, FacetTextures* textures);

  double min_cosine_;
  Program mask_;
  Program ids_;
  Program clipped_;
  Program facing_;
  GlFramebuffer framebuffer_;
  GlVertexArray vertex_array_;
  GlVertexArray clipped_array_;
  GlVertexArray no_vertices_;
};

}  // namespace colmap_ext
