#pragma once

#include <sys/resource.h>

#include <cstddef>

namespace colmap_ext {

// The most memory that the process had so far, bytes. ctest runs each test in
// a process of its own.
inline size_t PeakMemory() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return static_cast<size_t>(usage.ru_maxrss) * 1024;
}

}  // namespace colmap_ext
