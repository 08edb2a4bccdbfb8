#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <Eigen/Core>

#include "labeling/view_pairs.h"
#include "mesh/surface.h"
#include "mesh/triangle_mesh.h"
#include "scene/images.h"
#include "scene/point_cloud.h"
#include "scene/view.h"

namespace colmap_ext {

// Two images of a facet, compared.
struct FacetMatch {
  GrayImage first;             // the first image around the facet
  GrayImage warped;            // the second image, warped over the surface into
                               // the first view; 0 where it is occluded
  std::optional<double> zncc;  // weighted mean over the windows of the facet;
                               // nullopt if none can be compared
};

// A mesh, or a point cloud (a mesh without facets), with its data. Not changed
// once it is shown.
struct ShownMesh : VertexAttributes {  // maybe without views
  std::string name;
  TriangleMesh mesh;
  std::vector<Color> error_colors{};       // [V] or empty, of its errors
  std::vector<int32_t> labels{};           // [F] or empty; -1: none
  std::vector<std::string> label_names{};  // "IMAGE IMAGE" of each label
  Eigen::Vector3d front = {0, 0, 0};       // of a cloud: the sum of its normals
};

// All that can be drawn. Large parts are shared and identified by address.
struct ShownScene {
  std::vector<std::shared_ptr<const ShownMesh>> meshes;
  std::shared_ptr<const PointCloud> points;                        // or none
  std::vector<View> views;                                         // cameras
  std::map<size_t, std::shared_ptr<const ColorImage>> thumbnails;  // by view
  std::map<size_t, std::shared_ptr<const ColorImage>> images;      // by view
  // Matches of picked facets, by mesh and facet.
  std::map<std::pair<std::shared_ptr<const ShownMesh>, uint32_t>,
           std::shared_ptr<const FacetMatch>>
      matches{};
  std::string status{};              // the current work, in one line
  std::vector<std::string> notes{};  // data that cannot be shown, and why
  // Coarse copies of large meshes, for slow drawing; see CoarseMesh().
  std::map<const ShownMesh*, std::shared_ptr<const ShownMesh>> stand_ins{};
  bool is_over = false;  // the viewer has to close
};

// The colors of a mesh.
enum class MeshMode {
  kShaded,
  kColor,       // of the vertices
  kNormals,     // red, green, blue for x, y, z of the facets' normals
  kLabels,      // the pair of views that refines each facet
  kErrors,      // of the vertices
  kConfidence,  // dark violet for 0 to yellow for 1
};

// The name on the command line: "shaded", "color", "normals", "labels",
// "error", "confidence".
const char* NameOf(MeshMode mode);

// Which parts of a scene are drawn, and how.
struct DrawSettings {
  size_t mesh = 0;  // of the scene's meshes
  MeshMode mode = MeshMode::kShaded;
  bool wireframe = false;
  bool backfaces = false;  // draw them red
  bool points = false;
  bool cameras = false;
  std::optional<size_t> image;  // of this view, over the mesh
  double image_opacity = 0.5;
  std::optional<uint32_t> picked;  // facet, whose edges are drawn
  bool stand_in = false;           // draw a coarse mesh instead of a large one
  double point_radius = 1.2;       // px
  int samples = 2;                 // a pixel is the mean of their square
};

// Changes of the scene that other threads leave for the viewer. Thread-safe.
class SceneInbox {
 public:
  using Edit = std::function<void(ShownScene* scene)>;

  // Adds a change of the scene. It replaces an earlier one of the same key that
  // has not been taken yet.
  void Put(const std::string& key, Edit edit) {
    const std::lock_guard lock(mutex_);
    edits_[key] = std::move(edit);
  }

  // Applies the changes, in the order of their keys.
  // \return whether there were any.
  bool Take(ShownScene* scene) {
    std::map<std::string, Edit> edits;
    {
      const std::lock_guard lock(mutex_);
      edits.swap(edits_);
    }
    for (const auto& [key, edit] : edits) {
      edit(scene);
    }
    return !edits.empty();
  }

 private:
  std::mutex mutex_;
  std::map<std::string, Edit> edits_;
};

// The elements that colors belong to, as in viewer_mesh.frag.
enum class ColorsOf : int { kPlain, kVertices, kFacets, kNormals };

struct MeshColors {
  ColorsOf of = ColorsOf::kPlain;
  std::vector<uint32_t> colors;  // [V] or [F] or empty; red in the lowest byte
  float shading = 1;             // 0: none, 1: full
};

// The colors of a mesh by a mode; plain if the mesh has no such data.
MeshColors ColorsByMode(const ShownMesh& mesh, MeshMode mode);

// The data that a mesh lacks for a mode, and how to get it, in one line; empty
// if none is missing.
std::string MissingData(const ShownMesh& mesh, MeshMode mode);

// A mesh of about `max_facets` facets to draw instead of a large one while the
// camera moves: vertices within a cube of a grid become one [Rossignac1993].
// Not manifold; keeps labels and colors.
// \pre max_facets > 0
ShownMesh CoarseMesh(const ShownMesh& mesh, size_t max_facets);

// The scene's views that see a corner of a facet, ascending.
std::vector<uint32_t> ViewsOfFacet(const ShownMesh& mesh, uint32_t facet);

// The pair of a facet's label; without a label, the two views in which the
// facet is largest.
std::optional<ViewPair> PairOfFacet(const ShownMesh& mesh, uint32_t facet,
                                    const std::vector<View>& views);

// Compares two images on a facet as the refinement does, in windows of 5 x 5
// pixels (photometry/window_correlation.h), at full size.
// \pre the images have the sizes of their views
FacetMatch MatchFacet(const TriangleMesh& mesh, uint32_t facet,
                      const View& first, const GrayImage& first_image,
                      const View& second, const GrayImage& second_image);

}  // namespace colmap_ext
