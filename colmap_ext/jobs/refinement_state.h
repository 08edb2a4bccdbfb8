#pragma once

#include <filesystem>
#include <vector>

#include <Eigen/Core>

#include "colmap_ext/jobs/job_inputs.h"
#include "mesh/surface.h"
#include "mesh/triangle_mesh.h"
#include "mesh/vertex_attributes.h"
#include "refine/facetwise_refinement.h"
#include "scene/view.h"

namespace colmap_ext {

// OUTPUT.resume: the state after a complete level, from which an interrupted
// refinement is resumed.
struct RefinementState {
  int level = 0;  // the last one that is complete, 1 or more
  TriangleMesh mesh;
  VertexAttributes attributes;
  std::vector<Eigen::Vector3f> origins;  // [V] see RefinedMesh
  FixedSources fixed_sources;            // [V] see RefinedMesh, or empty
  std::vector<View> views;               // refined up to there
  RefinementReport report;  // steps, labelings, counts and misalignment
};

std::filesystem::path StatePath(const std::filesystem::path& output);

// \throw FileError if it can not be written; std::logic_error if the mesh is
//        not manifold.
void WriteState(const std::filesystem::path& output, const JobInputs& inputs,
                const RefinementState& state);

// \param views  before they were refined.
// \throw FileError if there is no state, it is damaged, or belongs to another
//        run: the message names the difference.
RefinementState ReadState(const std::filesystem::path& output,
                          const JobInputs& inputs,
                          const std::vector<View>& views);

void RemoveState(const std::filesystem::path& output);

// \throw std::logic_error if it is not manifold.
void ExpectManifold(const TriangleMesh& mesh);

}  // namespace colmap_ext
