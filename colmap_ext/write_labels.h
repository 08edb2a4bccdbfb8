#pragma once

#include <filesystem>
#include <vector>

#include "mesh/triangle_mesh.h"
#include "refine/facet_labels.h"
#include "scene/view.h"

namespace colmap_ext {

// Writes a mesh with its faces coloured by the pair of views that is best for
// each: binary PLY whose faces have uchar red, green, blue and the int label,
// an index into the pairs, which comments name; -1 and plain where there is
// none. Beside it, a picture of the same.
// \param views  whose names are those of the pairs.
// \pre labels.NumFacets() == mesh.facets.size()
// \throw FileError if they can not be written.
void WriteLabels(const std::filesystem::path& path,
                 const std::filesystem::path& picture_path,
                 const TriangleMesh& mesh, const FacetLabels& labels,
                 const std::vector<View>& views);

}  // namespace colmap_ext
