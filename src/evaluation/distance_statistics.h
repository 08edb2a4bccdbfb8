#pragma once

#include <cstddef>
#include <vector>

namespace colmap_ext {

// What many distances amount to; all NaN where there are none.
struct DistanceStatistics {
  size_t num_samples = 0;  // that were measured
  size_t num_beyond = 0;   // of them at the maximum distance or beyond
  double mean = 0;         // scene units
  double median = 0;       // of an even number: the mean of the middle two
  double percentile90 = 0;
};

// \param max_distance  at which the distances are clipped: those beyond have
//        this very value.
// \param drop_beyond   leave those out, as DTU's own evaluation does, which
//        spares a surface that is far off or not there at all; else they count
//        as the maximum distance.
DistanceStatistics Summarize(std::vector<double> distances, double max_distance,
                             bool drop_beyond);

}  // namespace colmap_ext
