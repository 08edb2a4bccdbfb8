#pragma once

#include <algorithm>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "base/index_limit.h"

namespace colmap_ext {

// Where cells stand in a list that grows: a table of open addresses, which
// keeps its memory from one list to the next.
class CellPlaces {
 public:
  // For a new list, that is empty.
  void Clear() { Resize(kMinSlots); }

  // The place of a cell, which is appended where it is not there yet.
  // \pre the list is the one of the calls since Clear()
  uint32_t PlaceIn(uint32_t cell, std::vector<uint32_t>* cells) {
    uint32_t* slot = SlotOf(cell, *cells);
    if (*slot != kNone) {
      return *slot;
    }
    const auto place = static_cast<uint32_t>(cells->size());
    *slot = place;
    cells->push_back(cell);
    if (2 * cells->size() > num_slots_) {
      Resize(2 * num_slots_);
      for (uint32_t i = 0; i <= place; ++i) {
        *SlotOf((*cells)[i], *cells) = i;
      }
    }
    return place;
  }

 private:
  static constexpr size_t kMinSlots = 128;  // for twice the usual star

  // \param num_slots  a power of two
  void Resize(size_t num_slots) {
    num_slots_ = num_slots;
    slots_.resize(std::max(slots_.size(), num_slots));
    std::fill_n(slots_.begin(), num_slots, kNone);
  }

  // That of the cell, or the free one where it belongs.
  uint32_t* SlotOf(uint32_t cell, const std::vector<uint32_t>& cells) {
    // Fibonacci hashing: the upper bits of the product are the mixed ones.
    size_t slot =
        (cell * 0x9e3779b97f4a7c15u) >> (64 - std::countr_zero(num_slots_));
    while (slots_[slot] != kNone && cells[slots_[slot]] != cell) {
      slot = (slot + 1) & (num_slots_ - 1);
    }
    return &slots_[slot];
  }

  std::vector<uint32_t> slots_;  // places; the first num_slots_ are used
  size_t num_slots_ = 0;
};

}  // namespace colmap_ext
