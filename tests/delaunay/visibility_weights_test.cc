#include "delaunay/visibility_weights.h"

#include <algorithm>
#include <cmath>
#include <span>
#include <vector>

#include <gtest/gtest.h>

#include "tests/delaunay/random_complex.h"
#include "tests/threads.h"

namespace colmap_ext::visibility_weights_test {

// Two cells, one above the other, that share the triangle z = 0. The apexes are
// at z = 3 and z = -3.
struct TwoCells : testing::Test {
  static constexpr float kAlpha = 0.75f;

  TwoCells()
      : graph_(ZeroCapacities(tetrahedra_)),
        expected_(ZeroCapacities(tetrahedra_)) {
    top_ = VertexAt({0, 0, 3});
    bottom_ = VertexAt({0, 0, -3});
    for (uint32_t cell = 0; cell < tetrahedra_.cells.size(); ++cell) {
      if (!tetrahedra_.IsInfinite(cell)) {
        const auto& v = tetrahedra_.cells[cell].vertices;
        (std::ranges::count(v, top_) > 0 ? upper_ : lower_) = cell;
      }
    }
  }

  uint32_t VertexAt(const Eigen::Vector3f& position) const {
    const auto found = std::ranges::find(tetrahedra_.points, position);
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
    observations.values = {{0, alpha}};
    return AddVisibilityWeights(tetrahedra_, observations, {center},
                                {sigma, behind_sigma}, &graph_);
  }

  // What a ray votes by the formulas, for each facet and cell by itself.
  void ExpectSource(uint32_t cell, double weight) {
    expected_[cell].source += Units(weight);
  }
  void ExpectSink(uint32_t cell, double weight) {
    expected_[cell].sink += Units(weight);
  }
  void ExpectArc(uint32_t from, uint32_t to, double weight) {
    expected_[from].arcs[tetrahedra_.FacetTo(from, to)] += Units(weight);
  }

  static uint32_t Units(double weight) {
    return static_cast<uint32_t>(std::lround(weight * kWeightUnit));
  }

  // The cell where the ray behind a vertex ends.
  uint32_t EndBehind(uint32_t vertex, const Eigen::Vector3d& center,
                     double distance) const {
    const Eigen::Vector3d position = tetrahedra_.PositionOf(vertex);
    return EndOf(vertex,
                 position + distance * (position - center).normalized());
  }

  // The cell where the ray from a vertex to a target ends.
  uint32_t EndOf(uint32_t vertex, const Eigen::Vector3d& target) const {
    return PathOf(tetrahedra_, {vertex, target}).end;
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

TEST_F(TwoCells, AreTwoAndMayHaveACameraAtAPoint) {
  EXPECT_EQ(tetrahedra_.cells.size(), 8u);
  ASSERT_NE(upper_, kNone);
  ASSERT_NE(lower_, kNone);
  EXPECT_EQ(Beyond(upper_, top_), lower_);
  const RayReport report = Observe(top_, {0, 0, 3}, 1, 1);
  EXPECT_EQ(report.num_rays, 1u);
  const uint64_t sources = SumOf(graph_, &NodeCapacities::source);
  EXPECT_EQ(sources, SumOf(graph_, &NodeCapacities::sink));
  EXPECT_EQ(sources > 0, report.num_lost_rays == 0);
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

TEST_F(TwoCells, TheSinkIsBehindThePointAtTheExtensionsEnd) {
  // The camera above the top: nothing before the point. Behind it the ray
  // crosses the triangle at a distance of 3 where it is long enough.
  const Eigen::Vector3d center(0, 0, 50);
  for (const auto& [sigma, behind_sigma, reaches_lower] :
       {std::tuple(1.0, 2.99, false),
        {1.0, 3.01, true},
        {2.0, 2.0, true},
        // Beyond where soft weights are one.
        {0.5, 5.9, false},
        {0.5, 6.1, true},
        {0.1, 31.0, true},
        {0.1, 29.0, false}}) {
    SCOPED_TRACE(testing::Message() << sigma << " " << behind_sigma);
    graph_ = expected_ = ZeroCapacities(tetrahedra_);
    Observe(top_, center, sigma, behind_sigma);
    // The first cell before the top.
    ExpectSource(EndOf(top_, center), kAlpha);
    if (reaches_lower) {
      ExpectArc(upper_, lower_, Soft(3, sigma));
    }
    ExpectSink(reaches_lower ? lower_ : upper_, kAlpha);
    ExpectSameCuts();
  }
}

TEST_F(TwoCells, SumsDoNotWrapAround) {
  for (NodeCapacities& node : graph_) {
    node.source = node.sink = kMaxCapacity;
    node.arcs.fill(kMaxCapacity);
  }
  for (int i = 0; i < 3; ++i) {
    Observe(bottom_, {0, 0, 1}, 2.0, 3.0);
  }
  for (const auto& [arcs, source, sink] : graph_) {
    for (const uint32_t capacity :
         {source, sink, arcs[0], arcs[1], arcs[2], arcs[3]}) {
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

// A ray's votes by the formulas, from the path that WalkRays() finds.
void AddByFormula(const Tetrahedralization& tetrahedra, uint32_t vertex,
                  float alpha, const Eigen::Vector3d& center,
                  const VisibilityWeightOptions& options, bool is_free,
                  FlowCapacities* graph) {
  const Eigen::Vector3d position = tetrahedra.PositionOf(vertex);
  const auto soft = [&](double distance) {
    const double ratio = distance / options.distance_sigma;
    return ToCapacity(alpha * (1 - std::exp(-ratio * ratio / 2)));
  };
  const uint32_t cell = Locate(tetrahedra, center, 0);
  const RayPath front = PathOf(
      tetrahedra,
      {vertex, center, tetrahedra.IsInfinite(cell) ? kToHull : cell, 1e9});
  (*graph)[front.end].source += ToCapacity(alpha);
  for (const auto& [exit_arc, entry_arc, distance] : front.crossings) {
    (*graph)[entry_arc / 4].arcs[entry_arc % 4] += soft(distance);
  }
  if (is_free) {
    return;
  }
  const RayPath behind =
      PathOf(tetrahedra,
             {vertex, position + options.behind_sigma * options.distance_sigma *
                                     (position - center).normalized()});
  (*graph)[behind.end].sink += ToCapacity(alpha);
  for (const auto& [exit_arc, entry_arc, distance] : behind.crossings) {
    (*graph)[exit_arc / 4].arcs[exit_arc % 4] += soft(distance);
  }
}

// Cameras around and within the points.
struct Scenery : SeenComplex {
  Scenery() : SeenComplex(1500, {200, 200, 200, 200, 2000, 2000, 2000, 2000}) {}

  // Votes of every stride-th vertex.
  RayReport Vote(size_t first, size_t stride, FlowCapacities* graph) const {
    Observations part;
    for (size_t vertex = 0; vertex < tetrahedra.points.size(); ++vertex) {
      part.AddRow(vertex % stride == first ? observations[vertex]
                                           : std::span<const Observation>());
    }
    return AddVisibilityWeights(tetrahedra, part, centers, kOptions, graph);
  }

  static constexpr VisibilityWeightOptions kOptions = {20, 3};
};

TEST(VisibilityWeights, DependNeitherOnThreadsNorOnTheOrder) {
  const Scenery scenery;
  FlowCapacities expected = ZeroCapacities(scenery.tetrahedra);
  const RayReport report = scenery.Vote(0, 1, &expected);
  EXPECT_EQ(report.num_rays, scenery.observations.values.size());
  EXPECT_EQ(report.num_lost_rays, 0u);
  EXPECT_GT(report.num_steps, report.num_rays);
  ExpectSameForAnyThreads([&] {
    FlowCapacities graph = ZeroCapacities(scenery.tetrahedra);
    for (size_t first : {2, 0, 1}) {
      scenery.Vote(first, 3, &graph);
    }
    EXPECT_TRUE(graph == expected);
    return graph;
  });
}

TEST(ObserveVertices, AddsTheWeightsOfAVertexAndAView) {
  PointCloud cloud;
  cloud.positions.resize(4);
  cloud.views.offsets = {0, 2, 3, 3, 5};
  cloud.views.values = {1, 5, 5, 0, 5};
  const Observations observations =
      ObserveVertices(cloud, 3, {2, 2, 0, 1}, {0.5f, 0.25f, 1.0f, 0.75f});
  EXPECT_EQ(observations.offsets, (std::vector<uint64_t>{0, 0, 2, 4}));
  EXPECT_TRUE(observations.values ==
              (std::vector<Observation>{
                  {0, 0.75f}, {5, 0.75f}, {1, 0.5f}, {5, 0.75f}}));
}

// A cut costs what the formulas say, whatever the cells' labels are: all free
// but a few, all matter but a few, half and half, and on both sides of planes.
void ExpectCutsByFormula(bool are_free) {
  const Scenery scenery;
  const Tetrahedralization& tetrahedra = scenery.tetrahedra;
  FlowCapacities graph = ZeroCapacities(tetrahedra);
  Observations observations = scenery.observations;
  observations.are_free = are_free;
  AddVisibilityWeights(tetrahedra, observations, scenery.centers,
                       Scenery::kOptions, &graph);
  FlowCapacities expected = ZeroCapacities(tetrahedra);
  for (uint32_t vertex = 0; vertex < tetrahedra.points.size(); ++vertex) {
    for (const auto& [view, alpha] : observations[vertex]) {
      AddByFormula(tetrahedra, vertex, alpha, scenery.centers[view],
                   Scenery::kOptions, are_free, &expected);
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
  for (const auto terminal : {&NodeCapacities::source, &NodeCapacities::sink}) {
    EXPECT_EQ(SumOf(graph, terminal), SumOf(expected, terminal));
  }
}

TEST(VisibilityWeights, CutsCostWhatTheFormulasSay) {
  ExpectCutsByFormula(false);
}

TEST(VisibilityWeights, FreeRaysVoteInFrontOfTheirPointsAlone) {
  ExpectCutsByFormula(true);
}

}  // namespace colmap_ext::visibility_weights_test
