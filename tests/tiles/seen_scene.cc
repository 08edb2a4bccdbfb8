#include "tests/tiles/seen_scene.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "delaunay/cell_graph.h"
#include "delaunay/growing_complex.h"
#include "delaunay/insert_points.h"
#include "delaunay/quality_weights.h"
#include "tests/random.h"

namespace colmap_ext {
namespace {

Eigen::Vector3d OnUnitSphere(Random* random) {
  for (;;) {
    const Eigen::Vector3d p(2 * random->Unit() - 1, 2 * random->Unit() - 1,
                            2 * random->Unit() - 1);
    if (p.norm() < 1 && p.norm() > 0.1) {
      return p.normalized();
    }
  }
}

template <typename IsSeen>
void AddPoint(const Eigen::Vector3d& point, const IsSeen& is_seen,
              SeenScene* scene) {
  scene->points.push_back(point.cast<float>());
  for (uint32_t view = 0; view < scene->centers.size(); ++view) {
    if (is_seen(scene->centers[view])) {
      scene->observations.views.push_back(view);
      scene->observations.alphas.push_back(
          0.25f + 0.125f * static_cast<float>(view % 5));
    }
  }
  scene->observations.offsets.push_back(scene->observations.size());
}

}  // namespace

SeenScene SphereScene(size_t num_points, uint64_t seed, double noise) {
  Random random(seed);
  SeenScene scene;
  for (int i = 0; i < 20; ++i) {
    scene.centers.push_back(4 * OnUnitSphere(&random));
  }
  for (size_t i = 0; i < num_points; ++i) {
    const Eigen::Vector3d normal = OnUnitSphere(&random);
    const Eigen::Vector3d point =
        normal * (1 + noise * (2 * random.Unit() - 1));
    AddPoint(
        point,
        [&](const Eigen::Vector3d& center) {
          return (center - point).dot(normal) > 1;
        },
        &scene);
  }
  for (int i = 0; i < 8; ++i) {
    const Eigen::Vector3d point = 20 * OnUnitSphere(&random);
    AddPoint(
        point,
        [&](const Eigen::Vector3d& center) {
          return center.cross((point - center).normalized()).norm() > 1.1;
        },
        &scene);
  }
  scene.options.rays = {0.02, 1};
  scene.options.seam_rings = -1;
  return scene;
}

SeenScene GroundScene(size_t num_points, uint64_t seed) {
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
    AddPoint(
        point,
        [&](const Eigen::Vector3d& center) {
          return (center - point).head<2>().norm() < 2.5;
        },
        &scene);
  }
  scene.options.rays = {0.05, 1};
  scene.options.seam_rings = -1;
  return scene;
}

SeenScene GroundSceneWithEnds(size_t num_points, uint64_t seed) {
  SeenScene scene = GroundScene(num_points, seed);
  scene.observations.is_end.assign(scene.points.size(), 0);
  Random random(seed + 1);
  for (uint32_t i = 0; i < num_points / 10; ++i) {
    const Eigen::Vector3d point(10 * random.Unit(), 10 * random.Unit(),
                                2 + 3 * random.Unit());
    scene.points.push_back(point.cast<float>());
    scene.observations.views.push_back(i % 25);
    scene.observations.alphas.push_back(0.5f);
    scene.observations.offsets.push_back(scene.observations.size());
    scene.observations.is_end.push_back(1);
  }
  return scene;
}

SeenScene LatticeScene(uint64_t seed, float unit) {
  constexpr int kLength = 300;
  constexpr int kWidth = 4;
  Random random(seed);
  const auto node = [&](int x, int y, int z) {
    return (unit * Eigen::Vector3f(x, y, z)).cast<double>().eval();
  };
  const auto any = [&] {
    return node(random.Integer(0, kLength), random.Integer(0, kWidth),
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
  scene.centers.push_back(node(-7, 1, 1));
  scene.centers.push_back(node(kLength / 2, 1, 40));
  for (int x = 0; x <= kLength; ++x) {
    for (int y = 0; y <= kWidth; ++y) {
      for (int z = 0; z <= kWidth; ++z) {
        if (random.Chance(0.4)) {
          continue;
        }
        const Eigen::Vector3d point = node(x, y, z);
        AddPoint(
            point,
            [&](const Eigen::Vector3d& center) {
              return center != point && random.Chance(0.5);
            },
            &scene);
      }
    }
  }
  scene.options.rays = {0.2 * unit, 5};
  scene.options.seam_rings = kAllAtOnce;
  return scene;
}

SeenScene BoxScene(float unit) {
  constexpr int kLength = 120;
  constexpr int kSize = 3;
  const auto node = [&](int x, int y, int z) {
    return (unit * Eigen::Vector3f(x, y, z)).cast<double>().eval();
  };
  SeenScene scene;
  for (int x = -10; x <= kLength + 10; x += 17) {
    for (const int y : {-8, 1, 12}) {
      // In the plane of the box's top, and above.
      scene.centers.push_back(node(x, y, y == 1 ? 10 : kSize));
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
        const Eigen::Vector3d point = node(x, y, z);
        AddPoint(
            point,
            [&](const Eigen::Vector3d& center) {
              const Eigen::Vector3d way = center - point;
              return way.norm() < 20 * unit && way.norm() > 0 &&
                     (!is_in_box || z == kSize || (x == 0 && way.x() <= 0) ||
                      (x == kLength && way.x() >= 0) ||
                      (y == 0 && way.y() <= 0) || (y == kSize && way.y() >= 0));
            },
            &scene);
      }
    }
  }
  scene.options.rays = {0.2 * unit, 5};
  scene.options.seam_rings = kAllAtOnce;
  return scene;
}

SeenScene ClustersScene(uint64_t seed) {
  Random random(seed);
  SeenScene scene;
  for (int i = 0; i < 12; ++i) {
    scene.centers.emplace_back(Eigen::Vector3d(40, 0, 0) +
                               3 * OnUnitSphere(&random));
  }
  for (int i = 0; i < 4500; ++i) {
    const Eigen::Vector3d offset =
        std::cbrt(random.Unit()) * OnUnitSphere(&random);
    const Eigen::Vector3d point =
        i < 1500 ? offset : Eigen::Vector3d(40, 0, 0) + offset;
    AddPoint(
        point, [&](const Eigen::Vector3d&) { return random.Chance(0.5); },
        &scene);
  }
  scene.options.rays = {0.05, 1};
  scene.options.seam_rings = kAllAtOnce;
  return scene;
}

WholeCut CutWhole(const SeenScene& scene, const MemoryPlan& plan) {
  WholeCut whole;
  const auto num_vertices = static_cast<uint32_t>(plan.positions().size());
  whole.ids.resize(num_vertices);
  std::iota(whole.ids.begin(), whole.ids.end(), 0);
  GrowingComplex complex;
  complex.points = plan.positions();
  InsertPoints(InsertionOrder(num_vertices), {}, &complex);
  whole.tetrahedra = TakeTetrahedra(whole.ids, &complex);
  const Observations& by_id = plan.observations();
  Observations observations;
  for (const uint32_t id : whole.ids) {
    for (uint64_t k = by_id.offsets[id]; k < by_id.offsets[id + 1]; ++k) {
      observations.views.push_back(by_id.views[k]);
      observations.alphas.push_back(by_id.alphas[k]);
    }
    observations.offsets.push_back(observations.size());
    observations.is_end.push_back(by_id.IsEnd(id));
  }
  whole.graph = ZeroCapacities(whole.tetrahedra);
  AddQualityWeights(whole.tetrahedra, scene.options.quality_regularization,
                    &whole.graph);
  VisibilityWeightOptions rays = scene.options.rays;
  rays.inner_place = plan.Blocks().Center();
  AddVisibilityWeights(whole.tetrahedra, observations, scene.centers, rays,
                       &whole.graph);
  whole.labels =
      ComputeMinCut(NeighborsOf(whole.tetrahedra), whole.graph).on_source_side;
  return whole;
}

CellKey KeyOf(const Tetrahedralization::Cell& cell,
              const std::vector<uint32_t>& ids) {
  CellKey key = cell.vertices;
  for (uint32_t& corner : key) {
    corner = corner == kInfiniteVertex ? corner : ids[corner];
  }
  std::ranges::sort(key);
  return key;
}

std::map<CellKey, uint32_t> CellsByKey(const WholeCut& whole) {
  std::map<CellKey, uint32_t> cells;
  for (uint32_t cell = 0; cell < whole.tetrahedra.cells.size(); ++cell) {
    cells[KeyOf(whole.tetrahedra.cells[cell], whole.ids)] = cell;
  }
  return cells;
}

}  // namespace colmap_ext
