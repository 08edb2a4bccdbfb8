#pragma once

#include <filesystem>
#include <vector>

#include <Eigen/Core>

#include "colmap_ext/refinement/run_identity.h"
#include "mesh/triangle_mesh.h"
#include "mesh/vertex_attributes.h"
#include "refine/facetwise_refinement.h"
#include "refine/fixed_sources.h"
#include "scene/view.h"

namespace colmap_ext {

// The state from which an interrupted refinement is resumed: the mesh of the
// last complete level as OUTPUT.levelN.ply with its .vis, the origins of its
// vertices as OUTPUT.levelN.origin.ply, the fixed vertices as the .vis of that,
// and OUTPUT.ply.resume (resume_file.h).

struct RefinementState {
  int level = 0;  // the last one that is complete, 1 or more
  TriangleMesh mesh;
  VertexAttributes attributes;
  std::vector<Eigen::Vector3f> origins;  // [V] see RefinedMesh
  FixedSources fixed_sources;            // [V] see RefinedMesh, or empty
  std::vector<View> views;               // refined up to there
  RefinementReport report;               // up to there
};

std::filesystem::path StatePath(const std::filesystem::path& output);
std::filesystem::path LevelMeshPath(const std::filesystem::path& output,
                                    int level);
std::filesystem::path LevelOriginPath(const std::filesystem::path& output,
                                      int level);

// Writes these files, the mesh checked, and removes those of the level before.
// \throw FileError if they can not be written; std::logic_error if the mesh is
//        not manifold.
void WriteState(const std::filesystem::path& output,
                const RunIdentity& identity, const RefinementState& state);

// \param views  before they were refined.
// \throw FileError if there is no state, it is damaged, or belongs to another
//        run: it says what differs.
RefinementState ReadState(const std::filesystem::path& output,
                          const RunIdentity& identity,
                          const std::vector<View>& views);

// Removes what WriteState() wrote for a level.
void RemoveState(const std::filesystem::path& output, int level);

// \throw std::logic_error if it is not manifold.
void ExpectManifold(const TriangleMesh& mesh);

}  // namespace colmap_ext
