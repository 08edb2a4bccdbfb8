#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

#include "base/rows.h"

namespace colmap_ext {

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
