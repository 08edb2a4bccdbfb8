#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "delaunay/tetrahedralization.h"
#include "delaunay/visibility_weights.h"
#include "optim/min_cut.h"
#include "scene/point_cloud.h"
#include "tests/random.h"

// Tetrahedralizations, labels and graphs to try things on.
namespace colmap_ext {

struct NamedPoints {
  std::string name;
  std::vector<Eigen::Vector3f> points;
};

// Integer coordinates in -range ... range.
std::vector<Eigen::Vector3f> RandomPoints(uint32_t num_points, int range,
                                          Random* random);

// The nodes of a lattice, size^3: all cospherical and coplanar in many ways.
std::vector<Eigen::Vector3f> GridPoints(int size);

// Sets of points with integer coordinates, most of them in no general position.
std::vector<NamedPoints> DifficultPoints();

// The same with even coordinates: midpoints are integers, too.
std::vector<NamedPoints> EvenDifficultPoints();

// Points that no view sees.
PointCloud CloudOf(const std::vector<Eigen::Vector3f>& points);

// Of all points.
Tetrahedralization DelaunayOf(const std::vector<Eigen::Vector3f>& points);

// Any of its points.
Eigen::Vector3d AnyPoint(const Tetrahedralization& tetrahedra, Random* random);

// Random observations of all vertices, and cameras.
struct SeenComplex {
  // \param ranges  [views] of the cameras' coordinates
  SeenComplex(uint32_t num_points, const std::vector<int>& ranges);

  Tetrahedralization tetrahedra;
  Observations observations;
  std::vector<Eigen::Vector3d> centers;
};

// Capacities up to a maximum.
FlowCapacities RandomGraphOf(const Tetrahedralization& tetrahedra,
                             uint32_t max_capacity, Random* random);

// Of all nodes.
// \param terminal  source or sink
uint64_t SumOf(const FlowCapacities& graph, uint32_t NodeCapacities::*terminal);

// Labels of cells, 1 for free: independent ones of several densities, smooth
// ones, and every other cell. Infinite cells alike.
std::vector<uint8_t> RandomLabels(const Tetrahedralization& tetrahedra,
                                  Random* random);

// Gives all infinite cells one label.
void LabelInfinite(const Tetrahedralization& tetrahedra, bool is_free,
                   std::vector<uint8_t>* labels);

// Which defect the tetrahedralization's arrays have as a closed, oriented
// complex; empty where there is none. \param has_geometry whether orientation
// in space is looked at, too
std::string DefectOf(const Tetrahedralization& tetrahedra, bool has_geometry);

}  // namespace colmap_ext
