#include "evaluation/distance_statistics.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

namespace colmap_ext {
namespace {

// Between neighbours in the order it is interpolated linearly.
// \pre values are sorted, and not empty
double Quantile(const std::vector<double>& values, double share) {
  const double position = share * static_cast<double>(values.size() - 1);
  const auto index = static_cast<size_t>(position);
  const size_t next = std::min(index + 1, values.size() - 1);
  const double weight = position - static_cast<double>(index);
  return (1 - weight) * values[index] + weight * values[next];
}

}  // namespace

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
  statistics.median = Quantile(distances, 0.5);
  statistics.percentile90 = Quantile(distances, 0.9);
  return statistics;
}

}  // namespace colmap_ext
