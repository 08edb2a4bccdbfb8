#include "meshing/wall_layers.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <cstdint>
#include <limits>
#include <optional>
#include <utility>

#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>
#include <Eigen/Core>
#include <Eigen/Eigenvalues>

#include "base/mix_bits.h"
#include "scene/point_tree.h"

namespace colmap_ext {
namespace {

using Eigen::Vector3f;

// Lengths are in px of the view that sees a place closest. The numbers are
// choices, but for kDisagreement.

// Places are every eighth point.
constexpr uint32_t kSampling = 8;

// The part of a wall around a place has this radius and at least so many
// places, of which at most so many count.
constexpr float kRadius = 32;
constexpr size_t kMinPlaces = 24;
constexpr size_t kNumCounted = 64;

// A part is flat where the smallest variance is at most this share of the next.
// Two layers 15 px apart have 0.22.
constexpr float kFlatness = 0.3f;

// The images of a part disagree where the differences between their mean
// heights explain so much of the variance of all heights. Of the parts of
// scenes whose walls are single (fountain, sceaux, toycars, bunny) 1 % has
// more; of south's, a quarter.
constexpr float kDisagreement = 0.2f;

// ... and where they differ by more than this.
constexpr float kMinGap = 2;

// A layer is dropped in rounds, each with other places, as long as more than
// this share of the points goes.
constexpr int kRounds = 3;
constexpr double kMinDropped = 0.01;

// Some of the points.
struct Places {
  std::vector<uint32_t> points;     // [places] of the cloud
  std::vector<Vector3f> positions;  // [places]
};

// \param weighted  ends of rays are no places
Places SamplePlaces(const WeightedCloud& weighted) {
  const PointCloud& cloud = weighted.cloud;
  Places places;
  for (uint32_t i = 0; i < weighted.num_points; ++i) {
    if (!cloud.views[i].empty() && MixBits(i) % kSampling == 0) {
      places.points.push_back(i);
      places.positions.push_back(cloud.positions[i]);
    }
  }
  return places;
}

// The normal of the plane that fits points, if they are flat.
std::optional<Vector3f> NormalOf(const std::vector<Vector3f>& offsets) {
  Vector3f sum = Vector3f::Zero();
  Eigen::Matrix3f scatter = Eigen::Matrix3f::Zero();
  for (const Vector3f& offset : offsets) {
    sum += offset;
    scatter += offset * offset.transpose();
  }
  scatter -= sum * sum.transpose() / static_cast<float>(offsets.size());
  Eigen::SelfAdjointEigenSolver<Eigen::Matrix3f> solver;
  solver.computeDirect(scatter);
  if (!(solver.eigenvalues()[0] <= kFlatness * solver.eigenvalues()[1])) {
    return std::nullopt;
  }
  return Vector3f(solver.eigenvectors().col(0));
}

// Observations of heights: their number, sum, and sum of squares.
struct Heights {
  float count = 0;
  float sum = 0;
  float squares = 0;

  void Add(float height) {
    ++count;
    sum += height;
    squares += height * height;
  }
  Heights& operator+=(const Heights& other) {
    count += other.count;
    sum += other.sum;
    squares += other.squares;
    return *this;
  }

  float Mean() const { return sum / count; }

  // Of the squared distances from a mean of zero, what the mean explains.
  float Explained() const { return sum * sum / count; }
};

// What an image sees of a part.
struct Image {
  uint32_t view = 0;
  Heights heights;

  float Mean() const { return heights.Mean(); }
};

// The images of a part in two groups, each of which sees a layer.
struct Groups {
  std::vector<Image> images;       // ascending by their mean heights
  size_t num_lower = 0;            // the first of them
  std::array<Heights, 2> heights;  // of the lower and the upper group

  size_t GroupOf(size_t image) const { return image < num_lower ? 0 : 1; }

  // \param trust [views] in an observation
  size_t Stronger(const std::vector<float>& trust) const {
    std::array<float, 2> strengths{};
    for (size_t i = 0; i < images.size(); ++i) {
      strengths[GroupOf(i)] += trust[images[i].view] * images[i].heights.count;
    }
    return strengths[0] >= strengths[1] ? 0 : 1;
  }

  // The group whose layer is nearer to the height zero.
  size_t Nearest() const {
    return std::abs(heights[0].Mean()) <= std::abs(heights[1].Mean()) ? 0 : 1;
  }
};

// Splits the images of a part where that explains most; nothing if they agree.
std::optional<Groups> SplitImages(std::vector<Image> images) {
  Heights all;
  float between = 0;
  for (const Image& image : images) {
    all += image.heights;
    between += image.heights.Explained();
  }
  if (!(between - all.Explained() >
        kDisagreement * (all.squares - all.Explained()))) {
    return std::nullopt;
  }
  std::ranges::sort(images, {}, &Image::Mean);
  Groups groups;
  float most = 0;
  Heights lower;
  for (size_t i = 0; i + 1 < images.size(); ++i) {
    lower += images[i].heights;
    const Heights upper{all.count - lower.count, all.sum - lower.sum};
    const float explained = lower.Explained() + upper.Explained();
    if (explained > most) {
      most = explained;
      groups.num_lower = i + 1;
      groups.heights = {lower, upper};
    }
  }
  if (!(groups.heights[1].Mean() - groups.heights[0].Mean() > kMinGap)) {
    return std::nullopt;
  }
  groups.images = std::move(images);
  return groups;
}

// Finds walls that are there twice.
class LayerFinder {
 public:
  LayerFinder(const std::vector<View>& views, const WeightedCloud& weighted)
      : cloud_(weighted.cloud),
        num_points_(weighted.num_points),
        places_(SamplePlaces(weighted)),
        tree_(places_.positions) {
    for (const View& view : views) {
      centers_.emplace_back(view.Center().cast<float>());
      focal_lengths_.push_back(static_cast<float>(std::max(view.fx, view.fy)));
    }
  }

  // [P] 1: the point is of a weaker layer. Empty: none is.
  std::vector<uint8_t> FindWeaker() const {
    std::vector<uint8_t> is_split(places_.points.size(), 0);
    const std::vector<float> trust = MeasureTrust(&is_split);
    std::vector<uint8_t> is_weaker(is_split.size(), 0);
    tbb::parallel_for(size_t{0}, is_split.size(), [&](size_t i) {
      if (is_split[i] != 0) {
        const std::optional<Groups> groups = GroupsAt(i);
        is_weaker[i] = groups->Nearest() != groups->Stronger(trust) ? 1 : 0;
      }
    });
    if (std::ranges::count(is_weaker, 1) == 0) {
      return {};
    }
    std::vector<uint8_t> is_point_weaker(cloud_.size(), 0);
    tbb::parallel_for(size_t{0}, num_points_, [&](size_t i) {
      constexpr float kAnywhere = std::numeric_limits<float>::infinity();
      is_point_weaker[i] =
          is_weaker[tree_.Nearest(cloud_.positions[i], 1, kAnywhere).front()];
    });
    return is_point_weaker;
  }

 private:
  // [views] The logarithms of the odds that an observation is of the stronger
  // group, as far as the numbers of observations tell. Walls that the same
  // images see so keep the same layer.
  // \param is_split [places] set where there are groups
  std::vector<float> MeasureTrust(std::vector<uint8_t>* is_split) const {
    const std::vector<float> same(centers_.size(), 1);
    // [views] observations that are not, and are, of the stronger group
    std::vector<std::array<uint64_t, 2>> counts(centers_.size());
    tbb::parallel_for(size_t{0}, is_split->size(), [&](size_t i) {
      const std::optional<Groups> groups = GroupsAt(i);
      if (!groups) {
        return;
      }
      (*is_split)[i] = 1;
      const size_t stronger = groups->Stronger(same);
      for (size_t k = 0; k < groups->images.size(); ++k) {
        const auto& [view, heights] = groups->images[k];
        std::atomic_ref(counts[view][groups->GroupOf(k) == stronger ? 1 : 0])
            .fetch_add(static_cast<uint64_t>(heights.count),
                       std::memory_order_relaxed);
      }
    });
    std::vector<float> trust;
    for (const auto& [weaker, stronger] : counts) {
      trust.push_back(std::log(static_cast<float>(1 + stronger) /
                               static_cast<float>(1 + weaker)));
    }
    return trust;
  }

  // The groups of images of the part around a place, with heights over it.
  std::optional<Groups> GroupsAt(size_t i) const {
    const Vector3f& position = places_.positions[i];
    const float footprint = Footprint(i);
    const std::vector<uint32_t> near =
        tree_.Within(position, kRadius * footprint);
    if (near.size() < kMinPlaces) {
      return std::nullopt;
    }
    std::vector<uint32_t> part;
    std::vector<Vector3f> offsets;  // px
    for (size_t k = 0; k < near.size(); k += near.size() / kNumCounted + 1) {
      part.push_back(near[k]);
      offsets.emplace_back((places_.positions[near[k]] - position) / footprint);
    }
    const std::optional<Vector3f> normal = NormalOf(offsets);
    return normal ? SplitImages(ImagesOf(i, part, offsets, *normal))
                  : std::nullopt;
  }

  // Of the images on the same side of a wall as those that see a place: what
  // the others see is the back of a thin wall.
  std::vector<Image> ImagesOf(size_t place, const std::vector<uint32_t>& part,
                              const std::vector<Vector3f>& offsets,
                              const Vector3f& normal) const {
    std::vector<Heights>& of_views = heights_.local();
    of_views.resize(centers_.size());
    const Vector3f& position = places_.positions[place];
    const auto is_above = [&](uint32_t view) {
      return (centers_[view] - position).dot(normal) > 0;
    };
    const auto seen_by = cloud_.views[places_.points[place]];
    const bool is_seen_from_above =
        2 * std::ranges::count_if(seen_by, is_above) >= std::ssize(seen_by);
    std::vector<uint32_t> views;
    for (size_t k = 0; k < part.size(); ++k) {
      const float height = offsets[k].dot(normal);
      for (const uint32_t view : cloud_.views[places_.points[part[k]]]) {
        if (of_views[view].count == 0) {
          views.push_back(view);
        }
        of_views[view].Add(height);
      }
    }
    std::vector<Image> images;
    for (const uint32_t view : views) {
      const Heights heights = std::exchange(of_views[view], {});
      if (is_above(view) == is_seen_from_above) {
        images.push_back({view, heights});
      }
    }
    return images;
  }

  // Of the view that sees a place closest, scene units.
  float Footprint(size_t i) const {
    float footprint = std::numeric_limits<float>::infinity();
    for (const uint32_t view : cloud_.views[places_.points[i]]) {
      footprint =
          std::min(footprint, (centers_[view] - places_.positions[i]).norm() /
                                  focal_lengths_[view]);
    }
    return footprint;
  }

  const PointCloud& cloud_;
  const size_t num_points_;  // that are no ends of rays
  const Places places_;
  const PointTree tree_;
  std::vector<Vector3f> centers_;     // [views]
  std::vector<float> focal_lengths_;  // [views] px
  // Scratch, [views]; without observations between uses.
  mutable tbb::enumerable_thread_specific<std::vector<Heights>> heights_;
};

}  // namespace

size_t DropWeakerLayers(const std::vector<View>& views,
                        WeightedCloud* weighted) {
  const size_t num_points = weighted->num_points;
  for (int round = 0; round < kRounds; ++round) {
    const size_t before = weighted->num_points;
    const std::vector<uint8_t> is_weaker =
        LayerFinder(views, *weighted).FindWeaker();
    if (is_weaker.empty()) {
      break;
    }
    DropPoints(is_weaker, weighted);
    if (static_cast<double>(before - weighted->num_points) <
        kMinDropped * static_cast<double>(before)) {
      break;
    }
  }
  return num_points - weighted->num_points;
}

}  // namespace colmap_ext
