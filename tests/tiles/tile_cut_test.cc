#include "tiles/tile_cut.h"

#include <algorithm>

#include <gtest/gtest.h>

#include "tests/tiles/memory_plan.h"
#include "tests/tiles/seen_scene.h"
#include "tiles/tile_labels.h"

namespace colmap_ext {
namespace tile_cut_test {

// What the vertex opposite to a facet is called.
uint32_t IdOf(const std::vector<uint32_t>& ids, uint32_t vertex) {
  return vertex == kInfiniteVertex ? vertex : ids[vertex];
}

// Compares a tile's graph and labels with those of all vertices.
class TileAndWhole {
 public:
  TileAndWhole(const SeenScene& scene, const MemoryPlan& plan)
      : scene_(scene),
        plan_(plan),
        whole_(CutWhole(scene, plan)),
        cells_(CellsByKey(whole_)) {}

  void Compare(uint32_t tile) {
    const TileCut cut = CutTile(plan_, tile, scene_.centers, scene_.options);
    EXPECT_EQ(cut.rays.num_lost_rays, 0u);
    size_t num_star = 0;
    size_t num_known = 0;
    for (uint32_t i = 0; i < cut.tile.tetrahedra.cells.size(); ++i) {
      if (cut.places[i] == CellPlace::kBeyond) {
        EXPECT_EQ(cut.labels.known[i], kNotKnown);
        continue;
      }
      ++num_star;
      const auto found =
          cells_.find(KeyOf(cut.tile.tetrahedra.cells[i], cut.tile.ids));
      ASSERT_NE(found, cells_.end());
      CompareCell(cut, i, found->second);
      if (cut.labels.known[i] != kNotKnown) {
        ++num_known;
        EXPECT_EQ(cut.labels.known[i], whole_.labels[found->second]);
      }
    }
    num_star_ += num_star;
    num_known_ += num_known;
  }

  double KnownShare() const {
    return static_cast<double>(num_known_) / static_cast<double>(num_star_);
  }

 private:
  void CompareCell(const TileCut& cut, uint32_t cell, uint32_t whole_cell) {
    EXPECT_EQ(cut.graph.source[cell], whole_.graph.source[whole_cell]);
    EXPECT_EQ(cut.graph.sink[cell], whole_.graph.sink[whole_cell]);
    const Tetrahedralization& tetrahedra = cut.tile.tetrahedra;
    const auto& corners = whole_.tetrahedra.cells[whole_cell].vertices;
    for (uint32_t k = 0; k < 4; ++k) {
      const uint32_t id =
          IdOf(cut.tile.ids, tetrahedra.cells[cell].vertices[k]);
      uint32_t place = 0;
      while (IdOf(whole_.ids, corners[place]) != id) {
        ++place;
      }
      EXPECT_EQ(cut.graph.capacities[cell][k],
                whole_.graph.capacities[whole_cell][place]);
      const uint32_t other = tetrahedra.cells[cell].neighbors[k];
      const uint32_t whole_other =
          whole_.tetrahedra.cells[whole_cell].neighbors[place];
      EXPECT_EQ(cut.graph.capacities[other][tetrahedra.FacetTo(other, cell)],
                whole_.graph.capacities[whole_other][whole_.tetrahedra.FacetTo(
                    whole_other, whole_cell)]);
    }
  }

  const SeenScene& scene_;
  const MemoryPlan& plan_;
  WholeCut whole_;
  std::map<CellKey, uint32_t> cells_;
  size_t num_star_ = 0;
  size_t num_known_ = 0;
};

void ExpectSameCut(const SeenScene& scene, size_t num_tiles,
                   double min_known_share) {
  const MemoryPlan plan = PlanOf(scene.points, num_tiles, scene.observations);
  TileAndWhole both(scene, plan);
  for (uint32_t tile = 0; tile < num_tiles; ++tile) {
    both.Compare(tile);
  }
  EXPECT_GT(both.KnownShare(), min_known_share);
}

TEST(CutTile, VotesAndLabelsAreThoseOfAllPointsOnASphere) {
  ExpectSameCut(SphereScene(5000, 1), 3, 0.3);
}

TEST(CutTile, VotesAndLabelsAreThoseOfAllPointsOnTheGround) {
  ExpectSameCut(GroundScene(10000, 2), 4, 0.4);
}

TEST(CutTile, RaysThatEndInTheAirVoteAsInTheWhole) {
  ExpectSameCut(GroundSceneWithEnds(6000, 4), 4, 0.3);
}

// Rays through vertices, along edges and within facets of the tiles'
// tetrahedra, from vertices of others that lie on such facets, and to cameras
// that do. In units whose multiples are rounded cells are nearly flat.
TEST(CutTile, VotesAreThoseOfAllPointsOfALattice) {
  ExpectSameCut(LatticeScene(1, 1 / 150.0f), 4, -1);
  ExpectSameCut(BoxScene(), 3, -1);
}

// The hull of what a tile has need not hold the middle of all points.
TEST(CutTile, VotesAreThoseOfAllPointsFarOff) {
  for (const uint64_t seed : {1, 2}) {
    ExpectSameCut(ClustersScene(seed), 3, -1);
  }
}

TEST(CutTile, OneTileKnowsAll) {
  const SeenScene scene = SphereScene(2000, 3);
  const MemoryPlan plan = PlanOf(scene.points, 1, scene.observations);
  TileAndWhole both(scene, plan);
  both.Compare(0);
  EXPECT_EQ(both.KnownShare(), 1);
}

}  // namespace tile_cut_test
}  // namespace colmap_ext
