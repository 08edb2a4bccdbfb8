#include "delaunay/manifold_fixing.h"

#include <algorithm>
#include <numeric>
#include <tuple>

#include <gtest/gtest.h>

#include "delaunay/surface_extraction.h"
#include "delaunay/vertex_star.h"
#include "mesh/fan_split.h"
#include "mesh/topology.h"
#include "tests/delaunay/random_complex.h"
#include "tests/mesh/manifold_links.h"

namespace colmap_ext {
namespace {

struct Problem {
  Tetrahedralization tetrahedra;
  FlowGraph graph;
  std::vector<uint8_t> labels;

  std::vector<uint32_t> Singular() const {
    return SingularVertices(tetrahedra, labels);
  }
  int64_t Energy() const { return CutValue(graph, labels); }

  // How many components there are too many around all vertices.
  size_t Excess() const {
    size_t excess = 0;
    for (const uint32_t vertex : Singular()) {
      VertexStar star;
      MakeVertexStar(tetrahedra, labels, vertex, &star);
      excess += star.components.size() - 2;
    }
    return excess;
  }
};

Problem RandomProblem(const std::vector<Eigen::Vector3f>& points,
                      Random* random) {
  Problem problem;
  problem.tetrahedra = DelaunayOf(points);
  problem.graph = RandomGraphOf(problem.tetrahedra, 1000, random);
  problem.labels = RandomLabels(problem.tetrahedra, random);
  if (random->Chance(0.3)) {
    LabelInfinite(problem.tetrahedra, true, &problem.labels);
  }
  return problem;
}

void ExpectConsistent(const Problem& problem) {
  ASSERT_EQ(DefectOf(problem.tetrahedra, false), "");
  ASSERT_EQ(problem.graph.size(), problem.tetrahedra.cells.size());
  ASSERT_EQ(problem.labels.size(), problem.tetrahedra.cells.size());
  for (size_t i = 0; i < problem.graph.size(); ++i) {
    ASSERT_EQ(problem.graph.neighbors[i],
              problem.tetrahedra.cells[i].neighbors);
  }
}

uint64_t Sum(const std::vector<uint32_t>& capacities) {
  return std::accumulate(capacities.begin(), capacities.end(), uint64_t{0});
}

TEST(SplitCell, KeepsEverythingButTheCell) {
  Random random(1);
  for (int trial = 0; trial < 30; ++trial) {
    Problem problem = RandomProblem(RandomPoints(20, 1000, &random), &random);
    for (int split = 0; split < 30; ++split) {
      const Problem before = problem;
      const auto num_cells =
          static_cast<uint32_t>(before.tetrahedra.cells.size());
      const auto num_points =
          static_cast<uint32_t>(before.tetrahedra.points.size());
      const uint32_t cell = random.Below(num_cells);
      if (before.tetrahedra.IsInfinite(cell)) {
        continue;
      }
      SplitCell(cell, &problem.tetrahedra, &problem.graph, &problem.labels);
      ExpectConsistent(problem);
      ASSERT_FALSE(HasFailure());
      ASSERT_EQ(problem.tetrahedra.cells.size(), num_cells + 3);
      ASSERT_EQ(problem.tetrahedra.points.size(), num_points + 1);
      // The energy of the inherited labels, and the terminals' capacities.
      ASSERT_EQ(problem.Energy(), before.Energy());
      ASSERT_EQ(Sum(problem.graph.source), Sum(before.graph.source));
      ASSERT_EQ(Sum(problem.graph.sink), Sum(before.graph.sink));
      ASSERT_EQ(problem.Singular(), before.Singular());
      Eigen::Vector3f centroid = Eigen::Vector3f::Zero();
      for (const uint32_t vertex : before.tetrahedra.cells[cell].vertices) {
        centroid += 0.25f * before.tetrahedra.points[vertex];
      }
      EXPECT_LT((problem.tetrahedra.points.back() - centroid).norm(), 1e-2);
      for (const uint32_t child :
           {cell, num_cells, num_cells + 1, num_cells + 2}) {
        ASSERT_EQ(problem.labels[child], before.labels[cell]);
        const auto& vertices = problem.tetrahedra.cells[child].vertices;
        ASSERT_EQ(std::count(vertices.begin(), vertices.end(), num_points), 1);
      }
      // All other cells are as they were.
      for (uint32_t other = 0; other < num_cells; ++other) {
        if (other != cell) {
          ASSERT_EQ(problem.labels[other], before.labels[other]);
          ASSERT_EQ(problem.tetrahedra.cells[other].vertices,
                    before.tetrahedra.cells[other].vertices);
          ASSERT_EQ(problem.graph.capacities[other],
                    before.graph.capacities[other]);
        }
      }
    }
  }
}

class FixSingularVerticesTest : public testing::TestWithParam<FixingRule> {};

TEST_P(FixSingularVerticesTest, LeavesNothingThatTheSplitCannotRepair) {
  Random random(2);
  size_t num_raw = 0;
  size_t num_fixed = 0;
  size_t num_split_cells = 0;
  for (int trial = 0; trial < 400; ++trial) {
    Problem problem = RandomProblem(
        RandomPoints(5 + random.Below(40), 1000, &random), &random);
    const Problem before = problem;
    const FixingReport report = FixSingularVertices(
        GetParam(), &problem.tetrahedra, &problem.graph, &problem.labels);
    ExpectConsistent(problem);
    ASSERT_FALSE(HasFailure());
    ASSERT_EQ(report.num_singular_raw, before.Singular().size());
    ASSERT_EQ(report.num_singular_fixed, problem.Singular().size());
    ASSERT_EQ(problem.labels.size(),
              before.labels.size() + 3 * report.num_split_cells);
    ASSERT_EQ(problem.tetrahedra.points.size(),
              before.tetrahedra.points.size() + report.num_split_cells);
    if (report.num_singular_raw == 0) {
      ASSERT_EQ(problem.labels, before.labels);
    }
    if (GetParam() == FixingRule::kEnergy) {
      ASSERT_LE(problem.Excess(), before.Excess());
    }
    if (report.num_split_cells == 0) {
      size_t num_changed = 0;
      for (size_t i = 0; i < before.labels.size(); ++i) {
        num_changed += before.labels[i] != problem.labels[i];
      }
      ASSERT_LE(num_changed, report.num_relabeled_cells);
      ASSERT_EQ(num_changed % 2, report.num_relabeled_cells % 2);
    }
    const ExtractedSurface surface =
        ExtractSurface(problem.tetrahedra, problem.labels);
    const FanSplit split = SplitFans(surface.mesh, surface.partners);
    const MeshReport mesh = Analyze(split.mesh);
    ASSERT_TRUE(mesh.IsManifold()) << mesh.Defects();
    ASSERT_TRUE(HasManifoldLinks(split.mesh));
    num_raw += report.num_singular_raw;
    num_fixed += report.num_singular_fixed;
    num_split_cells += report.num_split_cells;
  }
  if (GetParam() == FixingRule::kPaper) {
    EXPECT_GT(num_split_cells, 0u);  // the energy rule hardly ever needs it
  }
  // Noise as labels is harder than any surface.
  EXPECT_LT(num_fixed, 0.6 * static_cast<double>(num_raw));
}

TEST_P(FixSingularVerticesTest, IsTheSameEveryTime) {
  Random random(3);
  for (int trial = 0; trial < 20; ++trial) {
    Problem problem = RandomProblem(RandomPoints(60, 1000, &random), &random);
    Problem copy = problem;
    FixSingularVertices(GetParam(), &problem.tetrahedra, &problem.graph,
                        &problem.labels);
    FixSingularVertices(GetParam(), &copy.tetrahedra, &copy.graph,
                        &copy.labels);
    ASSERT_EQ(copy.labels, problem.labels);
    ASSERT_EQ(copy.tetrahedra.points, problem.tetrahedra.points);
    ASSERT_EQ(copy.graph.neighbors, problem.graph.neighbors);
  }
}

INSTANTIATE_TEST_SUITE_P(
    Rules, FixSingularVerticesTest,
    testing::Values(FixingRule::kPaper, FixingRule::kEnergy),
    [](const auto& rule) {
      return std::string(rule.param == FixingRule::kPaper ? "Paper" : "Energy");
    });

// The components of one label around a vertex.
std::vector<VertexStar::Component> ComponentsOf(const Problem& problem,
                                                uint32_t vertex, bool is_free) {
  VertexStar star;
  MakeVertexStar(problem.tetrahedra, problem.labels, vertex, &star);
  std::erase_if(star.components, [&](const VertexStar::Component& component) {
    return component.is_free != is_free;
  });
  return star.components;
}

void Flip(const VertexStar::Component& component, Problem* problem) {
  for (const uint32_t cell : component.cells) {
    problem->labels[cell] = !component.is_free;
  }
}

// Flips all components of one label around a vertex but the how-manieth.
Problem KeepOne(const Problem& problem, uint32_t vertex, bool is_free,
                size_t kept) {
  Problem result = problem;
  const auto components = ComponentsOf(problem, vertex, is_free);
  for (size_t i = 0; i < components.size(); ++i) {
    if (i != kept) {
      Flip(components[i], &result);
    }
  }
  return result;
}

// The fewest components too many, and the least energy among the ways that
// leave as many: where one component around the vertex is flipped, and where of
// either label one is kept, one label after the other.
std::tuple<size_t, int64_t> BestWay(const Problem& problem, uint32_t vertex) {
  std::tuple<size_t, int64_t> best = {SIZE_MAX, 0};
  const auto try_out = [&](const Problem& way) {
    best = std::min(best, {way.Excess(), way.Energy()});
  };
  for (const bool label : {false, true}) {
    const auto components = ComponentsOf(problem, vertex, label);
    for (size_t first = 0; first < components.size(); ++first) {
      Problem way = problem;
      Flip(components[first], &way);
      try_out(way);
      const Problem once = KeepOne(problem, vertex, label, first);
      const size_t count = ComponentsOf(once, vertex, !label).size();
      for (size_t second = 0; second < count; ++second) {
        try_out(KeepOne(once, vertex, !label, second));
      }
    }
  }
  return best;
}

// Calls function(problem, vertex) for problems where just that vertex is
// singular.
template <typename Function>
void ForEachSingleVertex(uint64_t seed, const Function& function) {
  Random random(seed);
  for (int complex = 0; complex < 300; ++complex) {
    Problem problem = RandomProblem(
        RandomPoints(10 + random.Below(30), 1000, &random), &random);
    for (int trial = 0; trial < 60; ++trial) {
      problem.labels = RandomLabels(problem.tetrahedra, &random);
      const std::vector<uint32_t> singular = problem.Singular();
      if (singular.size() == 1) {
        function(problem, singular.front());
      }
    }
  }
}

TEST(EnergyRule, TakesTheCheapestOfTheBestWays) {
  size_t num_tried = 0;
  ForEachSingleVertex(4, [&](Problem problem, uint32_t vertex) {
    const auto best = BestWay(problem, vertex);
    const FixingReport report =
        FixSingularVertices(FixingRule::kEnergy, &problem.tetrahedra,
                            &problem.graph, &problem.labels);
    if (std::get<0>(best) > 0) {
      return;  // it has to split cells
    }
    ++num_tried;
    EXPECT_EQ(report.num_singular_fixed, 0u);
    EXPECT_EQ(report.num_split_cells, 0u);
    EXPECT_EQ(problem.Energy(), std::get<1>(best));
  });
  EXPECT_GT(num_tried, 50u);
}

// The paper's rule keeps the component with the most cells.
TEST(PaperRule, KeepsTheLargestComponents) {
  size_t num_tried = 0;
  ForEachSingleVertex(5, [&](Problem problem, uint32_t vertex) {
    Problem expected = problem;
    for (const bool is_free : {false, true}) {
      const auto components = ComponentsOf(expected, vertex, is_free);
      const auto largest =
          std::max_element(components.begin(), components.end(),
                           [](const auto& a, const auto& b) {
                             return a.cells.size() < b.cells.size();
                           });
      expected = KeepOne(expected, vertex, is_free,
                         static_cast<size_t>(largest - components.begin()));
    }
    const FixingReport report =
        FixSingularVertices(FixingRule::kPaper, &problem.tetrahedra,
                            &problem.graph, &problem.labels);
    if (expected.Singular().empty()) {
      ++num_tried;
      EXPECT_EQ(problem.labels, expected.labels);
      EXPECT_EQ(report.num_singular_fixed, 0u);
    }
  });
  EXPECT_GT(num_tried, 50u);
}

}  // namespace
}  // namespace colmap_ext
