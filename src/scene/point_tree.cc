#include "scene/point_tree.h"

#include <algorithm>
#include <limits>
#include <utility>

#include <nanoflann.hpp>

namespace colmap_ext {
namespace {

using Points = std::span<const Eigen::Vector3f>;

// The points as nanoflann reads them.
struct Dataset {
  Points points;

  size_t kdtree_get_point_count() const { return points.size(); }
  float kdtree_get_pt(size_t point, size_t axis) const {
    return points[point][static_cast<Eigen::Index>(axis)];
  }
  template <typename Box>
  bool kdtree_get_bbox(Box& /*box*/) const {
    return false;  // nanoflann finds it
  }
};

// Squared distances, rounded as Eigen rounds them.
struct Distance {
  using ElementType = float;
  using DistanceType = float;

  explicit Distance(const Dataset& dataset) : points(dataset.points) {}

  float evalMetric(const float* place, uint32_t point, size_t /*size*/) const {
    return (points[point] - Eigen::Map<const Eigen::Vector3f>(place))
        .squaredNorm();
  }
  float accum_dist(float a, float b, size_t /*axis*/) const {
    return (a - b) * (a - b);
  }

  Points points;
};

// The nearest points found so far, as nanoflann's searches fill it. Unlike
// with nanoflann's own, the result does not depend on the order of the search.
class NearestPoints {
 public:
  using DistanceType = float;

  NearestPoints(size_t count, float max_distance_squared)
      : count_(count), max_distance_squared_(max_distance_squared) {
    found_.reserve(count + 1);
    SetBound(max_distance_squared);
  }

  bool full() const { return found_.size() == count_; }

  // nanoflann offers points strictly nearer than this, and skips boxes that it
  // takes for farther.
  float worstDist() const { return bound_; }

  // \return whether the search continues: always
  bool addPoint(float distance_squared, uint32_t index) {
    const std::pair candidate(distance_squared, index);
    if (!(distance_squared <= max_distance_squared_)) {
      return true;
    }
    found_.insert(std::ranges::upper_bound(found_, candidate), candidate);
    if (found_.size() > count_) {
      found_.pop_back();
    }
    if (full()) {
      SetBound(found_.back().first);
    }
    return true;
  }

  std::vector<uint32_t> Indices() const {
    std::vector<uint32_t> indices;
    indices.reserve(found_.size());
    for (const auto& [distance_squared, index] : found_) {
      indices.push_back(index);
    }
    return indices;
  }

 private:
  // Above the largest squared distance that is still wanted. The factor covers
  // the rounding of nanoflann's distances to boxes: each level of the tree adds
  // a relative error of at most 2^-23, and there are less than 1000 levels
  // (floats can be halved 277 times on each axis, 2^32 equal points 32 times).
  void SetBound(float distance_squared) {
    constexpr float kSlack = 1.001f;
    bound_ =
        std::max(kSlack * distance_squared, std::numeric_limits<float>::min());
  }

  size_t count_;
  float max_distance_squared_;
  float bound_;                                    // squared distance
  std::vector<std::pair<float, uint32_t>> found_;  // squared distance and index
                                                   // of each, ascending
};

// All points nearer than a distance.
struct PointsWithin {
  using DistanceType = float;

  float distance_squared;
  std::vector<uint32_t> found;

  bool full() const { return true; }
  float worstDist() const { return distance_squared; }
  bool addPoint(float squared, uint32_t index) {
    if (squared < distance_squared) {
      found.push_back(index);
    }
    return true;
  }
};

}  // namespace

struct PointTree::Index {
  explicit Index(Points points) : dataset{points}, tree(3, dataset) {}

  Dataset dataset;
  nanoflann::KDTreeSingleIndexAdaptor<Distance, Dataset, 3, uint32_t> tree;
};

PointTree::PointTree(Points points)
    : index_(points.empty() ? nullptr : std::make_unique<Index>(points)) {}

PointTree::~PointTree() = default;

std::vector<uint32_t> PointTree::Nearest(const Eigen::Vector3f& place,
                                         size_t count,
                                         float max_distance) const {
  if (index_ == nullptr || count == 0) {
    return {};
  }
  NearestPoints nearest(count, max_distance * max_distance);
  index_->tree.findNeighbors(nearest, place.data(), nanoflann::SearchParams());
  return nearest.Indices();
}

std::vector<uint32_t> PointTree::Within(const Eigen::Vector3f& place,
                                        float distance) const {
  PointsWithin within{distance * distance, {}};
  if (index_ != nullptr) {
    index_->tree.findNeighbors(within, place.data(), nanoflann::SearchParams());
  }
  return std::move(within.found);
}

}  // namespace colmap_ext
