// The stages of meshing on a synthetic statue, by the number of its images'
// pixels: time a point shows whether they grow linearly.

#include <vector>

#include <benchmark/benchmark.h>

#include "base/percentile.h"
#include "delaunay/tetrahedralization.h"
#include "delaunay/thinning.h"
#include "delaunay/visibility_weights.h"
#include "meshing/manifold_meshing.h"
#include "optim/min_cut.h"
#include "tests/synthetic/dense_scene.h"

namespace colmap_ext {
namespace {

// A scene and what the stages make of it, each of the one before.
struct Stages {
  explicit Stages(int width) {
    synthetic::DenseSceneOptions options;
    options.scene.width = width;
    options.scene.height = width * 3 / 4;
    options.render_images = false;
    scene = synthetic::MakeDenseScene(options);
    const ThinnedPoints thinned =
        ThinPoints(scene.fused.cloud, scene.scene.views, {});
    positions = thinned.positions;
    tetrahedra = Tetrahedralize(positions);
    for (const View& view : scene.scene.views) {
      centers.push_back(view.Center());
    }
    observations = ObserveVertices(
        scene.fused.cloud, positions.size(), thinned.point_vertices,
        std::vector<float>(scene.fused.cloud.size(), 1.0f));
    std::vector<float> lengths = EdgeLengths(tetrahedra);
    sigma = Percentile(kSigmaPercentile, &lengths);
    graph = ZeroCapacities(tetrahedra);
    empty_graph = graph;
    AddQualityWeights(tetrahedra, 1, &graph);
    AddVisibilityWeights(tetrahedra, observations, centers, {sigma, 1}, &graph);
  }

  static const Stages& OfWidth(int64_t width) {
    static Stages stages(320);
    static int64_t made = 320;
    if (made != width) {
      stages = Stages(static_cast<int>(width));
      made = width;
    }
    return stages;
  }

  synthetic::DenseScene scene;
  std::vector<Eigen::Vector3f> positions;
  Tetrahedralization tetrahedra;
  std::vector<Eigen::Vector3d> centers;
  Observations observations;
  double sigma = 0;
  FlowCapacities empty_graph;
  FlowCapacities graph;
};

// Times a function of the stages at a width.
template <typename Function>
void Run(benchmark::State& state, const Function& function) {
  const Stages& stages = Stages::OfWidth(state.range(0));
  for (auto _ : state) {
    benchmark::DoNotOptimize(function(stages));
  }
  state.SetItemsProcessed(
      state.iterations() *
      static_cast<int64_t>(stages.scene.fused.cloud.size()));
}

void BM_ThinPoints(benchmark::State& state) {
  Run(state, [](const Stages& stages) {
    return ThinPoints(stages.scene.fused.cloud, stages.scene.scene.views, {});
  });
}

void BM_Tetrahedralize(benchmark::State& state) {
  Run(state,
      [](const Stages& stages) { return Tetrahedralize(stages.positions); });
}

void BM_WalkRays(benchmark::State& state) {
  Run(state, [](const Stages& stages) {
    FlowCapacities graph = stages.empty_graph;
    AddVisibilityWeights(stages.tetrahedra, stages.observations, stages.centers,
                         {stages.sigma, 1}, &graph);
    return graph;
  });
}

void BM_MinCut(benchmark::State& state) {
  Run(state, [](const Stages& stages) {
    return ComputeMinCut(NeighborsOf(stages.tetrahedra), stages.graph);
  });
}

void BM_MeshManifold(benchmark::State& state) {
  Run(state, [](const Stages& stages) {
    return MeshManifold({}, stages.scene.fused.cloud, stages.scene.scene.views);
  });
}

void Widths(benchmark::internal::Benchmark* benchmark) {
  benchmark->Arg(320)->Arg(640)->Arg(1280);
  benchmark->Unit(benchmark::kMillisecond)->UseRealTime();
}

BENCHMARK(BM_ThinPoints)->Apply(Widths);
BENCHMARK(BM_Tetrahedralize)->Apply(Widths);
BENCHMARK(BM_WalkRays)->Apply(Widths);
BENCHMARK(BM_MinCut)->Apply(Widths);
BENCHMARK(BM_MeshManifold)->Apply(Widths);

}  // namespace
}  // namespace colmap_ext
