#include "tests/synthetic/dense_scene.h"

#include <stdexcept>
#include <utility>

#include <tbb/task_arena.h>

namespace colmap_ext::synthetic {

std::string DenseSceneOptions::Check() const {
  const std::string error = scene.Check();
  return !error.empty()
             ? error
             : RangeError(
                   {{"noise", stereo.noise, 0, 10},
                    {"correlated_share", stereo.correlated_share, 0, 1},
                    {"normal_noise", stereo.normal_noise, 0, 45},
                    {"dropout", stereo.dropout, 0, 1},
                    {"fattening", stereo.fattening, 0, 20},
                    {"pose_noise", pose_noise.pixels, 0, 100},
                    {"focal_factor", pose_noise.focal_factor, 0.5, 2},
                    {"sensor_noise", render.sensor_noise, 0, 100},
                    {"photon_noise", render.photon_noise, 0, 100},
                    {"outliers", fusion.outliers, 0, 1},
                    {"min_num_pixels", 1.0 * fusion.min_num_pixels, 1, 1e9},
                    {"num_sparse_points", 1.0 * sparse.num_points, 0, 1e9},
                    {"feature_noise", sparse.noise, 0, 10}});
}

namespace {

std::vector<View> Moved(std::vector<View> views, const std::string& prefix,
                        const Eigen::Vector3d& offset) {
  for (View& view : views) {
    view.name = prefix + view.name;
    view.cam_from_world_translation -= view.cam_from_world_rotation * offset;
  }
  return views;
}

template <typename T>
void Append(const std::vector<T>& from, std::vector<T>* to) {
  to->insert(to->end(), from.begin(), from.end());
}

void AddMesh(const TriangleMesh& mesh, const Eigen::Vector3f& offset,
             TriangleMesh* row) {
  const auto first = static_cast<uint32_t>(row->vertices.size());
  for (const Eigen::Vector3f& vertex : mesh.vertices) {
    row->vertices.push_back(vertex + offset);
  }
  for (const auto& [a, b, c] : mesh.facets) {
    row->facets.push_back({a + first, b + first, c + first});
  }
}

void AddPoints(const FusedPoints& points, const Eigen::Vector3f& offset,
               uint32_t first_view, FusedPoints* row) {
  for (size_t i = 0; i < points.cloud.size(); ++i) {
    row->cloud.positions.push_back(points.cloud.positions[i] + offset);
    for (const uint32_t view : points.cloud.views[i]) {
      row->cloud.views.values.push_back(view + first_view);
    }
    row->cloud.views.EndRow();
  }
  Append(points.cloud.colors, &row->cloud.colors);
  Append(points.normals, &row->normals);
  Append(points.is_outlier, &row->is_outlier);
}

void AddSparse(const std::vector<SparsePoint>& points,
               const Eigen::Vector3d& offset, uint32_t first_view,
               std::vector<SparsePoint>* row) {
  for (SparsePoint point : points) {
    point.position += offset;
    for (Feature& feature : point.track) {
      feature.view += first_view;
    }
    row->push_back(point);
  }
}

DenseScene MakeValid(const DenseSceneOptions& options) {
  const uint64_t seed = options.scene.seed;
  DenseScene result;
  result.scene = MakeScene(options.scene);
  const Scene& scene = result.scene;
  const Bvh bvh(scene.surface);
  std::vector<Visible> visible;
  for (size_t i = 0; i < scene.views.size(); ++i) {
    visible.push_back(RenderVisible(bvh, scene.views[i]));
    if (options.render_images) {
      result.images.push_back(RenderImage(scene, bvh, i, options.render, seed));
    }
  }
  std::vector<DepthMap> maps;
  for (size_t i = 0; i < scene.views.size(); ++i) {
    maps.push_back(SimulateStereo(scene, visible, i, options.stereo, seed));
  }
  result.model_views = DisturbViews(options.pose_noise, scene.views,
                                    scene.footprint * scene.views[0].fx, seed);
  const std::vector<View>& fusing =
      options.pose_noise.is_before_fusion ? result.model_views : scene.views;
  result.fused = FuseDepthMaps(fusing, maps, result.images, options.fusion);
  AddOutliers(fusing, options.fusion.outliers, seed, &result.fused);
  result.sparse_points =
      MakeSparsePoints(scene, visible, result.images, options.sparse, seed);
  if (options.keep_depth_maps) {
    result.depth_maps = std::move(maps);
  }
  if (options.keep_true_depths) {
    result.visible = std::move(visible);
  }
  return result;
}

}  // namespace

DenseScene MakeDenseScene(const DenseSceneOptions& options) {
  if (const std::string error = options.Check(); !error.empty()) {
    throw std::invalid_argument(error);
  }
  const int num_threads = options.scene.num_threads;
  tbb::task_arena arena(num_threads > 0 ? num_threads
                                        : tbb::task_arena::automatic);
  return arena.execute([&options] { return MakeValid(options); });
}

DenseScene MakeSceneRow(const DenseScene& scene, int num_copies,
                        const Eigen::Vector3d& offset) {
  DenseScene row;
  for (int copy = 0; copy < num_copies; ++copy) {
    const Eigen::Vector3d shift = copy * offset;
    const std::string prefix = std::to_string(copy) + "_";
    const auto first_view = static_cast<uint32_t>(row.model_views.size());
    AddMesh(scene.scene.surface, shift.cast<float>(), &row.scene.surface);
    Append(Moved(scene.scene.views, prefix, shift), &row.scene.views);
    Append(Moved(scene.model_views, prefix, shift), &row.model_views);
    Append(scene.images, &row.images);
    AddPoints(scene.fused, shift.cast<float>(), first_view, &row.fused);
    AddSparse(scene.sparse_points, shift, first_view, &row.sparse_points);
  }
  return row;
}

}  // namespace colmap_ext::synthetic
