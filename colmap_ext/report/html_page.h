#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "colmap_ext/report/print_report.h"
#include "mesh/triangle_mesh.h"
#include "meshing/manifold_meshing.h"
#include "refine/facetwise_refinement.h"
#include "scene/images.h"
#include "scene/point_cloud.h"
#include "scene/view.h"

namespace colmap_ext {

// A page on a run of a command: one self-contained HTML file, without scripts,
// which is also well-formed XML.

// The run that a page describes.
struct PageRun {
  std::string command;  // "facetwise_refiner"
  std::string output;   // the path of the mesh
  std::string version;  // of the program
};

// Pictures of one kind, from each of the cameras.
struct PictureRow {
  std::string title;
  std::string note{};                  // how to read them; may be empty
  bool has_scale = false;              // of ErrorColor() from 0 to 1
  std::vector<ColorImage> pictures{};  // [cameras], width 0 if there is none
};

struct PagePictures {
  std::vector<std::string> cameras;  // the names of their images
  std::vector<PictureRow> rows;
};

// Draw the pictures of a page from up to three cameras that see much of the
// mesh and are spread out; about 480 px wide or high.
// \param images_path  the folder of the photographs; unreadable ones are left
//        out

// The photographs, the input mesh, and the refined mesh.
PagePictures DrawRefinement(const TriangleMesh& before,
                            const RefinedMesh& refined,
                            const std::filesystem::path& images_path,
                            const PictureDecoder& decoder);

// The photographs, the points, and their mesh.
// \param views  of the points
PagePictures DrawMeshing(const std::vector<View>& views,
                         const PointCloud& cloud, const ManifoldMesh& mesh,
                         const std::filesystem::path& images_path,
                         const PictureDecoder& decoder);

// The page of a refinement.
std::string RefinementPage(const PageRun& run, const ReportLog& log,
                           const std::vector<RefinementStep>& steps,
                           const PagePictures& pictures);

// The page of a meshing.
std::string MeshingPage(const PageRun& run, const ReportLog& log,
                        const PagePictures& pictures);

// Escapes text for elements and quoted attributes of HTML and XML. Bytes that
// are not UTF-8, or no character of XML, become U+FFFD: file names may be in
// any encoding.
std::string EscapeHtml(std::string_view text);

// Encodes bytes (RFC 4648, section 4).
std::string Base64(std::string_view bytes);

}  // namespace colmap_ext
