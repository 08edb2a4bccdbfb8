#include "tiles/tile_cut.h"

#include <gtest/gtest.h>

#include "tests/tiles/memory_plan.h"

namespace colmap_ext {
namespace tile_cut_test {

// Compares a tile's graph and labels with those of all vertices.
class TileAndWhole {
 public:
  TileAndWhole(const SeenScene& scene, const MemoryPlan& plan)
      : scene_(scene),
        plan_(plan),
        whole_(scene, plan),
        cells_(whole_.CellsByKey()) {}

  void Compare(uint32_t tile) {
    const TileCut cut = CutTile(plan_, tile, scene_.centers, scene_.options);
    EXPECT_EQ(cut.rays.num_lost_rays, 0u);
    for (uint32_t i = 0; i < cut.tile.tetrahedra.cells.size(); ++i) {
      if (cut.places[i] == CellPlace::kBeyond) {
        EXPECT_EQ(cut.labels.known[i], kNotKnown);
        continue;
      }
      ++num_star_;
      const auto found = cells_.find(Sorted(cut.tile.CornersOf(i)));
      ASSERT_NE(found, cells_.end());
      CompareCell(cut, i, found->second);
      if (cut.labels.known[i] != kNotKnown) {
        ++num_known_;
        EXPECT_EQ(cut.labels.known[i], whole_.labels[found->second]);
      }
    }
  }

  double KnownShare() const {
    return static_cast<double>(num_known_) / static_cast<double>(num_star_);
  }

 private:
  void CompareCell(const TileCut& cut, uint32_t cell, uint32_t whole_cell) {
    const NodeCapacities& whole_node = whole_.graph[whole_cell];
    EXPECT_EQ(cut.graph[cell].source, whole_node.source);
    EXPECT_EQ(cut.graph[cell].sink, whole_node.sink);
    const Tetrahedralization& tetrahedra = cut.tile.tetrahedra;
    const CellKey corners = cut.tile.CornersOf(cell);
    for (uint32_t k = 0; k < 4; ++k) {
      const uint32_t place = whole_.tetrahedra.IndexOf(whole_cell, corners[k]);
      EXPECT_EQ(cut.graph[cell].arcs[k], whole_node.arcs[place]);
      const uint32_t other = tetrahedra.cells[cell].neighbors[k];
      const uint32_t whole_other =
          whole_.tetrahedra.cells[whole_cell].neighbors[place];
      EXPECT_EQ(cut.graph[other].arcs[tetrahedra.FacetTo(other, cell)],
                whole_.graph[whole_other]
                    .arcs[whole_.tetrahedra.FacetTo(whole_other, whole_cell)]);
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
  const MemoryPlan plan = PlanOf(scene, num_tiles);
  TileAndWhole both(scene, plan);
  for (uint32_t tile = 0; tile < num_tiles; ++tile) {
    both.Compare(tile);
  }
  EXPECT_GE(both.KnownShare(), min_known_share);
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

TEST(CutTile, OneTileKnowsAll) { ExpectSameCut(SphereScene(2000, 3), 1, 1); }

}  // namespace tile_cut_test
}  // namespace colmap_ext
