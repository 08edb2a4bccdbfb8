#include "tiles/tile_cells.h"
#include "spatial/facet_tree.h"

#include <algorithm>
#include <set>

namespace colmap_ext {

uint32_t CellOf(const TileCells& cells, const Eigen::Vector3f& point) {
  const auto contains = [&point](const Eigen::AlignedBox3f& cell) {
    return (cell.min().array() <= point.array()).all() &&
           (point.array() < cell.max().array()).all();
  };
  const auto found = std::ranges::find_if(cells, contains);
  return static_cast<uint32_t>(found - cells.begin());
}

Eigen::AlignedBox3f GrowBox(const Eigen::AlignedBox3f& box, float margin) {
  return {box.min().array() - margin, box.max().array() + margin};
}

std::vector<uint32_t> ColorTiles(const TileCells& cells,
                                 const std::vector<float>& reaches,
                                 const TriangleMesh& mesh) {
  TileCells near;
  for (size_t tile = 0; tile < cells.size(); ++tile) {
    near.push_back(GrowBox(cells[tile], reaches[tile]));
  }
  std::vector<std::set<uint32_t>> neighbors(cells.size());
  std::vector<uint32_t> met;
  for (const Facet& facet : mesh.facets) {
    const Eigen::AlignedBox3f box = BoxOf(mesh, facet);
    met.clear();
    for (uint32_t tile = 0; tile < near.size(); ++tile) {
      if (near[tile].intersects(box)) {
        met.push_back(tile);
      }
    }
    for (size_t i = 1; i < met.size(); ++i) {
      neighbors[met[i]].insert(met.begin(), met.begin() + i);
    }
  }
  std::vector<uint32_t> colors;
  for (uint32_t tile = 0; tile < cells.size(); ++tile) {
    std::set<uint32_t> taken;
    for (const uint32_t neighbor : neighbors[tile]) {
      taken.insert(colors[neighbor]);  // of the tiles before this one
    }
    uint32_t color = 0;
    while (taken.contains(color)) {
      ++color;
    }
    colors.push_back(color);
  }
  return colors;
}

bool MayHide(const Eigen::AlignedBox3f& box, const Eigen::Vector3f& center,
             const Eigen::AlignedBox3f& seen) {
  // The hull is what the other box sweeps as it shrinks onto the centre: at t
  // its sides are center + t (side - center). On each axis it meets the box
  // where t fulfils two linear inequalities.
  float first = 0;
  float last = 1;
  const auto at_most = [&](float slope, float bound) {  // slope t <= bound
    if (slope > 0) {
      last = std::min(last, bound / slope);
    } else if (slope < 0) {
      first = std::max(first, bound / slope);
    } else if (bound < 0) {
      last = -1;
    }
  };
  for (int axis = 0; axis < 3; ++axis) {
    const float c = center[axis];
    at_most(seen.min()[axis] - c, box.max()[axis] - c);
    at_most(c - seen.max()[axis], c - box.min()[axis]);
  }
  return first <= last;
}

}  // namespace colmap_ext
