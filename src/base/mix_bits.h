#pragma once

#include <cstdint>

namespace colmap_ext {

// The step between the states of the generator SplitMix64: 2^64 over the golden
// ratio [Steele2014].
inline constexpr uint64_t kSplitMixStep = 0x9e3779b97f4a7c15;

// The output of SplitMix64 for a state: every bit of it depends on all bits of
// the state.
inline uint64_t MixBits(uint64_t state) {
  state = (state ^ (state >> 30)) * 0xbf58476d1ce4e5b9;
  state = (state ^ (state >> 27)) * 0x94d049bb133111eb;
  return state ^ (state >> 31);
}

}  // namespace colmap_ext
