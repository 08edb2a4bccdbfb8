// One evaluation of the photometric energy by the processor, on two threads, or
// by OpenGL (`--backend cpu`, `gl`; both if none is said), by the width of a
// synthetic statue's images: with the mesh drawn before, and with drawing it.
// Every row says what computed it.

#include <algorithm>
#include <cstdint>
#include <exception>
#include <iostream>
#include <memory>
#include <string>

#include <benchmark/benchmark.h>
#include <tbb/global_control.h>

#include "gl/gl_photometric_energy.h"
#include "photometry/photometric_energy.h"
#include "tests/refine/refinement_scene.h"

namespace colmap_ext {
namespace {

struct Problem {
  explicit Problem(int width)
      : scene(MakeRefinementScene("statue", 12, width)),
        mesh(scene.Perturbed(0.3)),
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

  RefinementScene scene;
  TriangleMesh mesh;
  FacetLabels labels;
};

std::unique_ptr<PhotometricEnergy> MakeEnergy(const Problem& problem,
                                              bool is_gl) {
  const std::shared_ptr<ImagePyramid> images = problem.scene.Pyramid();
  return is_gl ? MakeGlPhotometricEnergy({}, images, {})
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
  for (const FacetTerms& terms :
       energy->Evaluate(problem.mesh, problem.labels).facets) {
    num_pixels += terms.num_pixels;
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

void Register(const std::string& backend) {
  const bool is_gl = backend == "gl";
  for (const bool draws : {false, true}) {
    const std::string name =
        std::string(draws ? "RenderAndEvaluate" : "Evaluate") + "/" + backend;
    benchmark::RegisterBenchmark(name.c_str(), Run, is_gl, draws)
        ->Arg(320)
        ->Arg(640)
        ->Arg(1280)
        ->Arg(2560)
        ->Unit(benchmark::kMillisecond)
        ->UseRealTime()
        ->MeasureProcessCPUTime();
  }
}

// Takes `--backend NAME` out of the arguments.
std::string TakeBackend(int* argc, char** argv) {
  std::string backend = "all";
  for (int i = 1; i + 1 < *argc; ++i) {
    if (std::string(argv[i]) == "--backend") {
      backend = argv[i + 1];
      std::copy(argv + i + 2, argv + *argc, argv + i);
      *argc -= 2;
    }
  }
  return backend;
}

}  // namespace
}  // namespace colmap_ext

int main(int argc, char** argv) {
  const std::string backend = colmap_ext::TakeBackend(&argc, argv);
  if (backend != "cpu" && backend != "gl" && backend != "all") {
    std::cerr << "--backend has to be cpu, gl or all, not " << backend << "\n";
    return 1;
  }
  for (const char* each : {"cpu", "gl"}) {
    if (backend == each || backend == "all") {
      colmap_ext::Register(each);
    }
  }
  benchmark::Initialize(&argc, argv);
  if (benchmark::ReportUnrecognizedArguments(argc, argv)) {
    return 1;
  }
  benchmark::RunSpecifiedBenchmarks();
  return 0;
}
