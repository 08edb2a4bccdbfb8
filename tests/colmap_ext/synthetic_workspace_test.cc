// The synthetic workspaces, read back and meshed as a user's are.

#include <algorithm>
#include <map>
#include <utility>

#include "colmap_ext/colmap_compat.h"
#include "formats/read_ply.h"
#include "tests/colmap_ext/run_shell.h"
#include "tests/formats/test_files.h"
#include "tests/synthetic/write_workspace.h"
#include "workspace/workspace.h"

namespace colmap_ext {
namespace synthetic_workspace_test {

namespace fs = std::filesystem;

synthetic::DenseScene MakeSmallScene(const std::string& shape) {
  synthetic::DenseSceneOptions options;
  options.scene.shape = shape;
  options.scene.width = 120;
  options.scene.height = 90;
  options.keep_depth_maps = true;
  return MakeDenseScene(options);
}

class SyntheticWorkspaceTest : public testing::TestWithParam<const char*> {
 protected:
  SyntheticWorkspaceTest() : scene_(MakeSmallScene(GetParam())) {
    WriteWorkspace(scene_, 1, path_.string());
  }

  TemporaryFolder folder_;
  fs::path path_ = folder_.Path() / "workspace";
  const synthetic::DenseScene scene_;
};

TEST_P(SyntheticWorkspaceTest, IsReadAsItWasMade) {
  const Workspace workspace = ReadWorkspace(path_, {}, ColmapPictureDecoder());
  EXPECT_TRUE(workspace.report.is_order_verified);
  EXPECT_EQ(workspace.report.num_missing_images, 0);
  EXPECT_EQ(workspace.report.num_rescaled_images, 0);
  EXPECT_EQ(workspace.sparse_points.size(), scene_.sparse_points.size());
  const std::vector<View>& views = scene_.scene.views;
  ASSERT_EQ(workspace.views.size(), views.size());
  std::map<std::string, size_t> index_of_name;
  for (size_t i = 0; i < views.size(); ++i) {
    index_of_name[views[i].name] = i;
  }
  for (const View& view : workspace.views) {
    const View& truth = views[index_of_name.at(view.name)];
    EXPECT_TRUE(view.Center().isApprox(truth.Center(), 1e-9));
    EXPECT_EQ(view.fx, truth.fx);
    EXPECT_EQ(view.width, truth.width);
  }
  const PointCloud& cloud = scene_.fused.cloud;
  EXPECT_EQ(workspace.cloud.positions, cloud.positions);
  EXPECT_EQ(workspace.cloud.colors, cloud.colors);
  ASSERT_EQ(workspace.cloud.views.offsets, cloud.views.offsets);
  for (size_t i = 0; i < cloud.size(); ++i) {
    std::vector<uint32_t> seen_by;
    for (const uint32_t view : workspace.cloud.views[i]) {
      seen_by.push_back(index_of_name.at(workspace.views[view].name));
    }
    std::sort(seen_by.begin(), seen_by.end());
    const auto row = cloud.views[i];
    EXPECT_TRUE(
        std::equal(seen_by.begin(), seen_by.end(), row.begin(), row.end()));
  }
}

// COLMAP's form: the size as text, then the depths row by row.
TEST_P(SyntheticWorkspaceTest, HasDepthMapsInTheFormOfColmap) {
  for (size_t i = 0; i < scene_.scene.views.size(); ++i) {
    const fs::path name = fs::path("depth_maps") /
                          (scene_.scene.views[i].name + ".geometric.bin");
    for (const auto& [folder, depths] :
         {std::pair("truth", scene_.visible[i].depths),
          std::pair("stereo", scene_.depth_maps[i].depths)}) {
      std::string expected = "120&90&1&";
      for (const float depth : depths) {
        Append(depth, &expected);
      }
      EXPECT_EQ(ReadFile(path_ / folder / name), expected);
    }
  }
}

TEST_P(SyntheticWorkspaceTest, IsMeshed) {
  Succeed(RunProgram("delaunay_manifold_mesher" +
                     PathOption("workspace_path", path_)));
  const PlyCloud mesh = ReadPlyCloud(path_ / "meshed-delaunay-manifold.ply");
  EXPECT_GT(mesh.positions.size(), 500);
}

INSTANTIATE_TEST_SUITE_P(Scenes, SyntheticWorkspaceTest,
                         testing::Values("statue", "wall", "grid"));

}  // namespace synthetic_workspace_test
}  // namespace colmap_ext
