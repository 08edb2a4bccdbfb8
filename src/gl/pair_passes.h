#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "gl/egl_context.h"
#include "gl/gl_objects.h"
#include "gl/program.h"
#include "gl/view_textures.h"
#include "photometry/photometric_energy.h"
#include "scene/view.h"

namespace colmap_ext {

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
    Planes(int width, int height);

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
