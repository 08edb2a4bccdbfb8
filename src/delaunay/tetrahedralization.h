#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <vector>

#include <Eigen/Core>

#include "base/indices.h"
#include "scene/progress.h"
#include "spatial/predicates.h"

namespace colmap_ext {

// The vertex at infinity, which closes the hull: every facet of the hull and
// this vertex make an infinite cell.
inline constexpr uint32_t kInfiniteVertex = UINT32_MAX;

// Corners of a cell's facet i, the one opposite to its corner i. Their normal
// (right-handed) points into the cell.
inline constexpr std::array<std::array<int, 3>, 4> kFacetCorners = {
    {{{1, 3, 2}}, {{0, 2, 3}}, {{0, 3, 1}}, {{0, 1, 2}}}};

// The index of a value among four that differ. Without branches, which would be
// unpredictable.
// \pre it is one of them
inline uint32_t PlaceOf(uint32_t value, const std::array<uint32_t, 4>& values) {
  return static_cast<uint32_t>(values[1] == value) +
         2 * static_cast<uint32_t>(values[2] == value) +
         3 * static_cast<uint32_t>(values[3] == value);
}

// A tetrahedralization of points in flat arrays. Cells are positively oriented:
// det(v1 - v0, v2 - v0, v3 - v0) > 0, for infinite cells with the infinite
// vertex beyond the hull.
struct Tetrahedralization {
  struct alignas(32) Cell {
    std::array<uint32_t, 4> vertices;   // index into points, or kInfiniteVertex
    std::array<uint32_t, 4> neighbors;  // [i]: the cell opposite to vertex i

    bool operator==(const Cell&) const = default;
  };

  std::vector<Eigen::Vector3f> points;  // [V], world frame
  std::vector<Cell> cells;              // [C], finite and infinite
  std::vector<uint32_t> vertex_cells;   // [V], a finite cell of each vertex

  bool IsInfinite(uint32_t cell) const {
    const auto& v = cells[cell].vertices;
    return v[0] == kInfiniteVertex || v[1] == kInfiniteVertex ||
           v[2] == kInfiniteVertex || v[3] == kInfiniteVertex;
  }

  Eigen::Vector3d PositionOf(uint32_t vertex) const {
    return points[vertex].cast<double>();
  }

  // Which corner of the cell the vertex is.
  // \pre it is one of them
  uint32_t IndexOf(uint32_t cell, uint32_t vertex) const {
    return PlaceOf(vertex, cells[cell].vertices);
  }

  // Which facet of the cell leads to the neighbor.
  // \pre it is one of them
  uint32_t FacetTo(uint32_t cell, uint32_t neighbor) const {
    return PlaceOf(neighbor, cells[cell].neighbors);
  }

  bool operator==(const Tetrahedralization&) const = default;
};

// The vertices of a cell's facet i, see kFacetCorners.
inline std::array<uint32_t, 3> FacetVertices(
    const Tetrahedralization::Cell& cell, size_t i) {
  const auto& [a, b, c] = kFacetCorners[i];
  return {cell.vertices[a], cell.vertices[b], cell.vertices[c]};
}

// A facet's vertices, rotated so that the one at the lowest position is first:
// rounding then does not depend on how they are numbered.
inline std::array<uint32_t, 3> FromLowest(const Tetrahedralization& tetrahedra,
                                          std::array<uint32_t, 3> facet) {
  const auto position = [&](uint32_t vertex) -> const Eigen::Vector3f& {
    return tetrahedra.points[vertex];
  };
  std::rotate(facet.begin(), std::ranges::min_element(facet, IsLower, position),
              facet.end());
  return facet;
}

// Sorts a cell's vertices, and what belongs to its corners with them, so that
// the first two are the lowest and the cell keeps its orientation.
void SortCorners(std::array<uint32_t, 4>* vertices,
                 std::array<uint32_t, 4>* of_corners);

// The capacity to reserve for arrays of cells, with space for the cells that
// SplitCell appends; otherwise the first of them would copy the arrays. About
// 1e-4 of all cells are split (fountain); reserved but unused capacity costs no
// memory.
inline size_t WithSpareCells(size_t num_cells) {
  return num_cells + num_cells / 64;
}

// All cells around a vertex, in an order that depends on the tetrahedralization
// alone.
void IncidentCells(const Tetrahedralization& tetrahedra, uint32_t vertex,
                   std::vector<uint32_t>* cells);

// Of them the expected noise of points follows, as in COLMAP's delaunay_mesher.
inline constexpr double kSigmaPercentile = 25;

// The lengths of all finite edges, each once, in no particular order.
// \param is_left_out [V] 1: edges of the vertex do not count; empty: all do
std::vector<float> EdgeLengths(const Tetrahedralization& tetrahedra,
                               const std::vector<uint8_t>& is_left_out = {});

// Delaunay tetrahedralization of points, inserted in parallel in a biased
// randomized order [Amenta2003]. Cells are numbered along a space-filling
// curve. The result does not depend on the number of threads.
//
// \param points  distinct and finite; fastest along the curve, as ThinPoints()
//        has them
// \throw std::invalid_argument where the points do not span a volume, or are
//        too many for 32-bit cell indices.
Tetrahedralization Tetrahedralize(std::vector<Eigen::Vector3f> points,
                                  const Progress& progress = {});

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
