#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>

#include <Eigen/Core>

#include "meshing/manifold_meshing.h"
#include "refine/facetwise_refinement.h"
#include "scene/progress.h"

namespace colmap_ext {

struct MergeReport {
  size_t num_tiles = 0;
  size_t num_cut_cells = 0;  // at the seams
  // Arcs between cells of two tiles that tell them differently (CutSeams).
  size_t num_contradictions = 0;
  ManifoldMeshingReport meshing;
};

// Writes the mesh of a plan all of whose tiles are done, as WriteMesh() does,
// and the region that was found for the plan beside it.
// \param transform  of the mesh that is written
// \throw FileError as RunTile(), where a tile is not done, and where the mesh
//        can not be written
MergeReport MergePlan(const std::filesystem::path& folder,
                      const std::filesystem::path& output_path,
                      const std::optional<Eigen::Matrix4d>& transform,
                      const Progress& progress);

// The refined surface of a plan, all of whose tiles are refined: their patches
// put together, borders and self-intersections as RefineFacetwise() leaves
// them.
// \throw FileError if a tile is not refined, or patches do not fit together
RefinedMesh MergeRefined(const std::filesystem::path& folder,
                         const Progress& progress);

}  // namespace colmap_ext
