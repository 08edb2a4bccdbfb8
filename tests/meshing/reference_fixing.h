#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "meshing/manifold_fixing.h"

namespace colmap_ext {

// What FixSingularVertices does, written down without regard for time: after
// every pass all vertices are examined again, labels are copied to be put back.
FixingReport ReferenceFixing(FixingRule rule, Tetrahedralization* tetrahedra,
                             FlowCapacities* graph,
                             std::vector<uint8_t>* is_free);

}  // namespace colmap_ext
