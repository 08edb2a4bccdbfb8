// One evaluation of the photometric energy by the processor and by OpenGL, on
// two threads, by the width of a synthetic statue's images: with the mesh drawn
// before, and with drawing it.

#include <cstdint>
#include <exception>
#include <memory>

#include <benchmark/benchmark.h>
#include <tbb/global_control.h>

#include "gl/gl_photometric_energy.h"
#include "photometry/cpu_photometric_energy.h"
#include "tests/gl/energy_scene.h"

namespace colmap_ext {
namespace {

struct Problem {
  explicit Problem(int width)
      : scene("statue", 12, width),
        mesh(scene.Perturbed(0.3, 1)),
        labels(scene.Labels(2)) {}

  static const Problem& OfWidth(int64_t width) {
    static std::unique_ptr<Problem> problem;
    static int64_t made = 0;
    if (made != width) {
      problem = std::make_unique<Problem>(static_cast<int>(width));
      made = width;
    }
    return *problem;
  }

  EnergyScene scene;
  TriangleMesh mesh;
  FacetLabels labels;
};

std::unique_ptr<PhotometricEnergy> MakeEnergy(const Problem& problem,
                                              bool is_gl) {
  const std::shared_ptr<ImagePyramid> images = problem.scene.Pyramid();
  return is_gl ? MakeGlPhotometricEnergy({}, images, -1, SIZE_MAX)
               : MakeCpuPhotometricEnergy({}, images, SIZE_MAX);
}

void Run(benchmark::State& state, bool is_gl, bool draws) {
  const tbb::global_control threads(
      tbb::global_control::max_allowed_parallelism, 2);
  const Problem& problem = Problem::OfWidth(state.range(0));
  std::unique_ptr<PhotometricEnergy> energy;
  try {
    energy = MakeEnergy(problem, is_gl);
  } catch (const std::exception& error) {
    state.SkipWithError(error.what());
    return;
  }
  energy->Render(problem.mesh);
  double num_pixels = 0;  // With the first evaluation's preparations left out.
  for (const float count :
       energy->Evaluate(problem.mesh, problem.labels).num_pixels) {
    num_pixels += count;
  }
  for (auto _ : state) {
    if (draws) {
      energy->Render(problem.mesh);
    }
    benchmark::DoNotOptimize(energy->Evaluate(problem.mesh, problem.labels));
  }
  state.SetLabel(energy->Description());
  state.SetItemsProcessed(static_cast<int64_t>(
      num_pixels * static_cast<double>(state.iterations())));
}

void BM_EvaluateCpu(benchmark::State& state) { Run(state, false, false); }
void BM_EvaluateGl(benchmark::State& state) { Run(state, true, false); }
void BM_RenderAndEvaluateCpu(benchmark::State& state) {
  Run(state, false, true);
}
void BM_RenderAndEvaluateGl(benchmark::State& state) { Run(state, true, true); }

void Widths(benchmark::internal::Benchmark* benchmark) {
  benchmark->Arg(320)->Arg(640)->Arg(1280);
  benchmark->Unit(benchmark::kMillisecond)
      ->UseRealTime()
      ->MeasureProcessCPUTime();
}

BENCHMARK(BM_EvaluateCpu)->Apply(Widths);
BENCHMARK(BM_EvaluateGl)->Apply(Widths);
BENCHMARK(BM_RenderAndEvaluateCpu)->Apply(Widths);
BENCHMARK(BM_RenderAndEvaluateGl)->Apply(Widths);

}  // namespace
}  // namespace colmap_ext
