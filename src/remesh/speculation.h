#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include <tbb/parallel_for.h>

namespace colmap_ext {

// The vertices near which a mesh has changed since the last Clear().
class ChangedVertices {
 public:
  explicit ChangedVertices(size_t num_vertices) : stamps_(num_vertices, 0) {}

  void Clear() { ++stamp_; }
  void Mark(uint32_t vertex) { stamps_[vertex] = stamp_; }
  bool AnyOf(std::span<const uint32_t> vertices) const {
    return std::ranges::any_of(
        vertices, [&](uint32_t vertex) { return stamps_[vertex] == stamp_; });
  }

 private:
  std::vector<uint32_t> stamps_;  // [V]
  uint32_t stamp_ = 1;
};

// Applies operations to a mesh one after the other, as
//   for (i = 0; i < count; ++i) if (plan = propose(i)) apply(*plan);
// would, but makes many plans in parallel before the first of them is applied;
// those near which the mesh has changed since are made again.
//
// \param propose  size_t -> std::optional<Plan>; changes nothing
// \param corners  size_t -> the vertices near which nothing may change for the
//        plan to stay as it is
// \param apply  Plan -> void; marks the corners of the plans that it outdates
// \param changed  of all the mesh's vertices
// \return the number of plans applied
template <typename Propose, typename Corners, typename Apply>
size_t ApplyInOrder(size_t count, const Propose& propose,
                    const Corners& corners, const Apply& apply,
                    ChangedVertices* changed) {
  // Enough for all threads; few enough that most plans stay as they are.
  constexpr size_t kBatch = 1024;
  std::vector<decltype(propose(0))> plans(kBatch);
  std::vector<decltype(corners(0))> vertices(kBatch);
  size_t num_applied = 0;
  for (size_t first = 0; first < count; first += kBatch) {
    const size_t size = std::min(kBatch, count - first);
    changed->Clear();
    tbb::parallel_for(size_t{0}, size, [&](size_t i) {
      plans[i] = propose(first + i);
      vertices[i] = corners(first + i);
    });
    for (size_t i = 0; i < size; ++i) {
      if (changed->AnyOf(vertices[i])) {
        plans[i] = propose(first + i);
      }
      if (plans[i]) {
        apply(*plans[i]);
        ++num_applied;
      }
    }
  }
  return num_applied;
}

}  // namespace colmap_ext
