#include "tiles/tile_cells.h"

#include <algorithm>
#include <limits>
#include <set>

#include "base/indices.h"

namespace colmap_ext {
namespace {

// The axis with the largest variance.
int WidestAxis(const std::vector<Eigen::Vector3f>& points,
               std::span<const uint32_t> part) {
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  Eigen::Vector3d squares = Eigen::Vector3d::Zero();
  for (const uint32_t point : part) {
    mean += points[point].cast<double>();
  }
  mean /= static_cast<double>(part.size());
  for (const uint32_t point : part) {
    squares += (points[point].cast<double>() - mean).cwiseAbs2();
  }
  Eigen::Index axis = 0;
  squares.maxCoeff(&axis);
  return static_cast<int>(axis);
}

// Sorts a part along an axis.
// \return where its first share of the weight ends: at least so many points
//         are on either side
size_t Split(const std::vector<Eigen::Vector3f>& points,
             const std::vector<float>& weights, int axis, double share,
             size_t min_first, size_t min_second, std::span<uint32_t> part) {
  std::ranges::sort(part, [&](uint32_t a, uint32_t b) {
    const float x = points[a][axis];
    const float y = points[b][axis];
    return x != y ? x < y : a < b;
  });
  double total = 0;
  for (const uint32_t point : part) {
    total += weights[point];
  }
  double sum = 0;
  size_t end = 0;
  while (end < part.size() && sum < share * total) {
    sum += weights[part[end++]];
  }
  return std::clamp(end, min_first, part.size() - min_second);
}

}  // namespace

SplitTree::SplitTree(const std::vector<Eigen::Vector3f>& points,
                     const std::vector<float>& weights, size_t num_parts)
    : cells_(num_parts) {
  constexpr float kInfinity = std::numeric_limits<float>::infinity();
  std::vector<uint32_t> order = Iota(points.size());
  root_ = Build(points, weights, order, 0, static_cast<uint32_t>(num_parts),
                {Eigen::Vector3f::Constant(-kInfinity),
                 Eigen::Vector3f::Constant(kInfinity)});
}

uint32_t SplitTree::Build(const std::vector<Eigen::Vector3f>& points,
                          const std::vector<float>& weights,
                          std::span<uint32_t> part, uint32_t first_part,
                          uint32_t num_parts, const Eigen::AlignedBox3f& box) {
  if (num_parts == 1) {
    cells_[first_part] = box;
    return kLeaf + first_part;
  }
  const uint32_t num_first = num_parts / 2;
  const uint32_t num_second = num_parts - num_first;
  const int axis = WidestAxis(points, part);
  const size_t middle =
      Split(points, weights, axis, static_cast<double>(num_first) / num_parts,
            num_first, num_second, part);
  Node node{axis, points[part[middle]][axis], {}};
  Eigen::AlignedBox3f first = box;
  Eigen::AlignedBox3f second = box;
  first.max()[axis] = node.border;
  second.min()[axis] = node.border;
  node.children[0] =
      Build(points, weights, part.first(middle), first_part, num_first, first);
  node.children[1] = Build(points, weights, part.subspan(middle),
                           first_part + num_first, num_second, second);
  nodes_.push_back(node);
  return static_cast<uint32_t>(nodes_.size() - 1);
}

uint32_t SplitTree::PartOf(const Eigen::Vector3f& point) const {
  uint32_t at = root_;
  while (at < kLeaf) {
    const Node& node = nodes_[at];
    at = node.children[point[node.axis] < node.border ? 0 : 1];
  }
  return at - kLeaf;
}

uint32_t CellOf(const TileCells& cells, const Eigen::Vector3f& point) {
  const auto contains = [&point](const Eigen::AlignedBox3f& cell) {
    return (cell.min().array() <= point.array()).all() &&
           (point.array() < cell.max().array()).all();
  };
  const auto found = std::ranges::find_if(cells, contains);
  return static_cast<uint32_t>(found - cells.begin());
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
