// The labelling of a sphere of a million facets by the pairs of 50 cameras
// around it: time, peak memory, and how far the energy is above its lower
// bound.

#include <algorithm>
#include <cmath>
#include <vector>

#include <benchmark/benchmark.h>
#include <Eigen/Geometry>

#include "labeling/facet_labeling.h"
#include "tests/mesh/known_meshes.h"
#include "tests/peak_memory.h"

namespace colmap_ext {
namespace {

constexpr int kNumViews = 50;
constexpr int kNumPairs = 100;

// Points spread evenly over the unit sphere.
Eigen::Vector3d SpiralPoint(int i, int count) {
  const double z = 1 - (2 * i + 1.0) / count;
  const double angle = i * M_PI * (3 - std::sqrt(5.0));
  const double radius = std::sqrt(1 - z * z);
  return {radius * std::cos(angle), radius * std::sin(angle), z};
}

TriangleMesh Sphere(uint32_t rings) {
  const uint32_t sectors = 2 * rings;
  return Moved(MakeSheet(rings, sectors, false, true), [&](const auto& p) {
    const double polar = M_PI * (rings - p.y() + 0.5) / (rings + 1);
    const double angle = 2 * M_PI * p.x() / sectors;
    return Eigen::Vector3f(std::sin(polar) * std::cos(angle),
                           std::sin(polar) * std::sin(angle), std::cos(polar));
  });
}

struct LabeledSphere {
  LabeledSphere() : mesh(Sphere(500)) {  // a million facets
    for (int i = 0; i < kNumViews; ++i) {
      views.push_back(LookAtView(4 * SpiralPoint(i, kNumViews), {0, 0, 0},
                                 {0, 0, 1}, 0, 0, 1000));
    }
    FindPairs();
    // What looks less than 73 degrees away from a camera is seen by it.
    attributes.views.offsets = {0};
    for (const Eigen::Vector3f& vertex : mesh.vertices) {
      AddViews(vertex.cast<double>(), &attributes.views.values);
      attributes.views.EndRow();
    }
    for (const Facet& facet : mesh.facets) {
      AddViews(CentroidOf(mesh, facet).cast<double>().normalized(),
               &visibility.values);
      visibility.EndRow();
    }
  }

  // The closest ones.
  void FindPairs() {
    std::vector<std::pair<double, ViewPair>> all;
    for (uint32_t a = 0; a < kNumViews; ++a) {
      for (uint32_t b = a + 1; b < kNumViews; ++b) {
        all.push_back({(views[a].Center() - views[b].Center()).norm(), {a, b}});
      }
    }
    std::ranges::sort(all);
    all.resize(kNumPairs);
    for (const auto& [distance, pair] : all) {
      pairs.push_back(pair);
    }
    std::ranges::sort(pairs);
  }

  void AddViews(const Eigen::Vector3d& point, std::vector<uint32_t>* to) const {
    for (uint32_t i = 0; i < kNumViews; ++i) {
      if ((views[i].Center() - point).normalized().dot(point) > 0.3) {
        to->push_back(i);
      }
    }
  }

  TriangleMesh mesh;
  std::vector<View> views;
  std::vector<ViewPair> pairs;
  VertexAttributes attributes;
  FacetVisibility visibility;
};

void LabelSphere(benchmark::State& state) {
  const LabeledSphere sphere;
  FacetLabelingOptions options;
  options.final_pairs_per_facet = static_cast<int>(state.range(0));
  const size_t memory_before = PeakMemory();
  FacetLabeling labeling;
  for (auto _ : state) {
    labeling = LabelFacets(options, sphere.mesh, sphere.attributes,
                           sphere.pairs, sphere.visibility, sphere.views);
  }
  state.counters["memory_MB"] =
      static_cast<double>(PeakMemory() - memory_before) / (1 << 20);
  state.counters["gap_percent"] =
      100 * (labeling.final_energy / labeling.lower_bound - 1);
  state.counters["initial_over_final"] =
      labeling.initial_energy / labeling.final_energy;
  options.pair_selection = PairSelection::kClassical;
  state.counters["candidates"] =
      static_cast<double>(LabelFacets(options, sphere.mesh, sphere.attributes,
                                      sphere.pairs, sphere.visibility,
                                      sphere.views)
                              .labels.labels.values.size()) /
      static_cast<double>(sphere.mesh.facets.size());
}
BENCHMARK(LabelSphere)
    ->Arg(1)
    ->Arg(12)
    ->Unit(benchmark::kSecond)
    ->Iterations(1)
    ->MeasureProcessCPUTime()
    ->UseRealTime();

}  // namespace
}  // namespace colmap_ext
