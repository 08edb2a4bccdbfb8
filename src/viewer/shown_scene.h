#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <Eigen/Core>

#include "base/rows.h"
#include "mesh/triangle_mesh.h"
#include "scene/color_image.h"
#include "scene/point_cloud.h"
#include "scene/view.h"
#include "viewer/facet_match.h"

namespace colmap_ext {

// A mesh, or a point cloud, which is one without facets, and what is known of
// it. Not changed once it is shown.
struct ShownMesh {
  std::string name;
  TriangleMesh mesh;
  std::vector<Color> colors;             // [V] or empty
  std::vector<Color> error_colors;       // [V] or empty, of its errors
  std::vector<float> confidences;        // [V] in [0, 1] or empty
  std::vector<int32_t> labels;           // [F] or empty; -1: none
  std::vector<std::string> label_names;  // "IMAGE IMAGE" of each label
  Rows<uint32_t> views;                  // [V] or no rows; indices of the
                                         // scene's views that see each vertex
  Eigen::Vector3d front = {0, 0, 0};     // of a cloud: the sum of its normals
};

// What there is to be seen. What is large is shared, and known to be the same
// by its address.
struct ShownScene {
  std::vector<std::shared_ptr<const ShownMesh>> meshes;
  std::shared_ptr<const PointCloud> points;                        // or none
  std::vector<View> views;                                         // cameras
  std::map<size_t, std::shared_ptr<const ColorImage>> thumbnails;  // by view
  std::map<size_t, std::shared_ptr<const ColorImage>> images;      // by view
  // Of facets that were picked, by mesh and facet.
  std::map<std::pair<std::shared_ptr<const ShownMesh>, uint32_t>,
           std::shared_ptr<const FacetMatch>>
      matches{};
  std::string status{};              // what is being done, in one line
  std::vector<std::string> notes{};  // what can not be shown, and why
  // Of large meshes, for where drawing is slow; see CoarseMesh().
  std::map<const ShownMesh*, std::shared_ptr<const ShownMesh>> stand_ins{};
  bool is_over = false;  // the viewer is to close
};

}  // namespace colmap_ext
