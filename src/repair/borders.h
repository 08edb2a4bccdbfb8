#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "mesh/surface.h"
#include "scene/view.h"

namespace colmap_ext {

// What a trimming did.
struct TrimReport {
  size_t num_facets = 0;           // dropped
  size_t num_leftover_facets = 0;  // of them: confident, in small pieces
  size_t num_kept_facets = 0;      // of low confidence, kept
};

struct TrimmedMesh : DerivedMesh {  // manifold, its facets in their order
  TrimReport report;
};

// Drops the parts of low confidence from a surface (docs/method.md, section
// 3.8).
//
// What is left are the confident facets and the gaps between them that are
// narrower than two gap widths: a closing along the surface, without the webs
// that a plain one leaves in corners. Nothing is added along the outer border.
// Regions that are enclosed or continue the surface around them are kept, see
// KeepEnclosed() and KeepContinuations(). Shreds thinner than a gap width are
// dropped, and so are pieces smaller than a disk of the gap width, but for the
// largest; facets count with the squares of their confidences, or of
// front_shares of these. The borders that this opens are smoothed along
// themselves; no other vertex moves. Where nothing is dropped the mesh is not
// changed.
//
// \param min_confidence  0: drops nothing
// \param facet_confidences [F] in [0, 1]
// \param gap_widths [V] scene units, not negative
// \param front_shares [F] in [0, 1], see FrontShares(), or empty: 1
// \pre the mesh is manifold
TrimmedMesh TrimMesh(double min_confidence, TriangleMesh mesh,
                     const std::vector<float>& facet_confidences,
                     const std::vector<float>& gap_widths,
                     const std::vector<float>& front_shares = {});

inline constexpr double kAllLoops = -1;

// What the closing of holes did.
struct HoleReport {
  size_t num_loops = 0;         // border loops that were to be closed
  size_t num_closed = 0;        // of them
  size_t num_facets = 0;        // new
  size_t num_vertices = 0;      // new
  size_t num_intersecting = 0;  // closed by facets that intersect others

  // Loops left open, since their facets would not be manifold or intersect.
  size_t NumLeft() const { return num_loops - num_closed; }
};

// Closes the holes of a mesh (docs/method.md, section 3.9): border loops that
// the surface lies around and that are no wider than max_width. A loop is
// filled by small facets bent as the surface around it, or else, where these
// would intersect others or not be manifold, by flatter ones, and finally by
// facets that intersect others, which is for RepairSelfIntersections(). New
// vertices have the confidence 0 if the old ones have any, no views, and colors
// by the inverse squared distances from the vertices of the loop. Old vertices
// and facets stay as they are, before the new ones.
// \param max_width  px; 0: none are closed, kAllLoops: all border loops
// \param footprints [V] scene units a pixel, positive; of no use for kAllLoops
// \pre the mesh is manifold
HoleReport CloseHoles(double max_width, std::span<const float> footprints,
                      Surface* surface);

// Closes the border loops of these vertices alone, as CloseHoles(), where
// facets intersect no others.
// \param is_new [V]
HoleReport CloseNewHoles(const std::vector<uint8_t>& is_new, Surface* surface);

// Smooths borders along themselves: a vertex where two of the given half-edges
// meet, and no other border, moves halfway to the middle of its two neighbors
// on the border, thirty times in turn. A vertex does not move if a facet would
// turn by more than 60 degrees, and is back where it was where facets would
// intersect that did not.
// \param is_moved [3 F] the half-edges at the border that is smoothed
// \pre the mesh is manifold
void SmoothBorders(const std::vector<uint8_t>& is_moved, TriangleMesh* mesh);

struct BorderOptions {
  // Facets of less confidence are dropped, see TrimMesh(). In [0, 1]; 0: none.
  double trim = 0;

  // Holes of up to this width are closed, px, see CloseHoles(); 0: none,
  // kAllLoops: all.
  double close_holes = 0;

  // The gap width of TrimMesh(), px of Footprints(). Not negative.
  double gap_pixels = 32;

  // If no facet is confident, the mesh is not trimmed.
  bool is_trim_optional = false;
};

struct BorderReport {
  TrimReport trim;
  HoleReport holes;
};

// Trims a surface, then closes its holes.
// \param facet_confidences [F] in [0, 1]
// \param views  that the surface's attributes name
// \param front_shares  see TrimMesh()
// \return what it comes from
// \pre the mesh is manifold, options in their ranges
// \throw std::invalid_argument if the trimming leaves nothing, unless it is
//        optional.
Provenance TrimAndCloseHoles(const BorderOptions& options,
                             const std::vector<float>& facet_confidences,
                             const std::vector<View>& views, Surface* surface,
                             BorderReport* report,
                             const std::vector<float>& front_shares = {});

}  // namespace colmap_ext
