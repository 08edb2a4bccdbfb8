#pragma once

#include <algorithm>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <vector>

#include "base/index_limit.h"

namespace colmap_ext {

// Where keys stand in a list that grows: a table of open addresses, which keeps
// its memory from one list to the next.
template <typename Key, typename Hash>
class PlaceTable {
 public:
  PlaceTable() { Clear(); }

  // For a new list, that is empty.
  void Clear() { Resize(kMinSlots); }

  // The place of a key, which is appended where it is not there yet.
  // \pre the list is the one of the calls since Clear()
  uint32_t PlaceIn(const Key& key, std::vector<Key>* keys) {
    uint32_t* slot = &slots_[SlotOf(key, *keys)];
    if (*slot != kNone) {
      return *slot;
    }
    const auto place = static_cast<uint32_t>(keys->size());
    *slot = place;
    keys->push_back(key);
    if (2 * keys->size() > num_slots_) {
      Resize(2 * num_slots_);
      for (uint32_t i = 0; i <= place; ++i) {
        slots_[SlotOf((*keys)[i], *keys)] = i;
      }
    }
    return place;
  }

  bool Contains(const Key& key, const std::vector<Key>& keys) const {
    return slots_[SlotOf(key, keys)] != kNone;
  }

 private:
  static constexpr size_t kMinSlots = 128;  // for twice the usual star

  // \param num_slots  a power of two
  void Resize(size_t num_slots) {
    num_slots_ = num_slots;
    slots_.resize(std::max(slots_.size(), num_slots));
    std::fill_n(slots_.begin(), num_slots, kNone);
  }

  // That of the key, or the free one where it belongs.
  size_t SlotOf(const Key& key, const std::vector<Key>& keys) const {
    // Fibonacci hashing: the upper bits of the product are the mixed ones.
    size_t slot = (Hash()(key) * 0x9e3779b97f4a7c15u) >>
                  (64 - std::countr_zero(num_slots_));
    while (slots_[slot] != kNone && keys[slots_[slot]] != key) {
      slot = (slot + 1) & (num_slots_ - 1);
    }
    return slot;
  }

  std::vector<uint32_t> slots_;  // places; the first num_slots_ are used
  size_t num_slots_ = 0;
};

using CellPlaces = PlaceTable<uint32_t, std::identity>;

// All cells around a vertex, in an order that depends on the first alone.
// \param first    one of them
// \param cell_at  returns a cell, a Tetrahedralization::Cell
template <typename CellAt>
void CollectStar(uint32_t vertex, uint32_t first, const CellAt& cell_at,
                 std::vector<uint32_t>* cells) {
  thread_local CellPlaces places;
  places.Clear();
  cells->clear();
  places.PlaceIn(first, cells);
  for (size_t i = 0; i < cells->size(); ++i) {
    const auto& cell = cell_at((*cells)[i]);
    for (int k = 0; k < 4; ++k) {
      if (cell.vertices[k] != vertex) {
        places.PlaceIn(cell.neighbors[k], cells);
      }
    }
  }
}

}  // namespace colmap_ext
