#include "tests/tiles/seen_scene.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "delaunay/cell_graph.h"
#include "delaunay/insert_points.h"
#include "delaunay/insertion_order.h"
#include "delaunay/quality_weights.h"
#include "delaunay/take_tetrahedra.h"
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
