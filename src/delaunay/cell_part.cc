#include "delaunay/cell_part.h"

#include <algorithm>
#include <cmath>
#include <span>
#include <utility>

#include <Eigen/Geometry>

namespace colmap_ext {
namespace {

constexpr size_t kMaxLeaf = 4;  // facets
constexpr int kNumBins = 16;

double HalfArea(const Eigen::AlignedBox3f& box) {
  if (box.isEmpty()) {
    return 0;
  }
  const Eigen::Vector3d size = box.sizes().cast<double>();
  return size.x() * size.y() + size.y() * size.z() + size.z() * size.x();
}

}  // namespace

// Splits facets, half by half where the heuristic finds nothing better.
struct CellPart::Builder {
  struct Item {
    Eigen::AlignedBox3f box;
    Eigen::Vector3f center;
    uint32_t arc;
  };
  using Items = std::span<Item>;

  CellPart* part;

  void Build(Items items, int depth) {
    const auto index = part->nodes_.size();
    Eigen::AlignedBox3f box;
    Eigen::AlignedBox3f centers;
    for (const Item& item : items) {
      box.extend(item.box);
      centers.extend(item.center);
    }
    part->nodes_.push_back(
        {FromOrigin(box.min()), FromOrigin(box.max()), 0, 0});
    if (items.size() <= kMaxLeaf) {
      part->nodes_[index].next = static_cast<uint32_t>(part->arcs_.size());
      part->nodes_[index].num_arcs = static_cast<uint32_t>(items.size());
      for (const Item& item : items) {
        part->arcs_.push_back(item.arc);
      }
      return;
    }
    const size_t middle = Split(items, centers, depth);
    Build(items.first(middle), depth + 1);
    part->nodes_[index].next = static_cast<uint32_t>(part->nodes_.size());
    Build(items.subspan(middle), depth + 1);
  }

  Float4 FromOrigin(const Eigen::Vector3f& place) const {
    Float4 offset = {};
    for (int i = 0; i < 3; ++i) {
      offset[i] =
          static_cast<float>(static_cast<double>(place[i]) - part->origin_[i]);
    }
    return offset;
  }

  // Sorts items into two parts.
  // \return how many are in the first
  static size_t Split(Items items, const Eigen::AlignedBox3f& centers,
                      int depth) {
    // Deeper down halves, so that no stack is too small.
    constexpr int kMaxBinned = 32;
    Eigen::Index axis = 0;
    const float extent = centers.sizes().maxCoeff(&axis);
    const float scale = static_cast<float>(kNumBins) / extent;
    if (depth < kMaxBinned && extent > 0 && std::isfinite(scale)) {
      const auto bin_of = [&](const Item& item) {
        const float at = (item.center[axis] - centers.min()[axis]) * scale;
        return std::min(static_cast<int>(at), kNumBins - 1);
      };
      const int split = CheapestSplit(items, bin_of);
      const auto second = std::partition(
          items.begin(), items.end(),
          [&](const Item& item) { return bin_of(item) < split; });
      const auto middle = static_cast<size_t>(second - items.begin());
      if (middle > 0 && middle < items.size()) {
        return middle;
      }
    }
    const size_t middle = items.size() / 2;
    std::nth_element(items.begin(),
                     items.begin() + static_cast<ptrdiff_t>(middle),
                     items.end(), [axis](const Item& a, const Item& b) {
                       return a.center[axis] < b.center[axis];
                     });
    return middle;
  }

  // The bin that the second part begins with.
  template <typename BinOf>
  static int CheapestSplit(Items items, const BinOf& bin_of) {
    std::array<Eigen::AlignedBox3f, kNumBins> boxes;
    std::array<size_t, kNumBins> counts = {};
    for (const Item& item : items) {
      const auto bin = static_cast<size_t>(bin_of(item));
      boxes[bin].extend(item.box);
      ++counts[bin];
    }
    std::array<double, kNumBins> costs = {};  // of splits before a bin
    const auto add = [&](size_t bin, size_t split, Eigen::AlignedBox3f* box,
                         size_t* count) {
      box->extend(boxes[bin]);
      *count += counts[bin];
      costs[split] += static_cast<double>(*count) * HalfArea(*box);
    };
    Eigen::AlignedBox3f lower;
    Eigen::AlignedBox3f upper;
    size_t num_lower = 0;
    size_t num_upper = 0;
    for (size_t i = 1; i < kNumBins; ++i) {
      add(i - 1, i, &lower, &num_lower);
      add(kNumBins - i, kNumBins - i, &upper, &num_upper);
    }
    return static_cast<int>(std::min_element(costs.begin() + 1, costs.end()) -
                            costs.begin());
  }
};

CellPart::CellPart(const Tetrahedralization& tetrahedra,
                   std::vector<uint8_t> is_inside)
    : is_inside_(std::move(is_inside)), is_corner_(tetrahedra.points.size()) {
  std::vector<Builder::Item> items;
  Eigen::AlignedBox3f all;
  for (uint32_t cell = 0; cell < tetrahedra.cells.size(); ++cell) {
    if (!Has(cell)) {
      continue;
    }
    const auto& [vertices, neighbors] = tetrahedra.cells[cell];
    for (uint32_t k = 0; k < 4; ++k) {
      if (vertices[k] != kInfiniteVertex) {
        is_corner_[vertices[k]] = 1;
      }
      const auto& corners = kFacetCorners[k];
      const bool is_finite = std::ranges::none_of(corners, [&](auto corner) {
        return vertices[corner] == kInfiniteVertex;
      });
      if (!is_finite || Has(neighbors[k])) {
        continue;
      }
      Eigen::AlignedBox3f box;
      for (const auto corner : corners) {
        box.extend(tetrahedra.points[vertices[corner]]);
      }
      all.extend(box);
      const uint32_t outside = neighbors[k];
      items.push_back(
          {box, box.center(), 4 * outside + tetrahedra.FacetTo(outside, cell)});
    }
  }
  if (!items.empty()) {
    origin_ = all.center().cast<double>();
    extent_ = all.sizes().cast<double>().maxCoeff();
    Builder{this}.Build(items, 0);
  }
}

CellPart::Segment CellPart::SegmentOf(const Eigen::Vector3d& from,
                                      const Eigen::Vector3d& to) const {
  // Of floats, and of a few operations on them.
  constexpr double kRounding = 16 * 0x1p-24;
  // Of a way along the planes of an axis, as good as infinite.
  constexpr double kLarge = 1e30;
  const Eigen::Vector3d start = from - origin_;
  const Eigen::Vector3d way = to - from;
  const double slack = kRounding * (start.lpNorm<Eigen::Infinity>() + extent_);
  Segment segment = {};
  for (int i = 0; i < 3; ++i) {
    segment.before[i] = static_cast<float>(start[i] - slack);
    segment.after[i] = static_cast<float>(start[i] + slack);
    segment.inverse[i] =
        static_cast<float>(std::clamp(1 / way[i], -kLarge, kLarge));
  }
  return segment;
}

}  // namespace colmap_ext
