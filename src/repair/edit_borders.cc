#include "repair/edit_borders.h"

#include <stdexcept>
#include <utility>

namespace colmap_ext {

EditedMesh EditBorders(const BorderOptions& options, TriangleMesh mesh,
                       VertexAttributes attributes,
                       const std::vector<float>& facet_confidences) {
  TrimmedMesh trimmed =
      TrimMesh(options.trim, mesh, facet_confidences, options.trim_rings);
  if (trimmed.mesh.facets.empty() && options.is_trim_optional) {
    trimmed = TrimMesh(0, std::move(mesh), facet_confidences);
  } else if (trimmed.mesh.facets.empty()) {
    throw std::invalid_argument(
        "no face is confident enough: a lower trim drops less");
  }
  if (trimmed.report.num_facets > 0) {
    attributes = InterpolateAttributes(attributes, trimmed.sources);
  }
  ClosedMesh closed = CloseHoles(options.close_holes, std::move(trimmed.mesh),
                                 std::move(attributes));
  EditedMesh edited{std::move(closed.mesh),
                    std::move(closed.attributes),
                    {},
                    std::move(trimmed.facet_sources),
                    {trimmed.report, closed.report}};
  for (const auto& source : trimmed.sources) {
    edited.vertex_sources.push_back(source[0]);
  }
  edited.vertex_sources.resize(edited.mesh.vertices.size(), kNone);
  edited.facet_sources.resize(edited.mesh.facets.size(), kNone);
  return edited;
}

}  // namespace colmap_ext
