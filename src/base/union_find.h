#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <numeric>
#include <utility>
#include <vector>

namespace colmap_ext {

// Disjoint sets of indices. The representative of a set is its lowest index.
// Threads may join and find at the same time [Anderson1991].
class UnionFind {
 public:
  explicit UnionFind(size_t size) : parents_(size) {
    std::iota(parents_.begin(), parents_.end(), 0);
  }

  // While others join, it may have joined another set by the time it is found.
  uint32_t Find(uint32_t index) {
    for (;;) {
      const uint32_t parent = Parent(index).load(kRelaxed);
      if (parent == index) {
        return index;
      }
      const uint32_t grandparent = Parent(parent).load(kRelaxed);
      Parent(index).store(grandparent, kRelaxed);
      index = grandparent;
    }
  }

  // \return whether they were in two sets
  bool Join(uint32_t a, uint32_t b) {
    do {
      a = Find(a);
      b = Find(b);
      if (a > b) {
        std::swap(a, b);
      }
    } while (!Parent(b).compare_exchange_weak(b, a, kRelaxed));
    return a != b;
  }

 private:
  static constexpr auto kRelaxed = std::memory_order_relaxed;

  std::atomic_ref<uint32_t> Parent(uint32_t index) {
    return std::atomic_ref(parents_[index]);
  }

  std::vector<uint32_t> parents_;  // a set's lowest is its own
};

}  // namespace colmap_ext
