#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

namespace colmap_ext {

// Rows of different lengths, stored one after the other (compressed sparse
// rows): row i is values[offsets[i] ... offsets[i + 1]).
template <typename T>
struct Rows {
  std::vector<uint64_t> offsets{0};  // [rows + 1], into values, ascending
  std::vector<T> values;

  Rows() = default;

  // \pre row_offsets starts with 0 and ends with row_values.size()
  Rows(std::vector<uint64_t> row_offsets, std::vector<T> row_values)
      : offsets(std::move(row_offsets)), values(std::move(row_values)) {}

  // That many empty rows.
  explicit Rows(size_t num_rows) : offsets(num_rows + 1, 0) {}

  size_t size() const { return offsets.size() - 1; }

  std::span<const T> operator[](size_t row) const {
    return {values.data() + offsets[row], values.data() + offsets[row + 1]};
  }

  std::span<T> operator[](size_t row) {
    return {values.data() + offsets[row], values.data() + offsets[row + 1]};
  }

  // Room for that many rows and values in all.
  void Reserve(size_t num_rows, size_t num_values) {
    offsets.reserve(num_rows + 1);
    values.reserve(num_values);
  }

  // Makes a row of the values added since the last one.
  void EndRow() { offsets.push_back(values.size()); }

  template <typename Range>
  void AddRow(const Range& row) {
    values.insert(values.end(), std::begin(row), std::end(row));
    EndRow();
  }

  bool operator==(const Rows&) const = default;
};

}  // namespace colmap_ext
