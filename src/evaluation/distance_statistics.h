#pragma once

#include <cstddef>
#include <vector>

namespace colmap_ext {

// Of no distances, mean, median and percentile are NaN.
struct DistanceStatistics {
  size_t num_samples = 0;   // all that were measured
  size_t num_beyond = 0;    // of them, at the maximum distance or beyond
  double mean = 0;          // scene units
  double median = 0;        // of an even number: the mean of the middle two
  double percentile90 = 0;  // interpolated
};

// \param distances     scene units, clipped at max_distance already
// \param max_distance  scene units
// \param drop_beyond   leaves out distances of max_distance, as DTU's own
//        evaluation does, which spares a surface that is far off or missing
DistanceStatistics Summarize(std::vector<double> distances, double max_distance,
                             bool drop_beyond);

}  // namespace colmap_ext
