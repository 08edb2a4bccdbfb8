#pragma once

#include <functional>
#include <string_view>

namespace colmap_ext {

// Called with a stage and its share done, 0 ... 1. Each stage starts with a
// call of share 0 and ends with the next stage, or with the work. Never called
// by two threads at once. May be empty.
using Progress = std::function<void(std::string_view stage, double share)>;

inline void Report(const Progress& progress, std::string_view stage,
                   double share) {
  if (progress) {
    progress(stage, share);
  }
}

}  // namespace colmap_ext
