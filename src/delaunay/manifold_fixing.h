#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "delaunay/tetrahedralization.h"
#include "optim/min_cut.h"

namespace colmap_ext {

enum class FixingRule {
  // The paper's three passes: relabel, split, relabel. Of the components around
  // a vertex those with the most cells keep their labels.
  kPaper,
  // Passes until nothing changes. Of the ways to make a vertex less singular
  // the
  // one is taken that leaves the fewest components too many around the vertices
  // that it touches, then the one that costs the least in the cut's energy;
  // none
  // that does not reduce their number.
  kEnergy,
};

struct FixingReport {
  size_t num_singular_raw = 0;    // of the cut, before any fixing
  size_t num_singular_fixed = 0;  // left for the fan split
  size_t num_relabeled_cells = 0;
  size_t num_split_cells = 0;  // each into four at its centroid
};

// Preemptive fixing of singular vertices (Romanoni and Matteucci, section
// III-B): changes the labels of cells around them, and splits cells, so that
// the surface needs fewer copies of vertices to become manifold.
//
// \param graph      the cut's; split cells share out the terminal capacities of
//                   the cell that they come from, their outer facets keep its
//                   arcs, their inner ones have none: the energy stays.
// \param tetrahedra no longer Delaunay where cells are split.
FixingReport FixSingularVertices(FixingRule rule,
                                 Tetrahedralization* tetrahedra,
                                 FlowGraph* graph,
                                 std::vector<uint8_t>* is_free);

// Splits a finite cell into four at its centroid. The cell keeps its index as
// the first of them, the others come last, as the new vertex does.
void SplitCell(uint32_t cell, Tetrahedralization* tetrahedra, FlowGraph* graph,
               std::vector<uint8_t>* is_free);

}  // namespace colmap_ext
