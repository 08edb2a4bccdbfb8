#include "tests/synthetic/dense_scene.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <utility>

#include <Eigen/LU>

#include "base/indices.h"
#include "base/percentile.h"
#include "tests/synthetic/noise.h"

namespace colmap_ext::synthetic {
namespace {

using Eigen::Vector3f;

// Other images, those with the closest directions of view first.
std::vector<std::vector<uint32_t>> Neighbors(const std::vector<View>& views) {
  std::vector<std::vector<uint32_t>> neighbors(views.size());
  for (size_t i = 0; i < views.size(); ++i) {
    std::vector<std::pair<double, uint32_t>> others;
    for (size_t j = 0; j < views.size(); ++j) {
      if (j != i) {
        others.emplace_back(-views[i].cam_from_world_rotation.row(2).dot(
                                views[j].cam_from_world_rotation.row(2)),
                            j);
      }
    }
    std::ranges::sort(others);
    for (const auto& [cosine, j] : others) {
      neighbors[i].push_back(j);
    }
  }
  return neighbors;
}

struct Camera {
  Eigen::Matrix3f image_from_world;  // projection without its last column
  Vector3f offset;                   // its last column
  Eigen::Matrix3f world_from_image;  // inverse of image_from_world
};

struct Pixel {
  uint32_t view;
  int row, col;
  int depth;  // how many pixels it is away from the reference; 0: it is it
};

// Positions, normals and colors of the pixels of one point.
struct Samples {
  std::array<std::vector<float>, 9> values;
  std::vector<uint32_t> views;

  void Clear() {
    for (auto& v : values) {
      v.clear();
    }
    views.clear();
  }
  size_t size() const { return values[0].size(); }
  Vector3f MedianOf(int first) {
    return {Median(&values[first]), Median(&values[first + 1]),
            Median(&values[first + 2])};
  }
};

class Fusion {
 public:
  Fusion(const std::vector<View>& views, const std::vector<DepthMap>& maps,
         const std::vector<ColorImage>& images, const FusionOptions& options)
      : maps_(maps),
        images_(images),
        options_(options),
        min_cos_normal_(
            std::cos(options.max_normal_error * std::numbers::pi / 180)),
        neighbors_(Neighbors(views)),
        is_done_(views.size(), false) {
    for (size_t i = 0; i < views.size(); ++i) {
      const View& view = views[i];
      Eigen::Matrix3d calibration;
      calibration << view.fx, 0, view.cx, 0, view.fy, view.cy, 0, 0, 1;
      const Eigen::Matrix3d matrix = calibration * view.cam_from_world_rotation;
      cameras_.push_back(
          {matrix.cast<float>(),
           (calibration * view.cam_from_world_translation).cast<float>(),
           matrix.inverse().cast<float>()});
      is_used_.emplace_back(maps[i].depths.size(), false);
    }
  }

  FusedPoints Run() {
    for (uint32_t view = 0; view < maps_.size(); ++view) {
      for (int row = 0; row < maps_[view].height; ++row) {
        for (int col = 0; col < maps_[view].width; ++col) {
          FusePixel({view, row, col, 0});
        }
      }
      is_done_[view] = true;
    }
    points_.is_outlier.resize(points_.cloud.size(), false);
    return std::move(points_);
  }

 private:
  // World point of a pixel with depth; its index is taken as its position.
  Vector3f Point(const Pixel& pixel, float depth) const {
    const Camera& camera = cameras_[pixel.view];
    return camera.world_from_image *
           (Vector3f(pixel.col * depth, pixel.row * depth, depth) -
            camera.offset);
  }

  bool Agrees(const Pixel& pixel, float depth, const Vector3f& normal) const {
    const Camera& camera = cameras_[pixel.view];
    const Vector3f p = camera.image_from_world * reference_ + camera.offset;
    const float dx = p.x() / p.z() - pixel.col;
    const float dy = p.y() / p.z() - pixel.row;
    return std::abs(p.z() - depth) <= options_.max_depth_error * depth &&
           dx * dx + dy * dy <=
               options_.max_reproj_error * options_.max_reproj_error &&
           normal.dot(reference_normal_) >= min_cos_normal_;
  }

  void FusePixel(const Pixel& reference) {
    samples_.Clear();
    queue_.assign(1, reference);
    while (!queue_.empty()) {
      const Pixel pixel = queue_.back();
      queue_.pop_back();
      const DepthMap& map = maps_[pixel.view];
      const size_t index = map.Index(pixel.row, pixel.col);
      const float depth = map.depths[index];
      if (is_used_[pixel.view][index] || depth <= 0) {
        continue;
      }
      const Vector3f& normal = map.normals[index];
      if (pixel.depth == 0) {
        reference_ = Point(pixel, depth);
        reference_normal_ = normal;
      } else if (!Agrees(pixel, depth, normal)) {
        continue;
      }
      is_used_[pixel.view][index] = true;
      const Vector3f point = Point(pixel, depth);
      AddSample(pixel, point, normal);
      if (pixel.depth + 1 < kMaxTraversalDepth) {
        Enqueue(pixel, point);
      }
    }
    if (samples_.size() >= static_cast<size_t>(options_.min_num_pixels)) {
      AddPoint();
    }
  }

  void Enqueue(const Pixel& from, const Vector3f& point) {
    for (const uint32_t view : neighbors_[from.view]) {
      if (is_done_[view]) {
        continue;
      }
      const Camera& camera = cameras_[view];
      const Vector3f p = camera.image_from_world * point + camera.offset;
      if (p.z() <= 0) {
        continue;
      }
      const float col = std::round(p.x() / p.z());
      const float row = std::round(p.y() / p.z());
      if (col >= 0 && row >= 0 && col < maps_[view].width &&
          row < maps_[view].height) {
        queue_.push_back({view, static_cast<int>(row), static_cast<int>(col),
                          from.depth + 1});
      }
    }
  }

  void AddSample(const Pixel& pixel, const Vector3f& point,
                 const Vector3f& normal) {
    for (int i = 0; i < 3; ++i) {
      samples_.values[i].push_back(point[i]);
      samples_.values[3 + i].push_back(normal[i]);
      if (!images_.empty()) {
        samples_.values[6 + i].push_back(
            images_[pixel.view].At(pixel.row, pixel.col)[i]);
      }
    }
    samples_.views.push_back(pixel.view);
  }

  void AddPoint() {
    PointCloud& cloud = points_.cloud;
    cloud.positions.push_back(samples_.MedianOf(0));
    points_.normals.push_back(samples_.MedianOf(3).normalized());
    if (!images_.empty()) {
      const Vector3f color = samples_.MedianOf(6);
      cloud.colors.push_back({static_cast<uint8_t>(std::lround(color[0])),
                              static_cast<uint8_t>(std::lround(color[1])),
                              static_cast<uint8_t>(std::lround(color[2]))});
    }
    SortUnique(&samples_.views);
    cloud.views.AddRow(samples_.views);
  }

  static constexpr int kMaxTraversalDepth = 100;

  const std::vector<DepthMap>& maps_;
  const std::vector<ColorImage>& images_;
  const FusionOptions& options_;
  const float min_cos_normal_;
  const std::vector<std::vector<uint32_t>> neighbors_;
  std::vector<Camera> cameras_;
  std::vector<char> is_done_;               // [views]
  std::vector<std::vector<char>> is_used_;  // [views][pixels]
  std::vector<Pixel> queue_;
  Samples samples_;
  Vector3f reference_, reference_normal_;
  FusedPoints points_;
};

constexpr int kMaxClump = 6;         // points
constexpr double kMeanError = 0.03;  // relative to the depth
constexpr float kSpread = 3;         // of a clump, px

// Two to four of a point's views, adjacent in its list.
std::vector<uint32_t> SomeViews(std::span<const uint32_t> views,
                                uint64_t hash) {
  const size_t count = std::min<size_t>(views.size(), 2 + Hash(hash, 1) % 3);
  const size_t first = Hash(hash, 2) % (views.size() - count + 1);
  return {views.begin() + first, views.begin() + first + count};
}

}  // namespace

FusedPoints FuseDepthMaps(const std::vector<View>& views,
                          const std::vector<DepthMap>& maps,
                          const std::vector<ColorImage>& images,
                          const FusionOptions& options) {
  return Fusion(views, maps, images, options).Run();
}

void AddOutliers(const std::vector<View>& views, double share, uint64_t seed,
                 FusedPoints* points) {
  PointCloud& cloud = points->cloud;
  const size_t num_points = cloud.size();
  const size_t num_outliers = std::llround(share * num_points);
  uint64_t clump = 0;
  while (num_points > 0 && cloud.size() < num_points + num_outliers) {
    const uint64_t hash = Hash(seed, 20, clump++);
    const size_t source = Hash(hash, 3) % num_points;
    const std::vector<uint32_t> seen_by = SomeViews(cloud.views[source], hash);
    // A false match moves a point along a ray, to either side.
    const View& view = views[seen_by[0]];
    const Vector3f center = view.Center().cast<float>();
    const Vector3f ray = cloud.positions[source] - center;
    const double error = -kMeanError * std::log(1 - Uniform(Hash(hash, 4)));
    const float factor = Hash(hash, 5) % 2 == 0 ? 1 + error : 1 - error / 2;
    const float spread = kSpread * ray.norm() / static_cast<float>(view.fx);
    const int num_clump = 1 + Hash(hash, 6) % kMaxClump;
    for (int i = 0; i < num_clump && cloud.size() < num_points + num_outliers;
         ++i) {
      const Vector3f jitter(Gaussian(Hash(hash, 7, i, 0)),
                            Gaussian(Hash(hash, 7, i, 1)),
                            Gaussian(Hash(hash, 7, i, 2)));
      cloud.positions.push_back(center + factor * ray + spread * jitter);
      if (!cloud.colors.empty()) {
        cloud.colors.push_back(Color(cloud.colors[source]));
      }
      points->normals.push_back(Vector3f(points->normals[source]));
      points->is_outlier.push_back(true);
      cloud.views.AddRow(seen_by);
    }
  }
}

}  // namespace colmap_ext::synthetic
