#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "labeling/facet_labels.h"
#include "mesh/triangle_mesh.h"
#include "mesh/vertex_attributes.h"
#include "raster/facet_visibility.h"
#include "scene/view.h"

namespace colmap_ext {

enum class PairSelection {
  kFacetwise,  // each facet by its best pairs (the paper)
  kClassical,  // each facet by every pair that sees it (Vu 2012)
};

// A pair of views that a facet can be refined by.
struct CandidatePair {
  uint32_t label = 0;  // index of the pair
  float cost = 0;
};

// The pairs of views that see a facet, and what they cost: see LabelFacets.
class CandidatePairs {
 public:
  // References are kept.
  CandidatePairs(const TriangleMesh& mesh, const VertexAttributes& attributes,
                 const std::vector<ViewPair>& pairs,
                 const FacetVisibility& visibility,
                 const std::vector<View>& views, PairSelection selection);

  // Ascending labels. Costs are -log(O_f / |nu_f|).
  std::vector<CandidatePair> Find(size_t facet) const;

  // Adds -1/2 log(q / q_max) to the costs.
  void AddInformation(size_t facet,
                      std::vector<CandidatePair>* candidates) const;

 private:
  PairSelection selection_;
  const TriangleMesh& mesh_;
  const std::vector<View>& views_;
  const VertexAttributes& attributes_;
  const std::vector<ViewPair>& pairs_;
  const FacetVisibility& visibility_;
  // The pairs that each view is the first of: [views + 1] into pairs_.
  std::vector<uint32_t> first_pairs_;
};

}  // namespace colmap_ext
