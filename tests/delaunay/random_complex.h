#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <set>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "delaunay/ray_walk.h"
#include "delaunay/tetrahedralization.h"
#include "delaunay/thinning.h"
#include "delaunay/visibility_weights.h"
#include "optim/min_cut.h"
#include "scene/point_cloud.h"
#include "tests/delaunay/exact.h"
#include "tests/random_vectors.h"

// Tetrahedralizations, labels and graphs to try things on.
namespace colmap_ext {

struct NamedPoints {
  std::string name;
  std::vector<Eigen::Vector3f> points;
};

// The nodes of a lattice, size^3: all cospherical and coplanar in many ways.
inline std::vector<Eigen::Vector3f> GridPoints(int size) {
  std::vector<Eigen::Vector3f> points;
  for (int i = 0; i < size * size * size; ++i) {
    points.emplace_back(i % size, i / size % size, i / (size * size));
  }
  return points;
}

// The vertices of a cell's facet, sorted.
inline std::array<uint32_t, 3> FacetOf(const Tetrahedralization::Cell& cell,
                                       int i) {
  std::array<uint32_t, 3> facet = FacetVertices(cell, i);
  std::ranges::sort(facet);
  return facet;
}

// Whether the corners of a facet, as kFacetCorners orders them, are an odd
// permutation of the sorted ones.
inline bool IsOdd(const Tetrahedralization::Cell& cell, int i) {
  const auto [a, b, c] = FacetVertices(cell, i);
  return (a > b) ^ (b > c) ^ (a > c);
}

inline std::vector<Eigen::Vector3f> SpherePoints(int radius_squared) {
  std::vector<Eigen::Vector3f> points;
  const int bound = static_cast<int>(std::sqrt(radius_squared));
  for (int x = -bound; x <= bound; ++x) {
    for (int y = -bound; y <= bound; ++y) {
      for (int z = -bound; z <= bound; ++z) {
        if (x * x + y * y + z * z == radius_squared) {
          points.emplace_back(x, y, z);
        }
      }
    }
  }
  return points;
}

// Sets of points with integer coordinates, most of them in no general position.
inline std::vector<NamedPoints> DifficultPoints() {
  Random random(7);
  std::vector<NamedPoints> sets = {
      {"four points", {{0, 0, 0}, {8, 0, 0}, {0, 8, 0}, {0, 0, 8}}},
      {"random", RandomPoints(150, 1 << 18, &random)},
      {"few integers", RandomPoints(120, 3, &random)},
      {"cube grid", GridPoints(5)},
      {"sphere", SpherePoints(9 * 9 * 9)},
      {"sphere and centre", SpherePoints(81)},
      {"plane and a point", {{3, 2, 40}}},
      {"two planes", {}},
      {"two lines", {}},
      {"cone", {{0, 0, 1000}}},
  };
  sets[5].points.emplace_back(0, 0, 0);
  for (int i = 0; i < 100; ++i) {
    sets[6].points.emplace_back(i % 10, i / 10, 0);
    sets[7].points.emplace_back(i % 7, i / 7 % 7, i < 50 ? 0 : 3);
  }
  for (int i = 0; i < 12; ++i) {
    sets[8].points.emplace_back(i, 0, 0);
    sets[8].points.emplace_back(5, i - 6, 4);
  }
  // A vertex of very many cells.
  const std::vector<Eigen::Vector3f> disc = RandomPoints(200, 1000, &random);
  for (const Eigen::Vector3f& point : disc) {
    sets[9].points.emplace_back(point.x(), point.y(),
                                point.z() > 990 ? 1.0f : 0.0f);
  }
  return sets;
}

// The same with even coordinates: midpoints are integers, too.
inline std::vector<NamedPoints> EvenDifficultPoints() {
  std::vector<NamedPoints> sets = DifficultPoints();
  for (auto& [name, points] : sets) {
    for (Eigen::Vector3f& point : points) {
      point *= 2;
    }
  }
  return sets;
}

// Points that no view sees.
inline PointCloud CloudOf(const std::vector<Eigen::Vector3f>& points) {
  PointCloud cloud;
  cloud.positions = points;
  cloud.views.offsets.assign(points.size() + 1, 0);
  return cloud;
}

// Of all points.
inline Tetrahedralization DelaunayOf(
    const std::vector<Eigen::Vector3f>& points) {
  return Tetrahedralize(
      ThinPoints(CloudOf(points), {}, {.max_proj_dist = 0}).positions);
}

// The way of one ray.
inline RayPath PathOf(const Tetrahedralization& tetrahedra, const Ray& ray) {
  RayPath path;
  WalkRays(tetrahedra, {&ray, 1}, {&path, 1});
  return path;
}

// Any of its points.
inline Eigen::Vector3d AnyPoint(const Tetrahedralization& tetrahedra,
                                Random* random) {
  return tetrahedra.PositionOf(random->Below(tetrahedra.points.size()));
}

// Random observations of all vertices, and cameras.
struct SeenComplex {
  // \param ranges  [views] of the cameras' coordinates
  SeenComplex(uint32_t num_points, const std::vector<int>& ranges) {
    Random random(num_points);
    tetrahedra = DelaunayOf(RandomPoints(num_points, 300, &random));
    for (size_t vertex = 0; vertex < tetrahedra.points.size(); ++vertex) {
      for (uint32_t view = 0; view < ranges.size(); ++view) {
        if (random.Chance(0.5)) {
          observations.values.push_back(
              {view, 3 * static_cast<float>(random.Unit())});
        }
      }
      observations.EndRow();
    }
    for (const int range : ranges) {
      centers.push_back(RandomPoints(1, range, &random).front().cast<double>() +
                        Eigen::Vector3d(0.3, 0.2, 0.1));
    }
  }

  Tetrahedralization tetrahedra;
  Observations observations;
  std::vector<Eigen::Vector3d> centers;
};

// Capacities up to a maximum.
inline FlowCapacities RandomGraphOf(const Tetrahedralization& tetrahedra,
                                    uint32_t max_capacity, Random* random) {
  FlowCapacities graph = ZeroCapacities(tetrahedra);
  for (auto& [arcs, source, sink] : graph) {
    for (uint32_t* capacity :
         {&arcs[0], &arcs[1], &arcs[2], &arcs[3], &source, &sink}) {
      *capacity = random->Below(max_capacity + 1);
    }
  }
  return graph;
}

// Of all nodes.
// \param terminal  source or sink
inline uint64_t SumOf(const FlowCapacities& graph,
                      uint32_t NodeCapacities::*terminal) {
  uint64_t sum = 0;
  for (const NodeCapacities& node : graph) {
    sum += node.*terminal;
  }
  return sum;
}

// Labels of cells, 1 for free: independent ones of several densities, smooth
// ones, and every other cell. Infinite cells alike.
inline std::vector<uint8_t> RandomLabels(const Tetrahedralization& tetrahedra,
                                         Random* random) {
  const size_t num_cells = tetrahedra.cells.size();
  std::vector<uint8_t> labels(num_cells);
  constexpr std::array<double, 6> kDensities = {0.02, 0.1, 0.3, 0.5, 0.8, 0.97};
  const uint32_t kind = random->Below(10);
  if (kind < kDensities.size()) {
    for (uint8_t& label : labels) {
      label = random->Chance(kDensities[kind]);
    }
  } else if (kind < 8) {
    // Cells of either side of a wave, by one of their vertices, and noise.
    const Eigen::Vector3f wave(static_cast<float>(random->Unit()),
                               static_cast<float>(random->Unit()),
                               static_cast<float>(random->Unit()));
    const double noise = kind == 6 ? 0 : 0.1;
    for (size_t i = 0; i < num_cells; ++i) {
      const uint32_t vertex = std::ranges::min(tetrahedra.cells[i].vertices);
      const float phase =
          4 * wave.dot(tetrahedra.points[vertex].stableNormalized());
      labels[i] = (std::sin(phase) > 0) ^ random->Chance(noise);
    }
  } else {
    for (size_t i = 0; i < num_cells; ++i) {
      labels[i] = (kind == 8 ? i : i / 3) % 2 == 0;
    }
  }
  return labels;
}

// Gives all infinite cells one label.
inline void LabelInfinite(const Tetrahedralization& tetrahedra, bool is_free,
                          std::vector<uint8_t>* labels) {
  for (uint32_t cell = 0; cell < tetrahedra.cells.size(); ++cell) {
    if (tetrahedra.IsInfinite(cell)) {
      (*labels)[cell] = is_free;
    }
  }
}

// Which defect the tetrahedralization's arrays have as a closed, oriented
// complex; empty where there is none. \param has_geometry whether orientation
// in space is looked at, too
inline std::string DefectOf(const Tetrahedralization& tetrahedra,
                            bool has_geometry) {
  std::set<std::array<uint32_t, 2>> edges;
  std::set<std::array<uint32_t, 4>> cells;
  std::vector<uint8_t> is_used(tetrahedra.points.size(), 0);
  bool has_infinite = false;
  for (uint32_t index = 0; index < tetrahedra.cells.size(); ++index) {
    const auto& cell = tetrahedra.cells[index];
    auto sorted = cell.vertices;
    std::sort(sorted.begin(), sorted.end());
    if (!cells.insert(sorted).second) return "a cell is there twice";
    for (int i = 0; i < 4; ++i) {
      for (int j = 0; j < i; ++j) {
        if (sorted[i] == sorted[j]) return "a cell repeats a vertex";
        edges.insert({sorted[j], sorted[i]});
      }
      has_infinite |= sorted[i] == kInfiniteVertex;
      if (sorted[i] != kInfiniteVertex) {
        if (sorted[i] >= is_used.size()) return "a vertex is out of range";
        is_used[sorted[i]] = 1;
      }
      const uint32_t neighbor = cell.neighbors[i];
      if (neighbor >= tetrahedra.cells.size()) return "a neighbor is missing";
      const auto& other = tetrahedra.cells[neighbor];
      const int back = tetrahedra.FacetTo(neighbor, index);
      if (other.neighbors[back] != index) return "neighbors are not mutual";
      if (FacetOf(cell, i) != FacetOf(other, back)) return "facets differ";
      if (IsOdd(cell, i) == IsOdd(other, back)) return "orientations differ";
    }
    if (has_geometry && !tetrahedra.IsInfinite(index)) {
      const auto [a, b, c, d] = IntegersOf(tetrahedra.points, cell.vertices);
      if (ExactOrientation(a, b, c, d) <= 0) {
        return "a cell is not positively oriented";
      }
    }
  }
  if (!has_infinite) return "there is no infinite cell";
  if (std::count(is_used.begin(), is_used.end(), 0) > 0) {
    return "a vertex has no cell";
  }
  // V - E + F - C of a 3-sphere, with F = 2 C.
  if (tetrahedra.points.size() + 1 + tetrahedra.cells.size() != edges.size()) {
    return "Euler's formula does not hold";
  }
  for (uint32_t vertex = 0; vertex < tetrahedra.points.size(); ++vertex) {
    const uint32_t cell = tetrahedra.vertex_cells[vertex];
    if (cell >= tetrahedra.cells.size() || tetrahedra.IsInfinite(cell) ||
        tetrahedra.cells[cell].vertices[tetrahedra.IndexOf(cell, vertex)] !=
            vertex) {
      return "a vertex's cell is wrong";
    }
  }
  return "";
}

}  // namespace colmap_ext
