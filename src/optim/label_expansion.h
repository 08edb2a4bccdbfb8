#pragma once

#include <cstdint>
#include <vector>

#include "optim/potts_mrf.h"

namespace colmap_ext {

// Alpha expansion [Boykov2001]: for one label after the other, those nodes take
// it that have it among theirs and lower the energy most by taking it together,
// found by a minimum cut. The cuts' graphs are of these nodes alone, so that
// time and memory follow the sum of the nodes' labels. Capacities are integers:
// the energy can rise by a rounding.
//
// A round is done in each block of consecutive nodes while the others stay,
// those without edges between them in parallel; large problems have a second
// round, in blocks shifted by half of one.
//
// \param choices [N] see PottsSolution
// \return new choices
std::vector<uint32_t> ExpandLabels(const PottsProblem& problem,
                                   std::vector<uint32_t> choices);

}  // namespace colmap_ext
