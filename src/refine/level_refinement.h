#pragma once

#include <functional>
#include <vector>

#include <Eigen/Core>

#include "labeling/view_pairs.h"
#include "mesh/surface.h"
#include "mesh/triangle_mesh.h"
#include "photometry/photometric_energy.h"
#include "refine/facetwise_refinement.h"
#include "scene/view.h"

namespace colmap_ext {

// What a level is refined by.
struct RefinementLevel {
  int level = 0;                   // the images are 2^level times smaller
  FacetLabels labels;              // [F]
  const std::vector<View>& views;  // of the level's images' sizes
  const std::vector<Eigen::Vector3f>& origins;  // [V] see RefinedMesh
  FixedVertices fixed = {};                     // of the mesh
};

struct RefinedLevel {
  TriangleMesh mesh;
  // [F] of the last step's surface; of the first for facets that are not
  // confirmed (ConfirmedFacets()).
  PhotometricTerms terms;
  bool is_stopped = false;  // by on_step
};

// Called before the first step and after each step, with the current mesh;
// returns whether to continue.
using OnLevelStep =
    std::function<bool(const RefinementStep& step, const TriangleMesh& mesh)>;

// Moves a mesh's vertices along their normals, so that the energy, photometric
// and smoothness, falls (docs/method.md, sections 6 and 7.3), until a step
// hardly lowers it, at most options.iterations times.
//
// The first `pairs_per_facet` labels of each facet are used first, all of them
// in the final iterations, which only the finest level has: progress needs many
// iterations, but the remaining noise depends only on the last ones.
//
// At the finest level the visible surface is smoothed (ThinPlate).
// Elsewhere, and at the coarser levels, only the motion of the level is
// smoothed: coarse images cannot distinguish fine relief from noise, and must
// not flatten it; and facets that are not compared follow their surroundings.
// After two iterations at the finest level the smoothness aims at the part of
// the input's relief that the refined surface shows too (ReliefShares()).
//
// \pre `energy` is set to the level
RefinedLevel RefineLevel(const FacetwiseRefinementOptions& options,
                         RefinementLevel level, TriangleMesh mesh,
                         PhotometricEnergy* energy, const OnLevelStep& on_step);

}  // namespace colmap_ext
