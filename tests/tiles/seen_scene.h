#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <vector>

#include <Eigen/Core>

#include "delaunay/tetrahedralization.h"
#include "tests/tiles/memory_plan.h"
#include "tiles/tile_cut.h"
#include "tiles/tile_part.h"

namespace colmap_ext {

// Points with rays, and what is to be done with them: all that is not sure is
// cut at the seams, so that the result is that of one machine.
struct SeenScene {
  std::vector<Eigen::Vector3f> points;
  Observations observations;  // by points
  std::vector<Eigen::Vector3d> centers;
  TileCutOptions options;
};

// A noisy sphere that cameras around it see, and some points far off.
SeenScene SphereScene(size_t num_points, uint64_t seed, double noise = 0.02);

// A wavy ground that cameras above it see.
SeenScene GroundScene(size_t num_points, uint64_t seed);

// The same with rays that end in the air, one for every ten points.
SeenScene GroundSceneWithEnds(size_t num_points, uint64_t seed);

// Nodes of a lattice, long enough along the x axis that tiles do not have each
// other's points; not all of them. Cameras are within and around them: at nodes
// and between two, in the planes and on the lines through others, and see
// half of the points. Rays end behind their points where other nodes are, and
// their weights stop falling there.
// \param unit  of the lattice
SeenScene LatticeScene(uint64_t seed, float unit = 1);

// A long box on the ground, of unit squares whose corners are points, seen from
// nodes of the lattice.
SeenScene BoxScene(float unit = 1);

// A cluster of a third of the points, and one of the others far off, whose
// cameras are around it.
SeenScene ClustersScene(uint64_t seed);

// All vertices of a plan on one machine, in the plan's order.
struct WholeCut {
  Tetrahedralization tetrahedra;
  std::vector<uint32_t> ids;  // [V] the plan's
  FlowCapacities graph;
  std::vector<uint8_t> labels;
};
WholeCut CutWhole(const SeenScene& scene, const MemoryPlan& plan);

// A cell by its corners' ids, in order.
CellKey KeyOf(const Tetrahedralization::Cell& cell,
              const std::vector<uint32_t>& ids);
std::map<CellKey, uint32_t> CellsByKey(const WholeCut& whole);

}  // namespace colmap_ext
