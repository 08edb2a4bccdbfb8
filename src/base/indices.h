#pragma once

#include <algorithm>
#include <cstdint>
#include <vector>

namespace colmap_ext {

// Sorts values and drops those that repeat another one.
template <typename T>
void SortUnique(std::vector<T>* values) {
  std::ranges::sort(*values);
  values->erase(std::unique(values->begin(), values->end()), values->end());
}

// The indices of what is marked, ascending.
inline std::vector<uint32_t> Marked(const std::vector<uint8_t>& is_marked) {
  std::vector<uint32_t> marked;
  for (uint32_t i = 0; i < is_marked.size(); ++i) {
    if (is_marked[i] != 0) {
      marked.push_back(i);
    }
  }
  return marked;
}

}  // namespace colmap_ext
