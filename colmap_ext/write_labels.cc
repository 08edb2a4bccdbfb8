#include "colmap_ext/write_labels.h"

#include <cstdint>
#include <string>

#include "formats/encode_png.h"
#include "formats/write_labeled_mesh.h"
#include "pictures/mesh_renderer.h"
#include "pictures/picture_views.h"

namespace colmap_ext {

void WriteLabels(const std::filesystem::path& path,
                 const std::filesystem::path& picture_path,
                 const TriangleMesh& mesh, const FacetLabels& labels,
                 const std::vector<View>& views, AtomicFiles* together) {
  constexpr int kWidth = 1024;  // px, of the picture
  constexpr int kHeight = 768;  // px
  MeshLabels best;
  for (const ViewPair& pair : labels.pairs) {
    best.names.push_back(views[pair.first].name + " " +
                         views[pair.second].name);
  }
  for (size_t i = 0; i < labels.NumFacets(); ++i) {
    const auto row = labels.labels[i];
    best.labels.push_back(row.empty() ? -1 : static_cast<int32_t>(row[0]));
    best.colors.push_back(LabelColor(best.labels.back()));
  }
  WriteLabeledMesh(path, mesh, best, together);
  WriteText(picture_path,
            EncodePng(RenderMesh(mesh, AutomaticView(mesh, kWidth, kHeight),
                                 LabelColors(best.labels))),
            together);
}

void WritePng(const std::filesystem::path& path, const ColorImage& image) {
  WriteText(path, EncodePng(image));
}

}  // namespace colmap_ext
