#include "scene/point_tree.h"

#include <algorithm>
#include <limits>
#include <utility>

#include <tbb/parallel_invoke.h>
#include <Eigen/Geometry>

#include "base/indices.h"

namespace colmap_ext {
namespace {

using Eigen::Vector3f;

constexpr uint32_t kMaxLeaf = 12;  // points; by trial

}  // namespace

PointTree::PointTree(std::span<const Vector3f> points)
    : points_(points.size()),
      indices_(Iota(points.size())),
      axes_(points.size()) {
  Build(points, 0, static_cast<uint32_t>(points.size()));
}

void PointTree::Build(std::span<const Vector3f> points, uint32_t begin,
                      uint32_t end) {
  Eigen::AlignedBox3f box;
  for (uint32_t i = begin; i < end; ++i) {
    points_[i] = points[indices_[i]];
    box.extend(points_[i]);
  }
  if (end - begin <= kMaxLeaf) {
    return;
  }
  Eigen::Index axis = 0;
  box.sizes().maxCoeff(&axis);
  const uint32_t middle = begin + (end - begin) / 2;
  uint32_t* const indices = indices_.data();
  std::nth_element(indices + begin, indices + middle, indices + end,
                   [&](uint32_t a, uint32_t b) {
                     return std::pair(points[a][axis], a) <
                            std::pair(points[b][axis], b);
                   });
  points_[middle] = points[indices_[middle]];
  axes_[middle] = static_cast<uint8_t>(axis);
  tbb::parallel_invoke([&] { Build(points, begin, middle); },
                       [&] { Build(points, middle + 1, end); });
}

// \param outside  how far the place lies from the node's points along each
//        axis, at least: differences of coordinates, rounded as those of the
//        points are, so that no point is missed
// \param visit  visit(squared distance, index) of points returns the largest
//        squared distance that is still wanted
template <typename Visit>
void PointTree::Search(const Vector3f& place, uint32_t begin, uint32_t end,
                       Vector3f outside, const Visit& visit) const {
  const auto visit_point = [&](uint32_t i) {
    return visit((points_[i] - place).squaredNorm(), indices_[i]);
  };
  if (end - begin <= kMaxLeaf) {
    for (uint32_t i = begin; i < end; ++i) {
      visit_point(i);
    }
    return;
  }
  const uint32_t middle = begin + (end - begin) / 2;
  const Eigen::Index axis = axes_[middle];
  const float beyond = place[axis] - points_[middle][axis];
  std::pair near(begin, middle);
  std::pair far(middle + 1, end);
  if (beyond > 0) {
    std::swap(near, far);
  }
  Search(place, near.first, near.second, outside, visit);
  const float bound = visit_point(middle);
  outside[axis] = beyond;
  if (outside.squaredNorm() <= bound) {
    Search(place, far.first, far.second, outside, visit);
  }
}

std::vector<uint32_t> PointTree::Nearest(const Vector3f& place, size_t count,
                                         float max_distance) const {
  if (count == 0) {
    return {};
  }
  float bound =
      std::min(max_distance * max_distance, std::numeric_limits<float>::max());
  std::vector<std::pair<float, uint32_t>> found;  // squared distance, index
  found.reserve(count + 1);
  Search(place, 0, static_cast<uint32_t>(points_.size()), Vector3f::Zero(),
         [&](float squared, uint32_t index) {
           if (squared <= bound) {
             const std::pair candidate(squared, index);
             found.insert(std::ranges::upper_bound(found, candidate),
                          candidate);
             found.resize(std::min(found.size(), count));
             bound = found.size() == count ? found.back().first : bound;
           }
           return bound;
         });
  std::vector<uint32_t> indices;
  for (const auto& [squared, index] : found) {
    indices.push_back(index);
  }
  return indices;
}

std::vector<uint32_t> PointTree::Within(const Vector3f& place,
                                        float distance) const {
  const float bound = distance * distance;
  std::vector<uint32_t> found;
  Search(place, 0, static_cast<uint32_t>(points_.size()), Vector3f::Zero(),
         [&](float squared, uint32_t index) {
           if (squared < bound) {
             found.push_back(index);
           }
           return bound;
         });
  return found;
}

}  // namespace colmap_ext
