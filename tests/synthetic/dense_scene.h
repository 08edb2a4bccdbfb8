#pragma once

#include <cstdint>
#include <vector>

#include <Eigen/Core>

#include "scene/images.h"
#include "scene/point_cloud.h"
#include "scene/view.h"
#include "spatial/bvh.h"
#include "tests/synthetic/photograph.h"
#include "tests/synthetic/scene.h"

namespace colmap_ext::synthetic {

// The surface at the pixel centers (col + 0.5, row + 0.5) of an image.
struct Visible : colmap_ext::DepthMap {
  std::vector<int32_t> facets;  // [height * width]; -1 for background
};

// Casts a ray through every pixel's center.
Visible RenderVisible(const Bvh& bvh, const View& view);

// Photograph of the scene by one of its views: 2 x 2 rays a pixel, diffuse
// light and highlights, exposure, and what the camera does.
ColorImage RenderImage(const Scene& scene, const Bvh& bvh, size_t view,
                       const CameraOptions& options, uint64_t seed);

struct StereoOptions {
  // Deviation of a match in another image, px. It becomes an error of the depth
  // through the baselines to all images that see the point.
  double noise = 0.5;

  // Share of the error's variance that neighboring pixels have in common.
  double correlated_share = 0.9;

  // Deviation of the normals, degrees.
  double normal_noise = 4.0;

  // Smallest number of other images that have to see a point.
  int min_num_sources = 2;

  // Largest angle between a ray and the surface's normal, degrees.
  double max_incidence = 75.0;

  // Largest angle between the rays of two images that are matched, degrees.
  double max_triangulation_angle = 60.0;

  // Share of the pixels without depth, in patches, though all is seen.
  double dropout = 0.04;

  // Maximum growth of the foreground over the background at silhouettes, px.
  double fattening = 5.0;
};

// The result of multi-view stereo for one image, in COLMAP's form: pixel
// (row, col) stands for the ray through (col, row) of COLMAP's convention, not
// (col + 0.5, row + 0.5).
struct DepthMap : colmap_ext::DepthMap {
  std::vector<Eigen::Vector3f> normals;  // [height * width], world frame, unit
};

// Simulates COLMAP's patch_match_stereo on one view. The content of a pixel is
// seen by its center, but COLMAP attributes it to the pixel's upper left
// corner, in this image and in all others. The depth is the one that fits those
// shifted observations best, in least squares; noise is added to it. Surface
// without texture gets holes and more noise; images with different highlights
// are not matched; windows with a silhouette match the foreground. \param
// visible of all views
DepthMap SimulateStereo(const Scene& scene, const std::vector<Visible>& visible,
                        size_t view, const StereoOptions& options,
                        uint64_t seed);

// Names and defaults of COLMAP's stereo_fusion.
struct FusionOptions {
  // Minimum number of fused pixels to produce a point.
  int min_num_pixels = 5;

  // Maximum distance between a measured and a projected pixel, px.
  double max_reproj_error = 2.0;

  // Maximum relative difference between measured and projected depth.
  double max_depth_error = 0.01;

  // Maximum angular difference of the normals of pixels to be fused, degrees.
  double max_normal_error = 10.0;

  // Outliers that are added, as a fraction of the points: clumps off the
  // surface, seen by few images.
  double outliers = 0.01;
};

struct FusedPoints {
  PointCloud cloud;                      // colors only with images
  std::vector<Eigen::Vector3f> normals;  // [P], world frame, unit
  std::vector<char> is_outlier;          // [P], added by AddOutliers()
};

// Fuses depth maps by the rules of COLMAP's stereo_fusion: an unused pixel is a
// reference; the pixels of other images that its point projects to are joined
// if position, depth and normal agree, then those that their points project to;
// the point is the median. Single-threaded, for reproducible results. \param
// images of all views, or empty
FusedPoints FuseDepthMaps(const std::vector<View>& views,
                          const std::vector<DepthMap>& maps,
                          const std::vector<ColorImage>& images,
                          const FusionOptions& options);

// Appends outliers, see FusionOptions.
void AddOutliers(const std::vector<View>& views, double share, uint64_t seed,
                 FusedPoints* points);

struct SparseOptions {
  // The number of points that are tried; fewer are seen often enough.
  int num_points = 3000;

  // Deviation of a feature's position, px.
  double noise = 0.4;

  // The share of the views that see a point whose features are matched.
  double match_share = 0.8;
};

struct Feature {
  uint32_t view;
  Eigen::Vector2d position;  // pixel coordinates in COLMAP's convention

  bool operator==(const Feature&) const = default;
};

struct SparsePoint {
  Eigen::Vector3d position;    // world frame, triangulated from the features
  Color color{};               // black where there are no images
  double error = 0;            // mean reprojection error, px
  std::vector<Feature> track;  // one for each view, three or more

  bool operator==(const SparsePoint&) const = default;
};

// Points of the true surface with tracks of features, as structure from motion
// leaves them: without the half pixel of the depth maps.
// \param images of all views, or empty
std::vector<SparsePoint> MakeSparsePoints(const Scene& scene,
                                          const std::vector<Visible>& visible,
                                          const std::vector<ColorImage>& images,
                                          const SparseOptions& options,
                                          uint64_t seed);

// Errors of a sparse model's cameras.
struct PoseNoiseOptions {
  // Approximate RMS motion of the image content, px: half of it by rotations,
  // half by translations of the camera, of zero mean.
  double pixels = 0;

  // Whether neighboring images have similar errors, as after drift.
  bool is_smooth = false;

  // Whether the depth maps are fused by the disturbed cameras, as in practice.
  bool is_before_fusion = true;

  // A factor on all focal lengths.
  double focal_factor = 1;
};

// The views with poses and focal lengths disturbed.
// \param depth  of the scene, scene units.
std::vector<View> DisturbViews(const PoseNoiseOptions& options,
                               const std::vector<View>& views, double depth,
                               uint64_t seed);

struct DenseSceneOptions {
  SceneOptions scene;
  CameraOptions camera;
  StereoOptions stereo;
  FusionOptions fusion;
  SparseOptions sparse;
  PoseNoiseOptions pose_noise;

  // Whether images are rendered; without them points have no colors.
  bool render_images = true;

  // Whether the depth maps of the stereo are kept.
  bool keep_depth_maps = false;

  // Whether the true depths at the pixel centers are kept.
  bool keep_true_depths = true;
};

// A dense workspace in memory: `scene.surface` is the truth, `model_views` and
// `fused.cloud` are the input of a mesher.
struct DenseScene {
  Scene scene;
  std::vector<View> model_views;     // scene.views, or disturbed ones
  std::vector<ColorImage> images;    // [views] or empty
  std::vector<DepthMap> depth_maps;  // [views] or empty
  std::vector<Visible> visible;      // [views] or empty, the truth
  FusedPoints fused;
  std::vector<SparsePoint> sparse_points;
};

// The same options give the same bytes for any number of threads.
// \throw std::invalid_argument for an unknown shape.
DenseScene MakeDenseScene(const DenseSceneOptions& options);

// Returns copies of a scene side by side, each seen by its own views, whose
// names begin with the number of the copy. Without depth maps and true depths.
// \param offset  between neighbors, scene units
DenseScene MakeSceneRow(const DenseScene& scene, int num_copies,
                        const Eigen::Vector3d& offset);

}  // namespace colmap_ext::synthetic
