#pragma once

#include <cstdint>
#include <stdexcept>
#include <string>

namespace colmap_ext {

// In place of an index: none.
inline constexpr uint32_t kNone = UINT32_MAX;

// How many things 32-bit indices can number.
inline constexpr uint64_t kMaxIndexed = kNone;

// Returns the count.
// \param what  is counted, for the message: "vertices".
// \throw std::invalid_argument if it is above kMaxIndexed.
inline uint32_t ExpectIndexable(uint64_t count, const char* what) {
  if (count > kMaxIndexed) {
    throw std::invalid_argument(
        "too many " + std::string(what) + " for 32-bit indices, " +
        std::to_string(count) +
        ": mesh a smaller region, or raise max_proj_dist");
  }
  return static_cast<uint32_t>(count);
}

}  // namespace colmap_ext
