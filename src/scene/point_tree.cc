#include "scene/point_tree.h"

#include <algorithm>

#include <tbb/parallel_invoke.h>

namespace colmap_ext {

namespace {

constexpr size_t kSerialSize = 1 << 14;  // of the nodes built by one thread

}  // namespace

struct PointTree::Search {
  Eigen::Vector3f place;
  size_t count;
  float max_distance_squared;
  std::vector<std::pair<float, uint32_t>> found;  // distance squared, ascending

  // Beyond it nothing is wanted any more.
  float Reach() const {
    return found.size() < count ? max_distance_squared : found.back().first;
  }

  void Offer(const Eigen::Vector3f& point, uint32_t index) {
    const std::pair<float, uint32_t> candidate((point - place).squaredNorm(),
                                               index);
    if (!(candidate.first <= max_distance_squared)) {
      return;
    }
    found.insert(std::upper_bound(found.begin(), found.end(), candidate),
                 candidate);
    if (found.size() > count) {
      found.pop_back();
    }
  }
};

PointTree::PointTree(std::span<const Eigen::Vector3f> points)
    : axes_(points.size()) {
  points_.reserve(points.size());
  for (const Eigen::Vector3f& point : points) {
    points_.emplace_back(point, static_cast<uint32_t>(points_.size()));
  }
  Build(0, points_.size());
}

void PointTree::Build(size_t begin, size_t end) {
  if (end - begin <= 1) {
    return;
  }
  Eigen::Vector3f low = points_[begin].first;
  Eigen::Vector3f high = low;
  for (size_t i = begin; i < end; ++i) {
    low = low.cwiseMin(points_[i].first);
    high = high.cwiseMax(points_[i].first);
  }
  int axis = 0;
  (high - low).maxCoeff(&axis);
  const size_t middle = begin + (end - begin) / 2;
  const auto at = [this](size_t i) {
    return points_.begin() + static_cast<std::ptrdiff_t>(i);
  };
  std::nth_element(at(begin), at(middle), at(end),
                   [axis](const auto& a, const auto& b) {
                     return std::pair(a.first[axis], a.second) <
                            std::pair(b.first[axis], b.second);
                   });
  axes_[middle] = static_cast<uint8_t>(axis);
  const auto build_low = [this, begin, middle] { Build(begin, middle); };
  const auto build_high = [this, middle, end] { Build(middle + 1, end); };
  if (end - begin > kSerialSize) {
    tbb::parallel_invoke(build_low, build_high);
  } else {
    build_low();
    build_high();
  }
}

void PointTree::Visit(size_t begin, size_t end, Search* search) const {
  if (begin == end) {
    return;
  }
  const size_t middle = begin + (end - begin) / 2;
  const auto& [point, index] = points_[middle];
  const int axis = axes_[middle];
  const float beyond = search->place[axis] - point[axis];
  const bool is_low = beyond < 0;
  Visit(is_low ? begin : middle + 1, is_low ? middle : end, search);
  search->Offer(point, index);
  if (beyond * beyond <= search->Reach()) {
    Visit(is_low ? middle + 1 : begin, is_low ? end : middle, search);
  }
}

std::vector<uint32_t> PointTree::Nearest(const Eigen::Vector3f& place,
                                         size_t count,
                                         float max_distance) const {
  Search search{place, count, max_distance * max_distance, {}};
  if (count > 0) {
    Visit(0, points_.size(), &search);
  }
  std::vector<uint32_t> indices;
  for (const auto& [distance_squared, index] : search.found) {
    indices.push_back(index);
  }
  return indices;
}

}  // namespace colmap_ext
