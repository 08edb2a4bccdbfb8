#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include <Eigen/Core>

#include "delaunay/cell_part.h"
#include "delaunay/ray_places.h"
#include "delaunay/tetrahedralization.h"
#include "delaunay/visibility_weights.h"
#include "optim/min_cut.h"

namespace colmap_ext {

// Points whose rays pass through a part of a tetrahedralization.
struct PartPoints {
  std::vector<Eigen::Vector3f> positions;  // [P] world frame
  std::vector<uint32_t> vertices;          // [P] or kNoVertex
  Observations observations;               // [P], without ends

  size_t size() const { return positions.size(); }
};

// Counts the votes that AddVisibilityWeights() counts for the arcs from and to
// the cells of a part. Rays of other vertices than its corners are walked
// within the part alone, from where they come in. The points may be such that
// are no vertices: what they do beyond the cells that hold them is the same. A
// point that lies on a facet near the part is moved off it, by a millionth of
// sigma.
class PartVotes {
 public:
  // \param centers [views] camera centres, world frame
  // \param graph  is added to
  PartVotes(const Tetrahedralization& tetrahedra, const CellPart& part,
            const std::vector<Eigen::Vector3d>& centers,
            const VisibilityWeightOptions& options, FlowCapacities* graph)
      : tetrahedra_(tetrahedra),
        part_(part),
        centers_(LocateCenters(tetrahedra, centers, options.distance_sigma)),
        options_(options),
        graph_(graph) {}

  // \param points  near each other where they follow each other
  RayReport Add(const PartPoints& points);

 private:
  const Tetrahedralization& tetrahedra_;
  const CellPart& part_;
  std::vector<RayPlace> centers_;  // [views]
  const VisibilityWeightOptions options_;
  FlowCapacities* graph_;
};

}  // namespace colmap_ext
