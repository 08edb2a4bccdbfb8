#pragma once

#include <filesystem>
#include <vector>

#include "base/rows.h"
#include "colmap_ext/report/html_page.h"
#include "mesh/triangle_mesh.h"
#include "meshing/manifold_meshing.h"
#include "refine/facetwise_refinement.h"
#include "scene/images.h"
#include "scene/point_cloud.h"
#include "scene/view.h"

namespace colmap_ext {

// The cameras of the pictures on a page.
struct PageCameras {
  std::vector<View> views;         // of the pictures' size, about 480 px
  std::vector<ColorImage> photos;  // [views] width 0 if unreadable
};

// Returns up to three cameras that see much of the mesh and are spread out.
// \param vertex_views  [V] the views that see each vertex.
// \param images_path  the folder of the photographs.
PageCameras ChoosePageCameras(const std::vector<View>& views,
                              const Rows<uint32_t>& vertex_views,
                              const std::filesystem::path& images_path,
                              const PictureDecoder& decoder);

// The photographs, the input mesh, and the refined mesh.
PagePictures DrawRefinement(const PageCameras& cameras,
                            const TriangleMesh& before,
                            const RefinedMesh& refined);

// The photographs, the points, and their mesh.
PagePictures DrawMeshing(const PageCameras& cameras, const PointCloud& cloud,
                         const ManifoldMesh& mesh);

}  // namespace colmap_ext
