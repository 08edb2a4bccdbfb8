#pragma once

#include <cstdint>
#include <vector>

#include <Eigen/Core>

#include "tiles/tile_cut.h"

namespace colmap_ext {

// Points with rays, and what is to be done with them: all that is not sure is
// cut at the seams, so that the result is that of one machine.
struct SeenScene {
  // Adds a point, and the views whose centers see it.
  template <typename IsSeen>
  void Add(const Eigen::Vector3d& point, const IsSeen& is_seen) {
    points.push_back(point.cast<float>());
    for (uint32_t view = 0; view < centers.size(); ++view) {
      if (is_seen(centers[view])) {
        observations.values.push_back(
            {view, 0.25f + 0.125f * static_cast<float>(view % 5)});
      }
    }
    observations.EndRow();
  }

  std::vector<Eigen::Vector3f> points;
  Observations observations;  // by points
  std::vector<Eigen::Vector3d> centers;
  TileCutOptions options = {.rays = {}, .seam_rings = kAllAtOnce};
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

}  // namespace colmap_ext
