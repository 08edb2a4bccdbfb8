#include "tests/synthetic/dense_scene.h"

#include <cmath>
#include <utility>

#include <tbb/task_arena.h>
#include <Eigen/Geometry>

#include "tests/mesh/known_meshes.h"
#include "tests/synthetic/noise.h"

namespace colmap_ext::synthetic {

namespace {

using Vector6d = Eigen::Matrix<double, 6, 1>;

constexpr uint64_t kPoseNoise = 0x706f7365;  // of this use of Hash()

// [views] of zero mean, and with a mean square of 1 for each number.
std::vector<Vector6d> MakeNoise(bool is_smooth, size_t num_views,
                                uint64_t seed) {
  std::vector<Vector6d> noise(num_views, Vector6d::Zero());
  for (int k = 0; k < 6; ++k) {
    const auto number = [&](size_t i) {
      return Gaussian(Hash(seed, kPoseNoise, i, k));
    };
    for (size_t i = 0; i < num_views; ++i) {
      const double angle =
          2 * M_PI * static_cast<double>(i) / static_cast<double>(num_views);
      noise[i][k] = is_smooth ? number(0) * std::sin(angle) +
                                    number(1) * std::cos(angle) +
                                    number(2) * std::sin(2 * angle)
                              : number(i);
    }
  }
  Vector6d mean = Vector6d::Zero();
  for (const Vector6d& of_view : noise) {
    mean += of_view / static_cast<double>(num_views);
  }
  double sum = 0;
  for (Vector6d& of_view : noise) {
    of_view -= mean;
    sum += of_view.squaredNorm();
  }
  for (Vector6d& of_view : noise) {
    of_view *= std::sqrt(6 * static_cast<double>(num_views) / sum);
  }
  return noise;
}

std::vector<View> Moved(std::vector<View> views, const std::string& prefix,
                        const Eigen::Vector3d& offset) {
  for (View& view : views) {
    view.name = prefix + view.name;
    view.cam_from_world_translation -= view.cam_from_world_rotation * offset;
  }
  return views;
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
      result.images.push_back(RenderImage(scene, bvh, i, options.camera, seed));
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

// A turn about x or y, or a motion along them, moves what lies ahead by the
// angle, or the length over the depth, times the focal length; turns about z
// and motions along it move it less. So four of six numbers share the squares.
std::vector<View> DisturbViews(const PoseNoiseOptions& options,
                               const std::vector<View>& views, double depth,
                               uint64_t seed) {
  std::vector<View> disturbed = views;
  if (options.pixels > 0 && views.size() > 1) {
    const std::vector<Vector6d> noise =
        MakeNoise(options.is_smooth, views.size(), seed);
    for (size_t i = 0; i < views.size(); ++i) {
      View& view = disturbed[i];
      const Vector6d step = noise[i] * options.pixels / (2 * view.fx);
      const Eigen::Vector3d turn = step.head<3>();
      const Eigen::Matrix3d rotation =
          Eigen::AngleAxisd(turn.norm(), turn.normalized()).toRotationMatrix();
      view.cam_from_world_rotation = rotation * view.cam_from_world_rotation;
      view.cam_from_world_translation =
          rotation * view.cam_from_world_translation + depth * step.tail<3>();
    }
  }
  for (View& view : disturbed) {
    view.fx *= options.focal_factor;
    view.fy *= options.focal_factor;
  }
  return disturbed;
}

DenseScene MakeDenseScene(const DenseSceneOptions& options) {
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
    row.scene.surface = Union(
        row.scene.surface, Shifted(scene.scene.surface, shift.cast<float>()));
    Append(Moved(scene.scene.views, prefix, shift), &row.scene.views);
    Append(Moved(scene.model_views, prefix, shift), &row.model_views);
    Append(scene.images, &row.images);
    AddPoints(scene.fused, shift.cast<float>(), first_view, &row.fused);
    AddSparse(scene.sparse_points, shift, first_view, &row.sparse_points);
  }
  return row;
}

}  // namespace colmap_ext::synthetic
