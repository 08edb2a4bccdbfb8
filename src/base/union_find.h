#pragma once

#include <cstddef>
#include <cstdint>
#include <numeric>
#include <utility>
#include <vector>

namespace colmap_ext {

// Disjoint sets of indices. The representative of a set is its lowest index.
class UnionFind {
 public:
  explicit UnionFind(size_t size) : parents_(size) {
    std::iota(parents_.begin(), parents_.end(), 0);
  }

  uint32_t Find(uint32_t index) {
    while (parents_[index] != index) {
      parents_[index] = parents_[parents_[index]];
      index = parents_[index];
    }
    return index;
  }

  void Join(uint32_t a, uint32_t b) {
    a = Find(a);
    b = Find(b);
    if (a > b) {
      std::swap(a, b);
    }
    parents_[b] = a;
  }

 private:
  std::vector<uint32_t> parents_;
};

}  // namespace colmap_ext
