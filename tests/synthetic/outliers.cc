#include <algorithm>
#include <cmath>

#include "tests/synthetic/fuse.h"
#include "tests/synthetic/noise.h"

namespace colmap_ext::synthetic {
namespace {

using Eigen::Vector3f;

constexpr int kMaxClump = 6;         // points
constexpr double kMeanError = 0.03;  // relative to the depth
constexpr float kSpread = 3;         // of a clump, px

// Up to four of a point's views, neighbours in its list, at least two.
std::vector<uint32_t> SomeViews(std::span<const uint32_t> views,
                                uint64_t hash) {
  const size_t count = std::min<size_t>(views.size(), 2 + Hash(hash, 1) % 3);
  const size_t first = Hash(hash, 2) % (views.size() - count + 1);
  return {views.begin() + first, views.begin() + first + count};
}

}  // namespace

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
      cloud.views.values.insert(cloud.views.values.end(), seen_by.begin(),
                                seen_by.end());
      cloud.views.EndRow();
    }
  }
}

}  // namespace colmap_ext::synthetic
