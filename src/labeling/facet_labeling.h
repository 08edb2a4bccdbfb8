#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

#include "labeling/view_pairs.h"
#include "mesh/surface.h"
#include "mesh/triangle_mesh.h"
#include "raster/visibility_buffers.h"
#include "scene/view.h"

namespace colmap_ext {

enum class PairSelection {
  kFacetwise,  // each facet by its best pairs [Romanoni2020, section V]
  kClassical,  // each facet by every pair that sees it [Vu2012]
};

struct FacetLabelingOptions {
  PairSelection pair_selection = PairSelection::kFacetwise;

  // Labels of each facet that the first iterations use. [Romanoni2020] has 1.
  int pairs_per_facet = 1;

  // Labels of each facet that the last iterations use, the first ones included;
  // 0: no more than pairs_per_facet, as [Romanoni2020]. Tuned on the scenes of
  // docs/results.md.
  int final_pairs_per_facet = 18;

  // Labels of each facet in the first half of the final iterations: a third of
  // final_pairs_per_facet. Tuned on the same scenes.
  int FirstFinalPairs() const {
    return std::max(pairs_per_facet, (final_pairs_per_facet + 2) / 3);
  }

  // Cost of a change of labels between neighbors. log 9: docs/method.md,
  // section 4.4; [Romanoni2020, section V, equation (5)].
  double potts_weight = 2.1972245773362196;
};

struct LabelingReport {
  int level = 0;                    // of the views' images
  size_t num_pairs = 0;             // there are to choose from
  size_t num_unlabeled_facets = 0;  // that no pair sees
  // Of the first label of each facet, docs/method.md, section 4.4; 0 with
  // kClassical.
  double initial_energy = 0;  // of each facet's cheapest label
  double final_energy = 0;
  double lower_bound = 0;
};

struct FacetLabeling : LabelingReport {
  FacetLabels labels;
};

// Gives every facet the pairs of views that see it best (docs/method.md,
// sections 4.3 to 4.5; [Romanoni2020, section V, equations (4) and (5)]; what
// differs stands there). Facets that no pair sees get none. The first label is
// that of the Markov random field; then come the further ones up to
// pairs_per_facet, then those up to final_pairs_per_facet.
//
// \param attributes  [V] whose views are nu_f.
// \param pairs  ascending.
// \param visibility  [F] the views that see each facet.
// \param views  of the images' sizes.
// \return without the report's level
// \pre options in their ranges
FacetLabeling LabelFacets(const FacetLabelingOptions& options,
                          const TriangleMesh& mesh,
                          const VertexAttributes& attributes,
                          const std::vector<ViewPair>& pairs,
                          const FacetVisibility& visibility,
                          const std::vector<View>& views);

}  // namespace colmap_ext
