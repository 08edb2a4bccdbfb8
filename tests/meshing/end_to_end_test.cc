#include <algorithm>
#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "base/percentile.h"
#include "meshing/manifold_meshing.h"
#include "scene/half_pixel.h"
#include "scene/point_tree.h"
#include "tests/mesh/manifold_links.h"
#include "tests/synthetic/dense_scene.h"

namespace colmap_ext::end_to_end_test {

using synthetic::DenseScene;
using synthetic::Scene;

DenseScene MakeSmallScene(const std::string& shape) {
  synthetic::DenseSceneOptions options;
  options.scene.shape = shape;
  options.scene.width = 256;
  options.scene.height = 192;
  options.render_images = false;
  return synthetic::MakeDenseScene(options);
}

// The median distance of vertices from the plane of the nearest of the true
// surface's, in pixels' footprints.
double MedianError(const Scene& scene, const TriangleMesh& mesh) {
  const PointTree tree(scene.surface.vertices);
  std::vector<double> errors;
  const size_t stride = std::max<size_t>(1, mesh.vertices.size() / 400);
  for (size_t i = 0; i < mesh.vertices.size(); i += stride) {
    const Eigen::Vector3f& point = mesh.vertices[i];
    const uint32_t nearest =
        tree.Nearest(point, 1, std::numeric_limits<float>::infinity()).front();
    const Eigen::Vector3f offset = point - scene.surface.vertices[nearest];
    errors.push_back(std::abs(offset.dot(scene.normals[nearest])) /
                     scene.footprint);
  }
  return Percentile(50, &errors);
}

class EndToEnd : public testing::TestWithParam<const char*> {};

TEST_P(EndToEnd, TheMeshIsTheScenesSurface) {
  DenseScene dense = MakeSmallScene(GetParam());
  PointCloud& cloud = dense.fused.cloud;
  ManifoldMeshingOptions options;
  options.thinning.max_proj_dist = 2;
  // The smoothing alone is off by as much on such small images.
  ManifoldMeshingOptions unsmoothed = options;
  unsmoothed.smoothing = 0;
  const TriangleMesh shifted =
      MeshManifold(unsmoothed, cloud, dense.scene.views).mesh;
  const auto offsets = HalfPixelOffsets(cloud, dense.scene.views);
  for (size_t i = 0; i < cloud.size(); ++i) {
    cloud.positions[i] += offsets[i];
  }
  const ManifoldMesh result = MeshManifold(options, cloud, dense.scene.views);
  EXPECT_TRUE(HasManifoldLinks(result.mesh));
  EXPECT_EQ(result.report.rays.num_lost_rays, 0u);
  // Most of the raw cut's singular vertices are avoided.
  EXPECT_LE(20 * result.report.fixing.num_singular_fixed,
            result.report.fixing.num_singular_raw);
  const double error = MedianError(dense.scene, result.mesh);
  EXPECT_LT(error, 0.5);
  const TriangleMesh exact =
      MeshManifold(unsmoothed, cloud, dense.scene.views).mesh;
  EXPECT_LT(MedianError(dense.scene, exact),
            0.9 * MedianError(dense.scene, shifted));
  RecordProperty("median_error_in_pixels", std::to_string(error));
}

INSTANTIATE_TEST_SUITE_P(Shapes, EndToEnd, testing::Values("statue", "wall"));

}  // namespace colmap_ext::end_to_end_test
