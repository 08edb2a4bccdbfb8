#pragma once

#include <cstddef>
#include <functional>

#include <Eigen/Core>

#include "labeling/facet_labels.h"
#include "mesh/triangle_mesh.h"
#include "photometry/photometric_energy.h"
#include "refine/facetwise_refinement.h"
#include "scene/view.h"

namespace colmap_ext {

// Called with each step, the mesh as it is then; whether to go on.
using OnLevelStep = std::function<bool(const RefinementStep& step)>;

// Moves a mesh's vertices along their normals until the energy, photometric and
// smoothness, no longer falls: each step is Gauss-Newton's (or each vertex's by
// itself), limited to a part of the edges' lengths and a pixel, shortened where
// it would turn a facet over, and halved until the energy falls.
//
// That is done by the first `pairs_per_facet` labels of each facet; then two
// more iterations are by all of them. How far the surface comes depends on the
// number of steps, but the noise that remains on the last ones alone: the many
// labels, which take their time, are best kept for the end.
//
// The surface is to be smooth (refine/thin_plate.h) at the finest level, where
// it is seen. Elsewhere, and at the coarser levels, it is the motion of the
// level that is to be smooth: coarse images can not tell fine relief from
// noise, and must not flatten it; and what no pair sees follows what lies
// around it.
//
// Once the finest images alone have had their say, the surface is to have what
// they confirm of the relief that the mesh was given with (refine/relief.h):
// where they are too noisy to show fine relief, that of an accurate mesh
// remains, but not the noise of another one.
//
// How much smoothness weighs there is taken from the surface
// (refine/smoothness_weights.h): as much as makes its roughness, where the
// images determine it, as likely as it is. A wall of rubble so keeps its
// relief, and a polished statue is rid of the images' noise.
//
// \param energy  set to the level.
// \param views  of the level's images' sizes.
// \param origins  [V] see RefinedMesh
// \return how many vertices' steps were shortened.
size_t RefineLevel(const FacetwiseRefinementOptions& options, int level,
                   const FacetLabels& labels, const std::vector<View>& views,
                   const std::vector<Eigen::Vector3f>& origins,
                   PhotometricEnergy* energy, TriangleMesh* mesh,
                   const OnLevelStep& on_step);

}  // namespace colmap_ext
