#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include <gtest/gtest.h>

#include "base/indices.h"
#include "labeling/facet_labeling.h"
#include "labeling/view_pairs.h"
#include "mesh/mesh_in_image.h"
#include "tests/refine/refinement_scene.h"
#include "tests/threads.h"

namespace colmap_ext::facet_labeling_test {

struct LabelFacetsTest : testing::Test {
  // Every vertex is seen by the views that see one of its facets.
  LabelFacetsTest()
      : mesh_(Scene().Truth()),
        visibility_(VisibleFacets(mesh_, Scene().Views())) {
    std::vector<std::vector<uint32_t>> views(mesh_.vertices.size());
    for (size_t i = 0; i < mesh_.facets.size(); ++i) {
      for (const uint32_t vertex : mesh_.facets[i]) {
        const auto seen = visibility_[i];
        views[vertex].insert(views[vertex].end(), seen.begin(), seen.end());
      }
    }
    for (std::vector<uint32_t>& row : views) {
      SortUnique(&row);
      attributes_.views.AddRow(row);
    }
  }

  static const RefinementScene& Scene() {
    static const RefinementScene scene = MakeRefinementScene();
    return scene;
  }

  FacetLabeling Label(const FacetLabelingOptions& options) const {
    return LabelFacets(options, mesh_, attributes_, pairs_, visibility_,
                       Scene().Views());
  }

  bool IsSeen(size_t facet, uint32_t view) const {
    return std::ranges::binary_search(visibility_[facet], view);
  }

  size_t NumPairsThatSee(size_t facet) const {
    const size_t count = visibility_[facet].size();
    return count * (count - 1) / 2;
  }

  // Neighbors' labels that differ, over all edges.
  size_t NumChanges(const FacetLabels& labels) const {
    size_t changes = 0;
    std::vector<std::vector<uint32_t>> at(mesh_.vertices.size());
    for (uint32_t i = 0; i < mesh_.facets.size(); ++i) {
      for (const uint32_t vertex : mesh_.facets[i]) {
        for (const uint32_t other : at[vertex]) {
          if (!labels.labels[i].empty() && !labels.labels[other].empty()) {
            changes += labels.labels[i][0] != labels.labels[other][0] ? 1 : 0;
          }
        }
        at[vertex].push_back(i);
      }
    }
    return changes;
  }

  TriangleMesh mesh_;
  FacetVisibility visibility_;
  VertexAttributes attributes_;
  const std::vector<ViewPair> pairs_ = AllPairs(Scene().Views().size());
};

TEST_F(LabelFacetsTest, GivesOnlyPairsThatSeeTheFacet) {
  const FacetLabeling labeling =
      Label({.pairs_per_facet = 3, .final_pairs_per_facet = 0});
  ASSERT_EQ(labeling.labels.NumFacets(), mesh_.facets.size());
  size_t num_unlabeled = 0;
  for (size_t i = 0; i < mesh_.facets.size(); ++i) {
    const auto labels = labeling.labels.labels[i];
    EXPECT_EQ(labels.size(), std::min<size_t>(3, NumPairsThatSee(i)));
    num_unlabeled += labels.empty() ? 1 : 0;
    for (const uint32_t label : labels) {
      EXPECT_TRUE(IsSeen(i, pairs_[label].first));
      EXPECT_TRUE(IsSeen(i, pairs_[label].second));
      EXPECT_EQ(std::ranges::count(labels, label), 1);
    }
  }
  EXPECT_EQ(labeling.num_unlabeled_facets, num_unlabeled);
  EXPECT_LT(num_unlabeled, mesh_.facets.size() / 2);
}

TEST_F(LabelFacetsTest, AddsFinalPairsToTheFirst) {
  const auto label = [&](int num_final) {
    return Label({.pairs_per_facet = 2, .final_pairs_per_facet = num_final})
        .labels;
  };
  const FacetLabels few = label(0);
  const FacetLabels many = label(5);
  EXPECT_EQ(many.Truncated(2).labels, few.labels);
  EXPECT_EQ(many.Truncated(5).labels, many.labels);
  const FacetLabels all = label(1000);
  for (size_t i = 0; i < mesh_.facets.size(); ++i) {
    EXPECT_EQ(many.labels[i].size(), std::min<size_t>(5, NumPairsThatSee(i)));
    EXPECT_EQ(all.labels[i].size(), NumPairsThatSee(i));
  }
}

TEST_F(LabelFacetsTest, LowersTheEnergyAndEvensTheLabelsOut) {
  const FacetLabeling smooth = Label({.final_pairs_per_facet = 0});
  const FacetLabeling free =
      Label({.final_pairs_per_facet = 0, .potts_weight = 0});
  EXPECT_LT(smooth.final_energy, smooth.initial_energy);
  EXPECT_LE(smooth.lower_bound, smooth.final_energy);
  EXPECT_LT(smooth.final_energy, 1.04 * smooth.lower_bound);
  EXPECT_NEAR(free.final_energy, free.initial_energy,
              1e-6 * free.initial_energy);
  EXPECT_LT(NumChanges(smooth.labels), NumChanges(free.labels) / 2);
}

TEST_F(LabelFacetsTest, DoesNotDependOnTheNumberOfThreads) {
  ExpectSameForAnyThreads([&] { return Label({}).labels.labels; });
}

TEST_F(LabelFacetsTest, GivesAllPairsThatSeeTheFacetInTheClassicalWay) {
  const FacetLabeling labeling =
      Label({.pair_selection = PairSelection::kClassical});
  for (size_t i = 0; i < mesh_.facets.size(); ++i) {
    EXPECT_EQ(labeling.labels.labels[i].size(), NumPairsThatSee(i));
  }
}

TEST_F(LabelFacetsTest, TakesWhatIsDrawnWhereNothingElseIsKnown) {
  attributes_.views = Rows<uint32_t>(mesh_.vertices.size());
  const FacetLabeling labeling = Label({.final_pairs_per_facet = 0});
  for (size_t i = 0; i < mesh_.facets.size(); ++i) {
    EXPECT_EQ(labeling.labels.labels[i].size(),
              std::min<size_t>(1, NumPairsThatSee(i)));
  }
}

TEST_F(LabelFacetsTest, PrefersViewsThatTheVerticesAreKnownToBeSeenBy) {
  // Nothing but views 0 and 1 is known anywhere.
  attributes_.views = {};
  for (size_t i = 0; i < mesh_.vertices.size(); ++i) {
    attributes_.views.AddRow(std::vector<uint32_t>{0, 1});
  }
  const FacetLabeling labeling =
      Label({.pairs_per_facet = 4, .final_pairs_per_facet = 0});
  size_t num_known = 0;
  for (size_t i = 0; i < mesh_.facets.size(); ++i) {
    if (IsSeen(i, 0) && IsSeen(i, 1)) {
      ++num_known;
      ASSERT_EQ(labeling.labels.labels[i].size(), 1);
      EXPECT_EQ(pairs_[labeling.labels.labels[i][0]], (ViewPair{0, 1}));
    }
  }
  EXPECT_GT(num_known, mesh_.facets.size() / 20);
}

// With corners of walls behind the cameras and at their planes.
TEST(LabelFacets, GivesPairsToWallsThatReachBehindTheCameras) {
  const TriangleMesh room = MakeRoom();
  std::vector<View> views = RoomViews();
  views.push_back(LookAt({-4, 0.2, 0.1}, {4, 0.2, 0.1}, 64, 48, 40));
  views.push_back(LookAt({-4, -0.3, 0.4}, {4, -0.3, 0.4}, 64, 48, 40));
  VertexAttributes attributes;
  attributes.views = Rows<uint32_t>(room.vertices.size());
  const FacetVisibility visibility = VisibleFacets(room, views);
  const FacetLabeling labeling = LabelFacets(
      {}, room, attributes, AllPairs(views.size()), visibility, views);
  EXPECT_TRUE(std::isfinite(labeling.initial_energy));
  EXPECT_TRUE(std::isfinite(labeling.final_energy));
  int num_labeled = 0;
  for (size_t i = 0; i < room.facets.size(); ++i) {
    EXPECT_EQ(labeling.labels.labels[i].empty(), visibility[i].size() < 2);
    num_labeled += labeling.labels.labels[i].empty() ? 0 : 1;
  }
  EXPECT_GT(num_labeled, 4);
}

TEST(InSmallerView, ComparesEachLabelWhereTheFacetIsSmaller) {
  const RefinementScene scene = MakeRefinementScene();
  const TriangleMesh mesh = scene.Truth();
  FacetLabels labels{{{0, 1}, {0, 4}, {2, 3}}, {}, {}};
  for (size_t facet = 0; facet < mesh.facets.size(); ++facet) {
    for (uint32_t k = 0; k < facet % 4; ++k) {
      labels.labels.values.push_back(k);
    }
    labels.labels.EndRow();
  }
  const FacetLabels compared = InSmallerView(labels, mesh, scene.Views());
  EXPECT_EQ(compared.pairs, labels.pairs);
  EXPECT_EQ(compared.labels, labels.labels);
  size_t num_first = 0;
  size_t num_directions = 0;
  for (size_t facet = 0; facet < mesh.facets.size(); ++facet) {
    compared.ForEachDirection(facet, [&](uint32_t direction) {
      const auto [first, second] = labels.pairs[direction / 2];
      const bool is_first = direction % 2 == 0;
      const auto area_in = [&](uint32_t view) {
        return AreaInImage(mesh, mesh.facets[facet], scene.Views()[view]);
      };
      EXPECT_LE(area_in(is_first ? first : second),
                area_in(is_first ? second : first))
          << facet;
      num_first += is_first ? 1 : 0;
      ++num_directions;
    });
  }
  EXPECT_EQ(num_directions, labels.labels.values.size());  // one each
  EXPECT_GT(num_first, 0);
  EXPECT_LT(num_first, num_directions);
}

PointCloud CloudSeenBy(const std::vector<std::vector<uint32_t>>& views) {
  PointCloud cloud;
  for (const std::vector<uint32_t>& row : views) {
    cloud.positions.emplace_back(0, 0, 0);
    cloud.views.AddRow(row);
  }
  return cloud;
}

TEST(SelectViewPairs, TakesThePartnersWithTheMostPointsOrTheLowerOnes) {
  const PointCloud cloud =
      CloudSeenBy({{0, 1}, {0, 1}, {0, 2}, {1, 2}, {2, 3}, {0, 1, 2}});
  EXPECT_EQ(SelectViewPairs(cloud, 4, 1),
            (std::vector<ViewPair>{{0, 1}, {0, 2}, {2, 3}}));
  EXPECT_EQ(SelectViewPairs(cloud, 4, 3),
            (std::vector<ViewPair>{{0, 1}, {0, 2}, {1, 2}, {2, 3}}));
  EXPECT_EQ(SelectViewPairs(CloudSeenBy({{0, 1, 2, 3}}), 4, 1),
            (std::vector<ViewPair>{{0, 1}, {0, 2}, {0, 3}}));
  EXPECT_TRUE(SelectViewPairs(CloudSeenBy({{0}, {1}, {}}), 3, 2).empty());
  EXPECT_TRUE(SelectViewPairs({}, 0, 2).empty());
}

TEST(SelectViewPairs, AgreesWithCountingAllPairs) {
  constexpr uint32_t kNumViews = 12;
  std::mt19937 random(5);
  std::vector<std::vector<uint32_t>> rows(400);
  std::vector<std::vector<int>> counts(kNumViews,
                                       std::vector<int>(kNumViews, 0));
  for (std::vector<uint32_t>& row : rows) {
    for (uint32_t view = 0; view < kNumViews; ++view) {
      if (random() % 4 == 0) {
        row.push_back(view);
      }
    }
    for (const uint32_t a : row) {
      for (const uint32_t b : row) {
        counts[a][b] += a == b ? 0 : 1;
      }
    }
  }
  const std::vector<ViewPair> pairs =
      SelectViewPairs(CloudSeenBy(rows), kNumViews, 3);
  // Whoever is among the three best of one of the two, and nobody else.
  for (const ViewPair& pair : AllPairs(kNumViews)) {
    const auto is_partner = [&](uint32_t view, uint32_t other) {
      int num_better = 0;
      for (uint32_t k = 0; k < kNumViews; ++k) {
        num_better += k != view && std::pair(counts[view][k], other) >
                                       std::pair(counts[view][other], k);
      }
      return num_better < 3;
    };
    EXPECT_EQ(std::ranges::binary_search(pairs, pair),
              is_partner(pair.first, pair.second) ||
                  is_partner(pair.second, pair.first));
  }
}

}  // namespace colmap_ext::facet_labeling_test
