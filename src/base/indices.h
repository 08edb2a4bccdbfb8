#pragma once

#include <algorithm>
#include <cstdint>
#include <functional>
#include <iterator>
#include <numeric>
#include <stdexcept>
#include <string>
#include <vector>

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

// The numbers first ... first + size - 1.
inline std::vector<uint32_t> Iota(size_t size, uint32_t first = 0) {
  std::vector<uint32_t> numbers(size);
  std::iota(numbers.begin(), numbers.end(), first);
  return numbers;
}

// Appends values to others.
template <typename Range, typename T>
void Append(const Range& values, std::vector<T>* all) {
  all->insert(all->end(), std::begin(values), std::end(values));
}

// Appends the value at an index to others, if there are values.
template <typename T>
void AppendIfAny(const std::vector<T>& values, size_t index,
                 std::vector<T>* all) {
  if (!values.empty()) {
    all->push_back(values[index]);
  }
}

// Sorts values and drops those that repeat another one.
template <typename T>
void SortUnique(std::vector<T>* values) {
  std::ranges::sort(*values);
  values->erase(std::unique(values->begin(), values->end()), values->end());
}

// The index of a value in an ascending list, or kNone.
// \param key_of  what the list ascends in
template <typename Values, typename Key, typename KeyOf = std::identity>
uint32_t IndexOf(const Values& values, const Key& key,
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
