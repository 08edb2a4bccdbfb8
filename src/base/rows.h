#pragma once

#include <algorithm>
#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <numeric>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include <tbb/parallel_for.h>

#include "base/indices.h"

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

// Makes rows of values that come in any order, by a counting sort.
// \param for_each  calls the function that it gets with the row and the value
//        of each; called twice, and must do the same each time. The values of a
//        row keep their order.
template <typename T, typename ForEach>
Rows<T> GroupInRows(size_t num_rows, const ForEach& for_each) {
  Rows<T> rows(num_rows + 1);
  std::vector<uint64_t>& offsets = rows.offsets;
  for_each([&](size_t row, const T&) { ++offsets[row + 2]; });
  std::partial_sum(offsets.begin(), offsets.end(), offsets.begin());
  rows.values.resize(offsets.back());
  // Where a row begins, which becomes its end as it is filled.
  for_each([&](size_t row, const T& value) {
    rows.values[offsets[row + 1]++] = value;
  });
  offsets.pop_back();
  return rows;
}

// Rows of the numbers 0 ... num_values - 1, ascending, made in parallel.
// \param row_of  of a number; kNone: it is left out
template <typename RowOf>
Rows<uint32_t> NumbersInRows(size_t num_rows, size_t num_values,
                             const RowOf& row_of) {
  Rows<uint32_t> rows(num_rows);
  std::vector<uint64_t>& offsets = rows.offsets;
  const auto for_each = [&](const auto& add) {
    tbb::parallel_for(size_t{0}, num_values, [&](size_t i) {
      const uint32_t row = row_of(static_cast<uint32_t>(i));
      if (row != kNone) {
        add(std::atomic_ref(offsets[row]), static_cast<uint32_t>(i));
      }
    });
  };
  for_each([](auto offset, uint32_t) {
    offset.fetch_add(1, std::memory_order_relaxed);
  });
  std::partial_sum(offsets.begin(), offsets.end(), offsets.begin());
  rows.values.resize(offsets.back());
  // Each offset is the end of its row, and its begin once the row is filled.
  for_each([&](auto offset, uint32_t value) {
    rows.values[offset.fetch_sub(1, std::memory_order_relaxed) - 1] = value;
  });
  tbb::parallel_for(size_t{0}, num_rows,
                    [&](size_t row) { std::ranges::sort(rows[row]); });
  return rows;
}

// Concatenates rows.
template <typename T>
Rows<T> JoinRows(std::vector<Rows<T>> parts) {
  std::vector<std::array<size_t, 2>> begins{{0, 0}};  // rows, values
  for (const Rows<T>& part : parts) {
    const auto [row, value] = begins.back();
    begins.push_back({row + part.size(), value + part.values.size()});
  }
  Rows<T> all(begins.back()[0]);
  all.values.resize(begins.back()[1]);
  tbb::parallel_for(size_t{0}, parts.size(), [&](size_t k) {
    const auto [row, value] = begins[k];
    for (size_t i = 1; i <= parts[k].size(); ++i) {
      all.offsets[row + i] = value + parts[k].offsets[i];
    }
    std::ranges::copy(parts[k].values, all.values.data() + value);
    parts[k] = {};
  });
  return all;
}

// Makes rows in parallel.
// \param append  append(row, &values) appends the values of a row to others
template <typename T, typename AppendRow>
Rows<T> MakeRows(size_t num_rows, const AppendRow& append) {
  constexpr size_t kGrain = 4096;  // rows a task; a choice
  std::vector<Rows<T>> parts((num_rows + kGrain - 1) / kGrain);
  tbb::parallel_for(size_t{0}, parts.size(), [&](size_t k) {
    const size_t end = std::min(num_rows, (k + 1) * kGrain);
    for (size_t row = k * kGrain; row < end; ++row) {
      append(row, &parts[k].values);
      parts[k].EndRow();
    }
  });
  return JoinRows(std::move(parts));
}

// Shortens or drops rows in place.
// \param edit  takes a row's index and values, which it may reorder; returns
//        how many of the first ones stay; nothing to drop the row. Called for
//        each row in turn.
template <typename T, typename Edit>
void EditRows(Edit edit, Rows<T>* rows) {
  size_t num_rows = 0;
  uint64_t num_values = 0;
  uint64_t begin = 0;
  for (size_t i = 0; i < rows->size(); ++i) {
    const uint64_t end = rows->offsets[i + 1];
    const std::span<T> row(rows->values.data() + begin, end - begin);
    begin = end;
    const std::optional<size_t> size = edit(i, row);
    if (!size) {
      continue;
    }
    // What stays never lies behind where it came from.
    std::copy_n(row.begin(), *size,
                rows->values.begin() + static_cast<std::ptrdiff_t>(num_values));
    num_values += *size;
    rows->offsets[++num_rows] = num_values;
  }
  rows->offsets.resize(num_rows + 1);
  rows->values.resize(num_values);
}

}  // namespace colmap_ext
