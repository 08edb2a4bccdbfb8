#pragma once

#include <filesystem>
#include <vector>

#include "base/rows.h"
#include "colmap_ext/report/html_page.h"
#include "mesh/triangle_mesh.h"
#include "meshing/manifold_meshing.h"
#include "refine/facetwise_refinement.h"
#include "scene/color_image.h"
#include "scene/picture_decoder.h"
#include "scene/point_cloud.h"
#include "scene/view.h"

namespace colmap_ext {

// The cameras that a page shows a mesh from.
struct PageCameras {
  std::vector<View> views;         // of the pictures' size, about 480 px
  std::vector<ColorImage> photos;  // [views] likewise; of no width where it can
                                   // not be read
};

// Returns three cameras that see much of the mesh and are spread out; fewer
// where there are not as many.
// \param vertex_views  [V] the views that see each vertex.
// \param images_path  the folder of the photographs.
PageCameras ChoosePageCameras(const std::vector<View>& views,
                              const Rows<uint32_t>& vertex_views,
                              const std::filesystem::path& images_path,
                              const PictureDecoder& decoder);

// The photographs, the mesh before, and what became of it.
PagePictures DrawRefinement(const PageCameras& cameras,
                            const TriangleMesh& before,
                            const RefinedMesh& refined);

// The photographs, the points, and the mesh that was made of them.
PagePictures DrawMeshing(const PageCameras& cameras, const PointCloud& cloud,
                         const ManifoldMesh& mesh);

}  // namespace colmap_ext
