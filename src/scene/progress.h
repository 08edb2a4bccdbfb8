#pragma once

#include <functional>
#include <string_view>

namespace colmap_ext {

// Told of long work as it goes: the stage at hand, and the share of it that is
// done, 0 ... 1. Every stage starts with a call of its own with share 0; a
// stage ends where the next one starts, or with the work. Called by one thread
// at a time. May be empty.
using Progress = std::function<void(std::string_view stage, double share)>;

inline void Report(const Progress& progress, std::string_view stage,
                   double share) {
  if (progress) {
    progress(stage, share);
  }
}

}  // namespace colmap_ext
