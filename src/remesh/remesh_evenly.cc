#include "remesh/remesh_evenly.h"

#include <utility>
#include <vector>

#include "remesh/carry_attributes.h"
#include "remesh/edge_length_field.h"
#include "remesh/isotropic_remeshing.h"

namespace colmap_ext {

void RemeshEvenly(TriangleMesh* mesh, VertexAttributes* attributes) {
  std::vector<float> lengths = MeanEdgeLengths(*mesh);
  LimitGradation(*mesh, kGradation, &lengths);
  RemeshedSurface remeshed =
      RemeshIsotropically(*mesh, lengths, TolerancesOf(lengths));
  *attributes = CarryAttributes(*mesh, *attributes, remeshed.sources);
  *mesh = std::move(remeshed.mesh);
}

}  // namespace colmap_ext
