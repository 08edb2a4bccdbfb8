#pragma once

#include <cstdint>
#include <vector>

#include "optim/potts_mrf.h"

namespace colmap_ext {

// Takes the choices if they are better.
void OfferChoices(std::vector<uint32_t> choices, double energy,
                  PottsSolution* solution);

// Sequential tree-reweighted message passing [Kolmogorov2006], see
// SolvePotts().
// \param solution  with choices and their energy; gets better ones, and the
//        bound
void PassMessages(const PottsProblem& problem, double max_gap,
                  int max_iterations, PottsSolution* solution);

}  // namespace colmap_ext
