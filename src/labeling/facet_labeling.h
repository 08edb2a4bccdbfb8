#pragma once

#include <cstddef>
#include <vector>

#include "labeling/candidate_pairs.h"
#include "labeling/facet_labels.h"
#include "mesh/triangle_mesh.h"
#include "mesh/vertex_attributes.h"
#include "raster/facet_visibility.h"
#include "scene/view.h"

namespace colmap_ext {

struct FacetLabelingOptions {
  PairSelection pair_selection = PairSelection::kFacetwise;
  int pairs_per_facet = 1;

  // With those that the last iterations are to have besides; 0 for the paper's
  // method, which has none.
  int final_pairs_per_facet = 12;

  double potts_weight = 2.1972245773362196;  // log 9
};

struct FacetLabeling {
  FacetLabels labels;
  size_t num_unlabeled_facets = 0;  // that no pair sees
  // Of the first label of each facet; of facetwise selection only.
  double initial_energy = 0;
  double final_energy = 0;
  double lower_bound = 0;
};

// Gives every facet the pairs of views that see it best (the paper, section
// 5). With nu_f the views of the facet's three vertices, repeats kept, and O_f
// how often the two views of a pair occur in it, a label costs
//
//   -log(O_f / |nu_f|) - 1/2 log(q / q_max),
//
// and neighbors with different labels cost potts_weight. (The paper's 0.1 and
// 0.9 are potentials for equal and different labels that -log would turn the
// wrong way round; swapped, they are a cost of log 9 more.) O_f takes a handful
// of values only and ties are the rule, so q, which the paper does not have,
// weighs in how much a pair can tell about where the facet lies: its pixels
// times the squared disparity of a motion along its normal, over both
// directions; q_max is that of the facet's best pair.
//
// Candidates are pairs that both see the facet in the drawn depths, and both
// occur in nu_f; where there is no such pair, all that see it, O_f / |nu_f|
// being 1. Facets that no pair sees get none. The first label is that of the
// Markov random field; see optim/further_labels.h for the others, first those
// up to pairs_per_facet, then those up to final_pairs_per_facet.
//
// \param views  of the images' sizes.
FacetLabeling LabelFacets(const FacetLabelingOptions& options,
                          const TriangleMesh& mesh,
                          const VertexAttributes& attributes,
                          const std::vector<ViewPair>& pairs,
                          const FacetVisibility& visibility,
                          const std::vector<View>& views);

}  // namespace colmap_ext
