#pragma once

#include <cstdint>
#include <random>
#include <utility>
#include <vector>

#include "base/indices.h"

namespace colmap_ext {

// Seeded random numbers that are the same with every standard library.
class Random {
 public:
  explicit Random(uint64_t seed) : engine_(seed) {}

  // Uniform in 0 ... n - 1.
  // \pre n fits in 32 bits
  uint32_t Below(size_t n) {
    return static_cast<uint32_t>((engine_() >> 32) * n >> 32);
  }

  // Uniform in first ... last.
  int Integer(int first, int last) {
    return first +
           static_cast<int>(Below(static_cast<size_t>(last - first + 1)));
  }

  // Uniform in [0, 1).
  double Unit() { return static_cast<double>(engine_() >> 11) * 0x1p-53; }

  // Uniform in [low, high).
  float Between(float low, float high) {
    return low + (high - low) * static_cast<float>(Unit());
  }

  bool Chance(double probability) { return Unit() < probability; }

  template <typename T>
  void Shuffle(std::vector<T>* values) {
    for (size_t i = values->size(); i > 1; --i) {
      std::swap((*values)[i - 1], (*values)[Below(i)]);
    }
  }

  // Of 0 ... size - 1.
  std::vector<uint32_t> Permutation(size_t size) {
    std::vector<uint32_t> numbers = Iota(size);
    Shuffle(&numbers);
    return numbers;
  }

 private:
  std::mt19937_64 engine_;
};

}  // namespace colmap_ext
