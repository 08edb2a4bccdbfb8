#pragma once

#include <cstdint>

namespace colmap_ext {

// Well mixed bits of an index: the generator SplitMix64 [Steele2014], which
// gives each index a number of its own, whatever the order of the calls.
inline uint64_t MixBits(uint64_t index) {
  uint64_t bits = index + 0x9e3779b97f4a7c15;
  bits = (bits ^ (bits >> 30)) * 0xbf58476d1ce4e5b9;
  bits = (bits ^ (bits >> 27)) * 0x94d049bb133111eb;
  return bits ^ (bits >> 31);
}

}  // namespace colmap_ext
