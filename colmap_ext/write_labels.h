#pragma once

#include <filesystem>
#include <vector>

#include "formats/atomic_file.h"
#include "labeling/facet_labels.h"
#include "mesh/triangle_mesh.h"
#include "scene/color_image.h"
#include "scene/view.h"

namespace colmap_ext {

// Writes a mesh whose faces are coloured by the pair of views that is best for
// each (formats/write_labeled_mesh.h), and a picture of the same, PNG.
// \param views  whose names are those of the pairs.
// \param together  to which the files are added.
// \pre labels.NumFacets() == mesh.facets.size()
// \throw FileError if they can not be written.
void WriteLabels(const std::filesystem::path& path,
                 const std::filesystem::path& picture_path,
                 const TriangleMesh& mesh, const FacetLabels& labels,
                 const std::vector<View>& views, AtomicFiles* together);

// \throw FileError if the file can not be written.
void WritePng(const std::filesystem::path& path, const ColorImage& image);

}  // namespace colmap_ext
