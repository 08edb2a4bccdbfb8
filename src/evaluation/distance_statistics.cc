#include "evaluation/distance_statistics.h"

#include <algorithm>
#include <limits>
#include <numeric>

#include "base/percentile.h"

namespace colmap_ext {

DistanceStatistics Summarize(std::vector<double> distances, double max_distance,
                             bool drop_beyond) {
  DistanceStatistics statistics;
  statistics.num_samples = distances.size();
  std::sort(distances.begin(), distances.end());
  const auto beyond =
      std::lower_bound(distances.begin(), distances.end(), max_distance);
  statistics.num_beyond = static_cast<size_t>(distances.end() - beyond);
  if (drop_beyond) {
    distances.erase(beyond, distances.end());
  }
  if (distances.empty()) {
    statistics.mean = statistics.median = statistics.percentile90 =
        std::numeric_limits<double>::quiet_NaN();
    return statistics;
  }
  // In the order of their sizes, whatever that of the samples was.
  statistics.mean = std::accumulate(distances.begin(), distances.end(), 0.0) /
                    static_cast<double>(distances.size());
  statistics.median = Median(&distances);
  statistics.percentile90 = InterpolatedPercentile(90, &distances);
  return statistics;
}

}  // namespace colmap_ext
