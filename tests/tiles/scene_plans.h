#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include <Eigen/Core>

#include "delaunay/growing_complex.h"
#include "tests/random_vectors.h"
#include "tiles/merged_plan.h"
#include "tiles/plan_vertices.h"
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
inline SeenScene SphereScene(size_t num_points, uint64_t seed,
                             double noise = 0.02) {
  Random random(seed);
  SeenScene scene;
  for (int i = 0; i < 20; ++i) {
    scene.centers.push_back(4 * RandomNormal(&random));
  }
  for (size_t i = 0; i < num_points; ++i) {
    const Eigen::Vector3d normal = RandomNormal(&random);
    const Eigen::Vector3d point =
        normal * (1 + noise * (2 * random.Unit() - 1));
    scene.Add(point, [&](const Eigen::Vector3d& center) {
      return (center - point).dot(normal) > 1;
    });
  }
  for (int i = 0; i < 8; ++i) {
    const Eigen::Vector3d point = 20 * RandomNormal(&random);
    scene.Add(point, [&](const Eigen::Vector3d& center) {
      return center.cross((point - center).normalized()).norm() > 1.1;
    });
  }
  scene.options.rays = {0.02, 1};
  return scene;
}

// A wavy ground that cameras above it see.
inline SeenScene GroundScene(size_t num_points, uint64_t seed) {
  Random random(seed);
  SeenScene scene;
  for (int i = 0; i < 25; ++i) {
    scene.centers.emplace_back(2.0 * (i % 5) + 1, 2.0 * (i / 5) + 1, 4);
  }
  for (size_t i = 0; i < num_points; ++i) {
    const double x = 10 * random.Unit();
    const double y = 10 * random.Unit();
    const Eigen::Vector3d point(
        x, y, 0.5 * std::sin(2 * x) * std::cos(2 * y) + 0.02 * random.Unit());
    scene.Add(point, [&](const Eigen::Vector3d& center) {
      return (center - point).head<2>().norm() < 2.5;
    });
  }
  scene.options.rays = {0.05, 1};
  return scene;
}

// The same with rays that end in the air, one for every ten points.
inline SeenScene GroundSceneWithEnds(size_t num_points, uint64_t seed) {
  SeenScene scene = GroundScene(num_points, seed);
  scene.observations.is_end.assign(scene.points.size(), 0);
  Random random(seed + 1);
  for (uint32_t i = 0; i < num_points / 10; ++i) {
    const Eigen::Vector3d point(10 * random.Unit(), 10 * random.Unit(),
                                2 + 3 * random.Unit());
    scene.points.push_back(point.cast<float>());
    scene.observations.AddRow(std::vector<Observation>{{i % 25, 0.5f}});
    scene.observations.is_end.push_back(1);
  }
  return scene;
}

// A node of a lattice.
inline Eigen::Vector3d Node(float unit, int x, int y, int z) {
  return (unit * Eigen::Vector3f(x, y, z)).cast<double>();
}

// Nodes of a lattice, long enough along the x axis that tiles do not have each
// other's points; not all of them. Cameras are within and around them: at nodes
// and between two, in the planes and on the lines through others, and see
// half of the points. Rays end behind their points where other nodes are, and
// their weights stop falling there.
// \param unit  of the lattice
inline SeenScene LatticeScene(uint64_t seed, float unit = 1) {
  constexpr int kLength = 300;
  constexpr int kWidth = 4;
  Random random(seed);
  const auto any = [&] {
    return Node(unit, random.Integer(0, kLength), random.Integer(0, kWidth),
                random.Integer(0, kWidth));
  };
  SeenScene scene;
  for (int i = 0; i < 3; ++i) {
    const Eigen::Vector3d a = any();
    const Eigen::Vector3d b = any();
    scene.centers.insert(scene.centers.end(),
                         {a, 0.5 * (a + b), 3 * a - 2 * b, a + b - any()});
  }
  // On a line of nodes, and in a plane of them.
  scene.centers.push_back(Node(unit, -7, 1, 1));
  scene.centers.push_back(Node(unit, kLength / 2, 1, 40));
  for (int x = 0; x <= kLength; ++x) {
    for (int y = 0; y <= kWidth; ++y) {
      for (int z = 0; z <= kWidth; ++z) {
        if (random.Chance(0.4)) {
          continue;
        }
        const Eigen::Vector3d point = Node(unit, x, y, z);
        scene.Add(point, [&](const Eigen::Vector3d& center) {
          return center != point && random.Chance(0.5);
        });
      }
    }
  }
  scene.options.rays = {0.2 * unit, 5};
  return scene;
}

// A long box on the ground, of unit squares whose corners are points, seen from
// nodes of the lattice.
inline SeenScene BoxScene(float unit = 1) {
  constexpr int kLength = 120;
  constexpr int kSize = 3;
  SeenScene scene;
  for (int x = -10; x <= kLength + 10; x += 17) {
    for (const int y : {-8, 1, 12}) {
      // In the plane of the box's top, and above.
      scene.centers.push_back(Node(unit, x, y, y == 1 ? 10 : kSize));
    }
  }
  const auto is_within = [](int x, int size) { return x >= 0 && x <= size; };
  for (int x = -4; x <= kLength + 4; ++x) {
    for (int y = -3; y <= kSize + 3; ++y) {
      for (int z = 0; z <= kSize; ++z) {
        const bool is_in_box = is_within(x, kLength) && is_within(y, kSize);
        const bool is_on_box =
            is_in_box &&
            (z == kSize || x == 0 || x == kLength || y == 0 || y == kSize);
        if (!is_on_box && (is_in_box || z > 0)) {
          continue;
        }
        const Eigen::Vector3d point = Node(unit, x, y, z);
        scene.Add(point, [&](const Eigen::Vector3d& center) {
          const Eigen::Vector3d way = center - point;
          return way.norm() < 20 * unit && way.norm() > 0 &&
                 (!is_in_box || z == kSize || (x == 0 && way.x() <= 0) ||
                  (x == kLength && way.x() >= 0) || (y == 0 && way.y() <= 0) ||
                  (y == kSize && way.y() >= 0));
        });
      }
    }
  }
  scene.options.rays = {0.2 * unit, 5};
  return scene;
}

// A cluster of a third of the points, and one of the others far off, whose
// cameras are around it.
inline SeenScene ClustersScene(uint64_t seed) {
  Random random(seed);
  SeenScene scene;
  for (int i = 0; i < 12; ++i) {
    scene.centers.emplace_back(Eigen::Vector3d(40, 0, 0) +
                               3 * RandomNormal(&random));
  }
  for (int i = 0; i < 4500; ++i) {
    const Eigen::Vector3d offset =
        std::cbrt(random.Unit()) * RandomNormal(&random);
    const Eigen::Vector3d point =
        i < 1500 ? offset : Eigen::Vector3d(40, 0, 0) + offset;
    scene.Add(point,
              [&](const Eigen::Vector3d&) { return random.Chance(0.5); });
  }
  scene.options.rays = {0.05, 1};
  return scene;
}

inline void AppendRow(const Observations& from, size_t row, Observations* to) {
  to->AddRow(from[row]);
  to->is_end.push_back(from.IsEnd(row));
}

// A plan that is held whole.
class MemoryPlan : public PlanVertices {
 public:
  // Adds a tile, its vertices as they come.
  void Add(const std::vector<Eigen::Vector3f>& positions,
           const Observations& observations) {
    AddTile(positions, observations, &blocks_);
    positions_.insert(positions_.end(), positions.begin(), positions.end());
    for (size_t row = 0; row < observations.size(); ++row) {
      AppendRow(observations, row, &observations_);
    }
  }

  const PlanBlocks& Blocks() const override { return blocks_; }
  std::vector<Eigen::Vector3f> ReadPositions(uint32_t begin,
                                             uint32_t end) const override {
    return {positions_.begin() + begin, positions_.begin() + end};
  }
  Observations ReadObservations(uint32_t begin, uint32_t end) const override {
    Observations read;
    for (uint32_t row = begin; row < end; ++row) {
      AppendRow(observations_, row, &read);
    }
    return read;
  }

  const std::vector<Eigen::Vector3f>& positions() const { return positions_; }
  const Observations& observations() const { return observations_; }

 private:
  PlanBlocks blocks_;
  std::vector<Eigen::Vector3f> positions_;
  Observations observations_;
};

// Shares out points to tiles along the x axis, and puts each tile's along the
// curve. Of points at one position the first is there.
// \param observations  by points; none: nobody sees them
inline MemoryPlan PlanOf(const std::vector<Eigen::Vector3f>& points,
                         size_t num_tiles,
                         const Observations& observations = {}) {
  Observations of_points = observations;
  of_points.offsets.resize(points.size() + 1, of_points.values.size());
  std::vector<uint32_t> representatives;
  std::vector<uint32_t> sorted = DistinctPoints(points, &representatives);
  std::ranges::stable_sort(sorted, {},
                           [&](uint32_t point) { return points[point].x(); });
  MemoryPlan plan;
  for (size_t tile = 0; tile < num_tiles; ++tile) {
    const std::span<const uint32_t> share(
        sorted.data() + sorted.size() * tile / num_tiles,
        sorted.data() + sorted.size() * (tile + 1) / num_tiles);
    std::vector<Eigen::Vector3f> positions;
    for (const uint32_t point : share) {
      positions.push_back(points[point]);
    }
    std::vector<Eigen::Vector3f> along_curve;
    Observations of_tile;
    for (const uint32_t i : DistinctPoints(positions, &representatives)) {
      along_curve.push_back(positions[i]);
      AppendRow(of_points, share[i], &of_tile);
    }
    plan.Add(along_curve, of_tile);
  }
  return plan;
}
inline MemoryPlan PlanOf(const SeenScene& scene, size_t num_tiles) {
  return PlanOf(scene.points, num_tiles, scene.observations);
}

// The parts of all tiles of a plan, made at once.
class MemoryParts : public TileParts {
 public:
  MemoryParts(const SeenScene& scene, const MemoryPlan& plan) {
    for (uint32_t tile = 0; tile < plan.Blocks().NumTiles(); ++tile) {
      TileCut cut = CutTile(plan, tile, scene.centers, scene.options);
      seams_.push_back(SeamOf(cut));
      parts_.push_back({std::move(cut.tile), std::move(cut.labels.known)});
      parts_.back().tile.tetrahedra.points.assign(parts_.back().tile.ids.size(),
                                                  Eigen::Vector3f::Zero());
      graphs_.push_back(std::move(cut.graph));
    }
  }

  TileSeam ReadSeam(uint32_t tile) const override { return seams_[tile]; }
  TilePart ReadPart(uint32_t tile) const override { return parts_[tile]; }
  PartVertices ReadVertices(uint32_t tile) const override {
    return {parts_[tile].tile.ids, parts_[tile].tile.tetrahedra.vertex_cells};
  }
  uint32_t NumCells(uint32_t tile) const override {
    return static_cast<uint32_t>(parts_[tile].labels.size());
  }
  PartCells ReadCells(uint32_t tile, uint32_t begin,
                      uint32_t end) const override {
    const auto range = [&](const auto& values) {
      using Values = std::decay_t<decltype(values)>;
      return Values(values.begin() + begin, values.begin() + end);
    };
    return {range(parts_[tile].tile.tetrahedra.cells),
            range(parts_[tile].labels), range(graphs_[tile])};
  }

  void SetSeam(uint32_t tile, const TileSeam& seam) { seams_[tile] = seam; }

 private:
  std::vector<TileSeam> seams_;
  std::vector<TilePart> parts_;
  std::vector<FlowCapacities> graphs_;
};

// A plan whose tiles are done, cut along the seams and fixed.
struct MergedPlan {
  // \param rule  none: singular vertices are left
  MergedPlan(const SeenScene& scene, size_t num_tiles,
             std::optional<FixingRule> rule = {})
      : plan(PlanOf(scene, num_tiles)),
        parts(scene, plan),
        seam(plan, parts),
        changes(seam) {
    const int seam_rings = scene.options.seam_rings;
    num_contradictions = CutSeams(seam_rings, &seam);
    if (rule) {
      report = FixPlan(*rule, seam_rings == kAllAtOnce, &changes);
    }
  }
  MergedPlan(const MergedPlan&) = delete;

  MemoryPlan plan;
  MemoryParts parts;
  SeamLabels seam;
  CellChanges changes;
  size_t num_contradictions = 0;
  FixingReport report;
};

// All vertices of a plan on one machine, in the plan's order.
struct WholeCut {
  WholeCut(const SeenScene& scene, const MemoryPlan& plan) {
    std::vector<uint32_t> numbers = Iota(plan.positions().size());
    GrowingComplex complex;
    complex.points = plan.positions();
    InsertPoints(InsertionOrder(numbers.size()), {}, &complex);
    tetrahedra = TakeTetrahedra(numbers, &complex);
    graph = ZeroCapacities(tetrahedra);
    AddQualityWeights(tetrahedra, scene.options.quality_regularization, &graph);
    VisibilityWeightOptions rays = scene.options.rays;
    rays.inner_place = plan.Blocks().Center();
    AddVisibilityWeights(tetrahedra, plan.observations(), scene.centers, rays,
                         &graph);
    labels = ComputeMinCut(NeighborsOf(tetrahedra), graph).on_source_side;
  }

  // The cells by their sorted corners.
  std::map<CellKey, uint32_t> CellsByKey() const {
    std::map<CellKey, uint32_t> cells;
    for (uint32_t cell = 0; cell < tetrahedra.cells.size(); ++cell) {
      cells[Sorted(tetrahedra.cells[cell].vertices)] = cell;
    }
    return cells;
  }

  Tetrahedralization tetrahedra;
  FlowCapacities graph;
  std::vector<uint8_t> labels;
};

}  // namespace colmap_ext
