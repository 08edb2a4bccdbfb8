#pragma once

#include <algorithm>
#include <cstdint>
#include <functional>
#include <vector>

#include "base/index_limit.h"

namespace colmap_ext {

// Sorts values and drops those that repeat another one.
template <typename T>
void SortUnique(std::vector<T>* values) {
  std::ranges::sort(*values);
  values->erase(std::unique(values->begin(), values->end()), values->end());
}

// The index of a value in an ascending list, or kNone.
// \param key_of  what the list ascends in
template <typename T, typename Key, typename KeyOf = std::identity>
uint32_t IndexOf(const std::vector<T>& values, const Key& key,
                 const KeyOf& key_of = {}) {
  const auto found = std::ranges::lower_bound(values, key, {}, key_of);
  return found != values.end() && std::invoke(key_of, *found) == key
             ? static_cast<uint32_t>(found - values.begin())
             : kNone;
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
