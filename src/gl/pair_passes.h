#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "base/lru_cache.h"
#include "gl/egl_context.h"
#include "gl/gl_objects.h"
#include "mesh/triangle_mesh.h"
#include "photometry/image_pyramid.h"
#include "photometry/photometric_energy.h"
#include "raster/facet_clusters.h"
#include "scene/images.h"
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

// A corner of a triangle of the part of a facet in and around an image.
struct ClippedCorner {
  float u, v;  // px, multiples of 1/256
  float inverse_depth;
  uint32_t facet;
};

// What there is to draw of a mesh into a view.
struct FacetsInView {
  std::vector<FacetRange> ranges;  // begin at multiples of 32
  // Three a triangle, of those that facet_ids.vert leaves out.
  std::vector<ClippedCorner> clipped;
  float depth_scale = 1;  // see FacetTextures
};

// Does not need OpenGL.
// \param ranges  of the facets that are drawn, see DrawFacets().
FacetsInView FindFacetsInView(const View& view, const TriangleMesh& mesh,
                              std::vector<FacetRange> ranges);

// Draws a mesh into views, as DrawFacets() of raster/facet_id_buffer.h does.
class FacetDrawer {
 public:
  // \param min_cosine  see DrawFacets().
  explicit FacetDrawer(double min_cosine);

  // \param vertices, facets  the arrays of the mesh.
  // \param mask  whose pixels of 0 show nothing, see EraseMasked(); or null.
  void Draw(const View& view, const FacetsInView& in_view,
            const GlBuffer& vertices, const GlBuffer& facets,
            FacetTextures* textures, const GrayImage* mask = nullptr);

 private:
  void BeginImages(const View& view, FacetTextures* textures);
  void DrawMask(const GrayImage& mask);
  void DrawImages(const View& view, std::span<const FacetRange> ranges,
                  const GlBuffer& vertices, const GlBuffer& facets,
                  FacetTextures* textures);
  void DrawClipped(const View& view, const std::vector<ClippedCorner>& clipped,
                   const FacetTextures& textures);
  void FindFacing(const View& view, std::span<const FacetRange> ranges,
                  const GlBuffer& vertices, const GlBuffer& facets,
                  FacetTextures* textures);

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
  void Clear() {
    views_.Clear();
    in_views_.clear();
  }

  // \param max_memory  as of the constructor.
  void SetMaxMemory(size_t max_memory) { views_.SetMaxBytes(max_memory); }

  // What is to be drawn.
  void SetMesh(std::shared_ptr<const TriangleMesh> mesh);
  const GlBuffer& Vertices() const { return vertices_; }  // [V][3] float
  const GlBuffer& Facets() const { return facets_; }      // [F][3] uint

  // With the mesh drawn into it.
  std::shared_ptr<const ViewTextures> Get(size_t view);

 private:
  void FindInViews();

  std::shared_ptr<ImagePyramid> images_;
  FacetDrawer drawer_;
  std::shared_ptr<const TriangleMesh> mesh_;
  // [views] of the mesh, found for all at a time, in parallel; empty: not yet
  std::vector<FacetsInView> in_views_;
  uint64_t num_meshes_ = 0;  // the number of the mesh at hand
  GlBuffer vertices_;
  GlBuffer facets_;
  LruCache<ViewTextures> views_;
};

// What the passes read and write of the mesh. Kept by reference.
struct PairBuffers {
  const GlBuffer& drawn_vertices;  // [V][3] float, those that were drawn
  const GlBuffer& vertices;        // [V][3] float, the present ones
  const GlBuffer& facets;          // [F][3] uint
  const GlBuffer& chosen_facets;   // uint, of all directions: see
                                   // GroupByDirection()
  const GlBuffer& normals;         // [F][3] double, the present ones
  const GlBuffer& sums;            // [F][12] float, added to: see gather.comp
};

// One direction of a pair, i <- j.
struct PairDirection {
  const View& view_i;
  const View& view_j;
  const ViewTextures& textures_i;
  const ViewTextures& textures_j;
  uint64_t first_facet = 0;          // of the direction's, in chosen_facets
  std::span<const uint32_t> facets;  // the same, ascending
};

// What a direction of a pair adds to the sums of the facets compared in it, in
// passes over the tiles of image i that show them: warp image j, correlate
// windows, differentiate; then gather facet by facet.
class PairPasses {
 public:
  PairPasses(const PhotometricOptions& options, const GlLimits& limits);

  // On the card, once all pairs were compared, bytes.
  static size_t Memory(const std::vector<View>& views);

  void Run(const PairDirection& direction, const PairBuffers& buffers);

 private:
  // What the passes hand on, pixel by pixel of image i.
  struct Planes {
    GlTexture warped;       // I_i, I_ij, inverse depth, motion
    GlTexture windows;      // see correlate.comp
    GlTexture energies;     // energy, weight
    GlTexture derivatives;  // first, second
  };

  void Reserve(const View& view_i, size_t num_facets);
  void FindTiles(const PairDirection& direction);
  void Warp(const PairDirection& direction);
  void Correlate(const PairDirection& direction);
  void Differentiate(const PairDirection& direction);
  void Gather(const PairDirection& direction, const PairBuffers& buffers);
  void SetFacetBox(const PairDirection& direction, Program* program) const;
  void SetWindows(const PairDirection& direction, Program* program) const;

  PhotometricOptions options_;
  GlLimits limits_;
  Program find_tiles_;
  Program warp_;
  Program correlate_;
  Program differentiate_;
  Program gather_;
  GlBuffer label_stamps_;  // [F] uint
  GlBuffer tiles_;         // 4 uint, then [tiles] uint
  GlBuffer tile_stamps_;   // [tiles] uint
  std::optional<Planes> planes_;
  uint32_t stamp_ = 0;  // of the direction at hand
};

}  // namespace colmap_ext
