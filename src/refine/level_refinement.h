#pragma once

#include <cstddef>
#include <functional>

#include <Eigen/Core>

#include "mesh/triangle_mesh.h"
#include "refine/facet_labels.h"
#include "refine/facetwise_refinement.h"
#include "refine/photometric_energy.h"
#include "scene/view.h"

namespace colmap_ext {

// Called with each step, the mesh as it is then; whether to go on.
using OnLevelStep = std::function<bool(const RefinementStep& step)>;

// Moves a mesh's vertices along their normals until the energy, photometric and
// smoothness, no longer falls: each step is Gauss-Newton's (or each vertex's by
// itself), limited to a part of the edges' lengths and a pixel, shortened where
// it would turn a facet over, and halved until the energy falls.
//
// At the finest level the surface is to have the relief of the one that it
// comes from (refine/relief.h), unless the images say otherwise. At the coarser
// levels, and where no pair sees it, it is the motion of the level that is to
// be smooth: coarse images can not tell fine relief from noise, and must not
// flatten it; and what is not seen follows what lies around it.
//
// How much that relief weighs is taken from the surface (MacKay 1992): as much
// as makes its departure from it, where the images determine it, as likely as
// it is. A wall of rubble so gets what the mesh lacks of its relief, and a
// polished statue is rid of the images' noise.
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
