#include "delaunay/visibility_weights.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <vector>

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include "delaunay/cell_graph.h"
#include "delaunay/locate.h"
#include "delaunay/ray_walk.h"
#include "tests/delaunay/random_complex.h"

namespace colmap_ext {
namespace visibility_weights_test {

// Two cells, one above the other, that share the triangle z = 0. The apexes are
// at z = 3 and z = -3.
class TwoCells : public testing::Test {
 protected:
  static constexpr float kAlpha = 0.75f;

  TwoCells()
      : graph_(ZeroCapacities(tetrahedra_)),
        expected_(ZeroCapacities(tetrahedra_)) {
    top_ = VertexAt({0, 0, 3});
    bottom_ = VertexAt({0, 0, -3});
    for (uint32_t cell = 0; cell < tetrahedra_.cells.size(); ++cell) {
      if (!tetrahedra_.IsInfinite(cell)) {
        const auto& v = tetrahedra_.cells[cell].vertices;
        (std::count(v.begin(), v.end(), top_) > 0 ? upper_ : lower_) = cell;
      }
    }
  }

  uint32_t VertexAt(const Eigen::Vector3f& position) const {
    const auto found = std::find(tetrahedra_.points.begin(),
                                 tetrahedra_.points.end(), position);
    return static_cast<uint32_t>(found - tetrahedra_.points.begin());
  }

  // The infinite cell beyond the hull's facet without this vertex, or kNone.
  uint32_t Beyond(uint32_t cell, uint32_t vertex) const {
    return tetrahedra_.cells[cell].neighbors[tetrahedra_.IndexOf(cell, vertex)];
  }

  // One observation of a vertex by a camera.
  RayReport Observe(uint32_t vertex, const Eigen::Vector3d& center,
                    double sigma, double behind_sigma, float alpha = kAlpha) {
    Observations observations;
    observations.offsets.resize(vertex + 1, 0);
    observations.offsets.resize(tetrahedra_.points.size() + 1, 1);
    observations.views = {0};
    observations.alphas = {alpha};
    return AddVisibilityWeights(tetrahedra_, observations, {center},
                                {sigma, behind_sigma}, &graph_);
  }

  // What a ray votes by the formulas, for each facet and cell by itself.
  void ExpectSource(uint32_t cell, double weight) {
    expected_.source[cell] += Units(weight);
  }
  void ExpectSink(uint32_t cell, double weight) {
    expected_.sink[cell] += Units(weight);
  }
  void ExpectArc(uint32_t from, uint32_t to, double weight) {
    expected_.capacities[from][tetrahedra_.FacetTo(from, to)] += Units(weight);
  }

  static uint32_t Units(double weight) {
    return static_cast<uint32_t>(std::lround(weight * kWeightUnit));
  }

  // The cell where the ray behind a vertex ends.
  uint32_t EndBehind(uint32_t vertex, const Eigen::Vector3d& center,
                     double distance) const {
    const Eigen::Vector3d position = tetrahedra_.points[vertex].cast<double>();
    std::vector<Crossing> crossings;
    return WalkRay(tetrahedra_, vertex,
                   position + distance * (position - center).normalized(),
                   kNone, 0, &crossings);
  }

  // What every labelling of the cells costs is all that a graph means.
  void ExpectSameCuts(double tolerance = 1) const {
    const NeighborView neighbors = NeighborsOf(tetrahedra_);
    for (uint32_t labels = 0; labels < 1U << graph_.size(); ++labels) {
      std::vector<uint8_t> is_free(graph_.size());
      for (size_t i = 0; i < is_free.size(); ++i) {
        is_free[i] = labels >> i & 1;
      }
      ASSERT_NEAR(static_cast<double>(CutValue(neighbors, graph_, is_free)),
                  static_cast<double>(CutValue(neighbors, expected_, is_free)),
                  tolerance)
          << labels;
    }
  }

  static double Soft(double distance, double sigma) {
    return kAlpha * (1 - std::exp(-distance * distance / (2 * sigma * sigma)));
  }

  const Tetrahedralization tetrahedra_ = DelaunayOf(
      {{2, 0, 0}, {-1, 1.75, 0}, {-1, -1.75, 0}, {0, 0, 3}, {0, 0, -3}});
  FlowCapacities graph_;
  FlowCapacities expected_;
  uint32_t top_ = 0;
  uint32_t bottom_ = 0;
  uint32_t upper_ = kNone;
  uint32_t lower_ = kNone;
};

TEST_F(TwoCells, AreTwo) {
  EXPECT_EQ(tetrahedra_.cells.size(), 8u);
  ASSERT_NE(upper_, kNone);
  ASSERT_NE(lower_, kNone);
  EXPECT_EQ(Beyond(upper_, top_), lower_);
}

TEST_F(TwoCells, CameraWithinACell) {
  // From the bottom through the triangle into the upper cell. Behind the bottom
  // there is nothing.
  const Eigen::Vector3d center(0, 0, 1);
  const RayReport report = Observe(bottom_, center, 2.0, 3.0);
  EXPECT_EQ(report.num_rays, 1u);
  EXPECT_EQ(report.num_lost_rays, 0u);
  EXPECT_EQ(report.num_steps, 1u);
  ExpectSource(upper_, kAlpha);
  ExpectArc(upper_, lower_, Soft(3, 2));
  ExpectSink(EndBehind(bottom_, center, 6), kAlpha);
  ExpectSameCuts();
}

TEST_F(TwoCells, CameraBeyondTheHull) {
  // From the bottom through the triangle and out of the upper cell, opposite to
  // the corner that x and y are furthest from.
  const Eigen::Vector3d direction(0.3, 0.03, 1);
  const Eigen::Vector3d center = Eigen::Vector3d(0, 0, -3) + 100 * direction;
  const RayReport report = Observe(bottom_, center, 2.0, 1e-3);
  EXPECT_EQ(report.num_steps, 2u);
  const uint32_t beyond = Beyond(upper_, VertexAt({-1, -1.75, 0}));
  ASSERT_TRUE(tetrahedra_.IsInfinite(beyond));
  ExpectSource(beyond, kAlpha);
  ExpectArc(upper_, lower_, Soft(3 * direction.norm(), 2));
  // The facet's plane goes through (2, 0, 0), (-1, 1.75, 0) and (0, 0, 3):
  // x / 2 + (12 / 14) y + z / 3 = 1.
  const double t = 2 / (0.3 / 2 + 0.03 * 12 / 14 + 1.0 / 3);
  ExpectArc(beyond, upper_, Soft(t * direction.norm(), 2));
  ExpectSink(EndBehind(bottom_, center, 2e-3), kAlpha);
  ExpectSameCuts();
}

TEST_F(TwoCells, TheSinkIsBehindThePointAtTheExtensionsEnd) {
  // The camera above the top: nothing before the point. Behind it the ray
  // crosses the triangle at a distance of 3 where it is long enough.
  struct Case {
    double sigma;
    double behind_sigma;
    bool reaches_lower;
  };
  const Eigen::Vector3d center(0, 0, 50);
  for (const Case& expected :
       {Case{1, 2.99, false}, Case{1, 3.01, true}, Case{2, 2, true},
        // Beyond where soft weights are one.
        Case{0.5, 5.9, false}, Case{0.5, 6.1, true}, Case{0.1, 31, true},
        Case{0.1, 29, false}}) {
    SCOPED_TRACE(testing::Message()
                 << expected.sigma << " " << expected.behind_sigma);
    graph_ = expected_ = ZeroCapacities(tetrahedra_);
    Observe(top_, center, expected.sigma, expected.behind_sigma);
    // The first cell before the top.
    std::vector<Crossing> crossings;
    ExpectSource(WalkRay(tetrahedra_, top_, center, kNone, 0, &crossings),
                 kAlpha);
    if (expected.reaches_lower) {
      ExpectArc(upper_, lower_, Soft(3, expected.sigma));
    }
    ExpectSink(expected.reaches_lower ? lower_ : upper_, kAlpha);
    ExpectSameCuts();
  }
}

TEST_F(TwoCells, TheSinkCanBeBeyondTheHull) {
  const Eigen::Vector3d center(0, 0, 50);
  Observe(top_, center, 3, 3);
  std::vector<Crossing> crossings;
  ExpectSource(WalkRay(tetrahedra_, top_, center, kNone, 0, &crossings),
               kAlpha);
  const uint32_t beyond = EndBehind(top_, center, 9);
  ASSERT_TRUE(tetrahedra_.IsInfinite(beyond));
  ExpectArc(upper_, lower_, Soft(3, 3));
  ExpectArc(lower_, beyond, Soft(6, 3));  // at the bottom
  ExpectSink(beyond, kAlpha);
  ExpectSameCuts();
}

TEST_F(TwoCells, CameraAtThePoint) {
  const RayReport report = Observe(top_, {0, 0, 3}, 1, 1);
  EXPECT_EQ(report.num_rays, 1u);
  const uint64_t sources =
      std::accumulate(graph_.source.begin(), graph_.source.end(), uint64_t{0});
  const uint64_t sinks =
      std::accumulate(graph_.sink.begin(), graph_.sink.end(), uint64_t{0});
  EXPECT_EQ(sources, sinks);
  EXPECT_EQ(sources > 0, report.num_lost_rays == 0);
}

TEST_F(TwoCells, SumsDoNotWrapAround) {
  for (size_t i = 0; i < graph_.size(); ++i) {
    graph_.source[i] = graph_.sink[i] = kMaxCapacity;
    graph_.capacities[i].fill(kMaxCapacity);
  }
  for (int i = 0; i < 3; ++i) {
    Observe(bottom_, {0, 0, 1}, 2.0, 3.0);
  }
  for (size_t i = 0; i < graph_.size(); ++i) {
    for (const uint32_t capacity :
         {graph_.source[i], graph_.sink[i], graph_.capacities[i][0],
          graph_.capacities[i][1], graph_.capacities[i][2],
          graph_.capacities[i][3]}) {
      EXPECT_GE(capacity, kMaxCapacity);
      EXPECT_LE(capacity, kMaxCapacity + 4096);
    }
  }
}

TEST_F(TwoCells, AVertexMayStandForMillionsOfPoints) {
  const Eigen::Vector3d center(0, 0, 1);
  for (const float alpha : {2e5f, 3e5f, 2e6f, 1e30f}) {
    graph_ = expected_ = ZeroCapacities(tetrahedra_);
    Observe(bottom_, center, 1.0, 1.0, alpha);
    const double most = std::min<double>(alpha, kMaxCapacity / kWeightUnit);
    const double soft = std::min<double>(Soft(3, 1) / kAlpha * alpha, most);
    ExpectSource(upper_, most);
    ExpectArc(upper_, lower_, soft);
    ExpectSink(EndBehind(bottom_, center, 1), most);
    ExpectSameCuts(2e-6 * kWeightUnit * most);
  }
}

// A ray's votes by the formulas, from the path that WalkRay() finds.
void AddByFormula(const Tetrahedralization& tetrahedra,
                  const Observations& observations, uint32_t vertex, uint64_t k,
                  const Eigen::Vector3d& center,
                  const VisibilityWeightOptions& options,
                  FlowCapacities* graph) {
  const float alpha = observations.alphas[k];
  const Eigen::Vector3d position = tetrahedra.points[vertex].cast<double>();
  const auto soft = [&](double distance) {
    const double ratio = distance / options.distance_sigma;
    return ToCapacity(alpha * (1 - std::exp(-ratio * ratio / 2)));
  };
  std::vector<Crossing> crossings;
  uint32_t cell = Locate(tetrahedra, center, 0);
  uint32_t end =
      WalkRay(tetrahedra, vertex, center,
              tetrahedra.IsInfinite(cell) ? kNone - 1 : cell, 1e9, &crossings);
  graph->source[end] += ToCapacity(alpha);
  for (const auto& [exit_arc, entry_arc, distance] : crossings) {
    graph->capacities[entry_arc / 4][entry_arc % 4] += soft(distance);
  }
  end = WalkRay(tetrahedra, vertex,
                position + options.behind_sigma * options.distance_sigma *
                               (position - center).normalized(),
                kNone, 1e9, &crossings);
  graph->sink[end] += ToCapacity(alpha);
  for (const auto& [exit_arc, entry_arc, distance] : crossings) {
    graph->capacities[exit_arc / 4][exit_arc % 4] += soft(distance);
  }
}

// Points, all of them vertices, and cameras around and within them.
struct Scenery {
  Scenery() {
    Random random(1);
    for (uint32_t vertex = 0; vertex < tetrahedra.points.size(); ++vertex) {
      for (uint32_t view = 0; view < 8; ++view) {
        if (random.Chance(0.5)) {
          observations.views.push_back(view);
          observations.alphas.push_back(3 * static_cast<float>(random.Unit()));
        }
      }
      observations.offsets.push_back(observations.size());
    }
    for (int view = 0; view < 8; ++view) {
      const int range = view < 4 ? 200 : 2000;
      centers.push_back(RandomPoints(1, range, &random).front().cast<double>());
    }
  }

  // Votes of every stride-th vertex.
  RayReport Vote(size_t first, size_t stride, FlowCapacities* graph) const {
    Observations part;
    for (size_t vertex = 0; vertex < tetrahedra.points.size(); ++vertex) {
      for (uint64_t k = observations.offsets[vertex];
           vertex % stride == first && k < observations.offsets[vertex + 1];
           ++k) {
        part.views.push_back(observations.views[k]);
        part.alphas.push_back(observations.alphas[k]);
      }
      part.offsets.push_back(part.size());
    }
    return AddVisibilityWeights(tetrahedra, part, centers, kOptions, graph);
  }

  static constexpr VisibilityWeightOptions kOptions = {20, 3};

  static Tetrahedralization MakeTetrahedra() {
    Random random(2);
    return DelaunayOf(RandomPoints(1500, 300, &random));
  }

  const Tetrahedralization tetrahedra = MakeTetrahedra();
  Observations observations;
  std::vector<Eigen::Vector3d> centers;
};

void ExpectSame(const FlowCapacities& a, const FlowCapacities& b) {
  EXPECT_EQ(a.capacities, b.capacities);
  EXPECT_EQ(a.source, b.source);
  EXPECT_EQ(a.sink, b.sink);
}

TEST(VisibilityWeights, DependNeitherOnThreadsNorOnTheOrder) {
  const Scenery scenery;
  std::vector<FlowCapacities> graphs(3, ZeroCapacities(scenery.tetrahedra));
  for (const int num_threads : {1, 2}) {
    const tbb::global_control control(
        tbb::global_control::max_allowed_parallelism,
        static_cast<size_t>(num_threads));
    const RayReport report =
        scenery.Vote(0, 1, &graphs[static_cast<size_t>(num_threads) - 1]);
    EXPECT_EQ(report.num_rays, scenery.observations.size());
    EXPECT_EQ(report.num_lost_rays, 0u);
    EXPECT_GT(report.num_steps, report.num_rays);
  }
  for (size_t first : {2, 0, 1}) {
    scenery.Vote(first, 3, &graphs[2]);
  }
  ExpectSame(graphs[0], graphs[1]);
  ExpectSame(graphs[0], graphs[2]);
}

TEST(ObserveVertices, AddsTheWeightsOfAVertexAndAView) {
  PointCloud cloud;
  cloud.positions.resize(4);
  cloud.views.offsets = {0, 2, 3, 3, 5};
  cloud.views.values = {1, 5, 5, 0, 5};
  const Observations observations =
      ObserveVertices(cloud, 3, {2, 2, 0, 1}, {0.5f, 0.25f, 1.0f, 0.75f});
  EXPECT_EQ(observations.offsets, (std::vector<uint64_t>{0, 0, 2, 4}));
  EXPECT_EQ(observations.views, (std::vector<uint32_t>{0, 5, 1, 5}));
  EXPECT_EQ(observations.alphas,
            (std::vector<float>{0.75f, 0.75f, 0.5f, 0.75f}));
}

// A cut costs what the formulas say, whatever the cells' labels are: all free
// but a few, all matter but a few, half and half, and on both sides of planes.
TEST(VisibilityWeights, CutsCostWhatTheFormulasSay) {
  const Scenery scenery;
  const Tetrahedralization& tetrahedra = scenery.tetrahedra;
  FlowCapacities graph = ZeroCapacities(tetrahedra);
  scenery.Vote(0, 1, &graph);
  FlowCapacities expected = ZeroCapacities(tetrahedra);
  for (uint32_t vertex = 0; vertex < tetrahedra.points.size(); ++vertex) {
    for (uint64_t k = scenery.observations.offsets[vertex];
         k < scenery.observations.offsets[vertex + 1]; ++k) {
      AddByFormula(tetrahedra, scenery.observations, vertex, k,
                   scenery.centers[scenery.observations.views[k]],
                   Scenery::kOptions, &expected);
    }
  }
  const NeighborView neighbors = NeighborsOf(tetrahedra);
  Random random(3);
  for (const double share : {0.0, 0.001, 0.1, 0.5, 0.9, 0.999, 1.0}) {
    std::vector<uint8_t> is_free(tetrahedra.cells.size());
    for (uint8_t& value : is_free) {
      value = random.Chance(share) ? 1 : 0;
    }
    const auto value =
        static_cast<double>(CutValue(neighbors, expected, is_free));
    // Weights beyond 5 sigma count as whole: one unit a facet at most.
    EXPECT_NEAR(static_cast<double>(CutValue(neighbors, graph, is_free)), value,
                1e-6 * value + 2);
  }
  EXPECT_EQ(ComputeMinCut(neighbors, graph).on_source_side,
            ComputeMinCut(neighbors, expected).on_source_side);
}

TEST(VisibilityWeights, EveryRayHasOneSourceAndOneSink) {
  const Scenery scenery;
  FlowCapacities graph = ZeroCapacities(scenery.tetrahedra);
  scenery.Vote(0, 1, &graph);
  uint64_t expected = 0;
  for (const float alpha : scenery.observations.alphas) {
    expected += static_cast<uint64_t>(std::lround(kWeightUnit * alpha));
  }
  EXPECT_EQ(
      std::accumulate(graph.source.begin(), graph.source.end(), uint64_t{0}),
      expected);
  EXPECT_EQ(std::accumulate(graph.sink.begin(), graph.sink.end(), uint64_t{0}),
            expected);
}

}  // namespace visibility_weights_test
}  // namespace colmap_ext
