#pragma once

#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include <Eigen/Core>

#include "base/byte_store.h"
#include "merging/merged_surface.h"
#include "merging/tile_surface.h"
#include "tiles/plan_vertices.h"

namespace colmap_ext {

// A tile's facets, and those of other tiles around them.
struct SurfaceBand {
  MergedSurface surface;        // facets in the order of the tiles
  std::vector<FacetKey> keys;   // [F] the plan's vertices of each
  std::vector<uint8_t> is_own;  // [F] 1: of the tile, 0: of others
};

// Rings of facets around a tile's that a band has. Whether vertices of its
// facets are split into copies depends on the facets at their neighbors, and,
// where facets are dropped and vertices split again, at the neighbors of these;
// attributes of centroids come from one ring more.
inline constexpr uint8_t kBandRings = 4;

// A surface of which one band is held at a time. Facets are in a store, but for
// those within kBandRings of a facet of another tile, the rim.
class SurfaceBands {
 public:
  // \param plan  outlives it
  // \param centroids  see PositionsOf()
  SurfaceBands(const PlanVertices& plan, std::vector<Eigen::Vector3f> centroids,
               const MakeStore& make_store);

  // Adds the next tile.
  void Add(const TileSurface& surface);

  // To be called after the last tile.
  void Finish();

  size_t NumTiles() const { return begins_.size() - 1; }

  uint32_t NumPlanVertices() const { return plan_.Blocks().NumVertices(); }

  SurfaceBand Read(uint32_t tile) const;

 private:
  // A facet of the rim.
  struct RimFacet {
    Facet facet;
    uint32_t tile;
  };

  void AddRim(const TileSurface& surface);
  std::vector<uint32_t> RimAround(uint32_t tile) const;

  const PlanVertices& plan_;
  std::vector<Eigen::Vector3f> centroids_;
  StoredVector<Facet> facets_;
  std::vector<uint64_t> begins_{0};  // [tiles + 1] into facets_
  std::vector<RimFacet> rim_;        // in the order of facets_
  // Vertices of the rim, ascending, each with a facet of the rim.
  std::vector<std::pair<uint32_t, uint32_t>> at_;
  std::vector<PartnerFix> fixes_;
};

}  // namespace colmap_ext
