#include "colmap_ext/report/html_page.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <utility>

#include "photometry/image_pyramid.h"
#include "pictures/pictures.h"

namespace colmap_ext {
namespace {

constexpr size_t kNumCameras = 3;
constexpr int kLongSide = 480;      // px, of a picture
constexpr int kPointSide = 2;       // px
constexpr float kSoftShade = 0.5f;  // keeps the shape visible

// Adds the pictures from one camera, each to one row.
void AddPictures(std::vector<ColorImage> pictures, size_t first_row,
                 PagePictures* page) {
  for (size_t i = 0; i < pictures.size(); ++i) {
    page->rows[first_row + i].pictures.push_back(std::move(pictures[i]));
  }
}

std::vector<Color> ConfidenceColors(const VertexAttributes& attributes,
                                    size_t num_vertices) {
  std::vector<Color> colors(num_vertices, ErrorColor(0, 1));
  for (size_t i = 0; i < attributes.confidences.size(); ++i) {
    colors[i] = ErrorColor(attributes.confidences[i], 1);
  }
  return colors;
}

PictureRow ConfidenceRow() {
  return {"Confidence", "support of each vertex by points and images:", true};
}

// The page with its photographs.
// \param vertex_views  [V] the views that see each vertex.
// \param rows  of the other pictures.
// \param cameras [out] of all pictures, at their size.
PagePictures StartPage(const std::vector<View>& views,
                       const Rows<uint32_t>& vertex_views,
                       const std::filesystem::path& images_path,
                       const PictureDecoder& decoder,
                       const std::vector<PictureRow>& rows,
                       std::vector<View>* cameras) {
  PagePictures page;
  page.rows.push_back({"Photograph"});
  page.rows.insert(page.rows.end(), rows.begin(), rows.end());
  std::vector<size_t> num_seen(views.size(), 0);
  for (const uint32_t view : vertex_views.values) {
    ++num_seen[view];
  }
  for (const size_t index : SpreadViews(views, num_seen, kNumCameras)) {
    const View& full = views[index];
    const View view =
        ViewAtScale(full, 1.0 * kLongSide / std::max(full.width, full.height));
    const std::optional<ColorImage> photo =
        decoder.read_color(images_path / view.name);
    cameras->push_back(view);
    page.cameras.push_back(view.name);
    page.rows[0].pictures.push_back(
        photo ? ResizePicture(*photo, view.width, view.height) : ColorImage());
  }
  return page;
}

}  // namespace

PagePictures DrawRefinement(const TriangleMesh& before,
                            const RefinedMesh& refined,
                            const std::filesystem::path& images_path,
                            const PictureDecoder& decoder) {
  std::vector<View> cameras;
  PagePictures page = StartPage(
      refined.views, refined.attributes.views, images_path, decoder,
      {{"Before", "red: seen from behind"},
       {"After"},
       {"Labels",
        "one color for each image pair, the best of each face; gray: none"},
       ConfidenceRow()},
      &cameras);
  const MeshRenderer before_renderer(before);
  const MeshRenderer renderer(refined.mesh);
  const std::vector<int32_t> labels = refined.labels.BestLabels();
  const std::vector<Color> confidences =
      ConfidenceColors(refined.attributes, refined.mesh.vertices.size());
  const std::vector<FrontColor> colors = {
      PlainColor(), LabelColors(labels),
      VertexColors(refined.mesh, confidences, kSoftShade)};
  for (const View& view : cameras) {
    AddPictures(before_renderer.Draw(view, {PlainColor()}), 1, &page);
    AddPictures(renderer.Draw(view, colors), 2, &page);
  }
  return page;
}

PagePictures DrawMeshing(const std::vector<View>& views,
                         const PointCloud& cloud, const ManifoldMesh& mesh,
                         const std::filesystem::path& images_path,
                         const PictureDecoder& decoder) {
  std::vector<View> cameras;
  PagePictures page =
      StartPage(views, mesh.attributes.views, images_path, decoder,
                {{"Points", "that were read"},
                 {"Mesh", "red: seen from behind"},
                 ConfidenceRow(),
                 {"Vertex colors"}},
                &cameras);
  const MeshRenderer renderer(mesh.mesh);
  const std::vector<Color> confidences =
      ConfidenceColors(mesh.attributes, mesh.mesh.vertices.size());
  const bool has_colors = !mesh.attributes.colors.empty();
  const std::vector<FrontColor> colors = {
      PlainColor(), VertexColors(mesh.mesh, confidences, kSoftShade),
      has_colors ? VertexColors(mesh.mesh, mesh.attributes.colors, 0)
                 : PlainColor()};
  for (const View& view : cameras) {
    AddPictures({DrawPoints(cloud, view, kPointSide)}, 1, &page);
    AddPictures(renderer.Draw(view, colors), 2, &page);
  }
  return page;
}

}  // namespace colmap_ext
