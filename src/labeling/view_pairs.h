#pragma once

#include <algorithm>
#include <compare>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "base/indices.h"
#include "base/rows.h"
#include "mesh/triangle_mesh.h"
#include "scene/point_cloud.h"
#include "scene/view.h"

namespace colmap_ext {

// Two views that are compared, first < second.
struct ViewPair {
  uint32_t first = 0;
  uint32_t second = 0;

  // NOLINTNEXTLINE(modernize-use-nullptr)
  auto operator<=>(const ViewPair&) const = default;
};

// For each view the pairs with the views that it shares the most points with
// (docs/method.md, section 4.1; L^simpl of [Romanoni2020, section V]): each
// pair once, ascending. Ties go to the lower view; views that share no point
// are never a pair.
// \param points  whose views are indices below num_views.
// \param partners_per_view  at most as many for each view; it can be in more
//        pairs. [Romanoni2020] has 2.
std::vector<ViewPair> SelectViewPairs(const PointCloud& points,
                                      size_t num_views, int partners_per_view);

// The directions of a pair: in which of its views it is compared, the other
// one's image being warped there. A direction's index among those of all pairs
// is twice the pair's, and one more for the second view.
enum Directions : uint8_t { kInFirst = 1, kInSecond = 2, kBothDirections = 3 };

// By which pairs of views each facet is refined: one or several labels a facet,
// or none (docs/method.md, section 4; [Romanoni2020, section V]).
struct FacetLabels {
  std::vector<ViewPair> pairs;  // [L], ascending
  Rows<uint32_t> labels;  // [F] indices into pairs, the best first, no repeats
  std::vector<uint8_t> directions;  // of labels.values; empty: all both

  size_t NumFacets() const { return labels.size(); }

  // [F] the best label of each facet; -1: none.
  std::vector<int32_t> BestLabels() const {
    std::vector<int32_t> best;
    for (size_t i = 0; i < NumFacets(); ++i) {
      best.push_back(labels[i].empty() ? -1
                                       : static_cast<int32_t>(labels[i][0]));
    }
    return best;
  }

  // The largest number of labels that a facet has.
  size_t MaxLabelsOfFacet() const {
    size_t count = 0;
    for (size_t i = 0; i < NumFacets(); ++i) {
      count = std::max(count, labels[i].size());
    }
    return count;
  }

  // Calls function(direction) for the directions of a facet's labels.
  template <typename Function>
  void ForEachDirection(size_t facet, const Function& function) const {
    for (uint64_t i = labels.offsets[facet]; i < labels.offsets[facet + 1];
         ++i) {
      const uint8_t chosen =
          directions.empty() ? uint8_t{kBothDirections} : directions[i];
      if ((chosen & kInFirst) != 0) {
        function(2 * labels.values[i]);
      }
      if ((chosen & kInSecond) != 0) {
        function(2 * labels.values[i] + 1);
      }
    }
  }

  // The same with at most the first `count` labels of each facet, each in both
  // directions.
  FacetLabels Truncated(size_t count) const {
    const auto append = [&](size_t i, std::vector<uint32_t>* all) {
      Append(labels[i].first(std::min(count, labels[i].size())), all);
    };
    return {pairs, MakeRows<uint32_t>(NumFacets(), append), {}};
  }

  // Those of other facets that come from these.
  // \param sources  the facet that each comes from; not below F: from none, and
  //        it has no label.
  FacetLabels Remapped(const std::vector<uint32_t>& sources) const {
    FacetLabels from{pairs, {}, {}};
    for (const uint32_t source : sources) {
      from.labels.AddRow(source < NumFacets() ? labels[source]
                                              : std::span<const uint32_t>());
    }
    return from;
  }

  // Drops the labels of the other facets. Those that stay are compared in both
  // directions.
  // \param is_chosen [F]
  void KeepOf(const std::vector<uint8_t>& is_chosen) {
    EditRows(
        [&](size_t i, auto row) {
          return std::optional(is_chosen[i] != 0 ? row.size() : 0);
        },
        &labels);
    directions.clear();
  }
};

// The same labels, each compared in one direction only: in the view that shows
// the facet smaller. The other view's samples lie at least a pixel apart then;
// the other way round, one pixel of the smaller view would count several times
// (docs/method.md, section 7.3).
// \param views  of any level
FacetLabels InSmallerView(FacetLabels labels, const TriangleMesh& mesh,
                          const std::vector<View>& views);

}  // namespace colmap_ext
