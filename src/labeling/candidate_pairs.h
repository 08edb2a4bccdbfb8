#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "base/rows.h"
#include "labeling/facet_labels.h"
#include "mesh/triangle_mesh.h"
#include "mesh/vertex_attributes.h"
#include "raster/visibility_buffers.h"
#include "scene/view.h"

namespace colmap_ext {

enum class PairSelection {
  kFacetwise,  // each facet by its best pairs [Romanoni2020, section V]
  kClassical,  // each facet by every pair that sees it [Vu2012]
};

// A pair of views that a facet can be refined by.
struct CandidatePair {
  uint32_t label = 0;  // index of the pair
  float cost = 0;      // negative logarithm of a share
};

// The pairs of views that can refine a facet, and what they cost as its label
// (docs/method.md, section 4.3).
class CandidatePairs {
 public:
  // All but the selection are kept by reference.
  // \param pairs  ascending.
  // \param views  of the images' sizes.
  CandidatePairs(const TriangleMesh& mesh, const VertexAttributes& attributes,
                 const std::vector<ViewPair>& pairs,
                 const FacetVisibility& visibility,
                 const std::vector<View>& views, PairSelection selection);

  // Ascending labels. Costs are -log(O_f / |nu_f|). If no pair occurs in nu_f,
  // or with kClassical, all pairs that see the facet, of cost 0.
  std::vector<CandidatePair> Find(size_t facet) const;

  // Adds -1/2 log(Q / Q_max) to the costs.
  void AddInformation(size_t facet,
                      std::vector<CandidatePair>* candidates) const;

 private:
  // How often the views that see a facet occur in the lists of its vertices.
  struct Occurrences {
    size_t num_views = 0;          // |nu_f|
    std::vector<uint32_t> counts;  // of the views that see the facet
  };

  Occurrences CountOccurrences(size_t facet) const;
  // Calls function(pair, i, j) for each pair that sees a facet, ascending: its
  // views are the i-th and the j-th that see it.
  template <typename Function>
  void ForEachSeeing(size_t facet, const Function& function) const;

  PairSelection selection_;
  const TriangleMesh& mesh_;
  const std::vector<View>& views_;
  const VertexAttributes& attributes_;
  const std::vector<ViewPair>& pairs_;
  const FacetVisibility& visibility_;
  Rows<uint32_t> pairs_of_;  // [views] that each view is the first of
};

}  // namespace colmap_ext
