#include <filesystem>

#if __has_include(<base/reconstruction.h>)
#include <base/reconstruction.h>
#endif

#include "tests/formats/test_files.h"
#include "tests/workspace/sphere_workspace.h"
#include "workspace/sparse_model.h"

namespace colmap_ext {
namespace {

#if __has_include(<base/reconstruction.h>)
// What COLMAP itself writes and reads is what we read.
TEST(SparseModel, AgreesWithColmap) {
  const TemporaryFolder folder;
  SphereWorkspace sphere;
  sphere.images.resize(3);
  sphere.points.resize(20);
  sphere.point_images.assign(20, {0, 2});
  WriteFile(folder.Path() / "cameras.bin", sphere.CamerasBinary());
  WriteFile(folder.Path() / "images.bin", sphere.ImagesBinary());
  WriteFile(folder.Path() / "points3D.bin", sphere.Points3DBinary());
  colmap::Reconstruction reconstruction;
  reconstruction.ReadBinary(folder.Path().string());
  for (const bool is_binary : {true, false}) {
    const std::filesystem::path path =
        folder.Path() / (is_binary ? "binary" : "text");
    std::filesystem::create_directory(path);
    is_binary ? reconstruction.WriteBinary(path.string())
              : reconstruction.WriteText(path.string());
    const SparseModel model = ReadSparseModel(path);
    colmap::Reconstruction reread;
    reread.Read(path.string());
    ASSERT_EQ(model.images.size(), reread.NumRegImages());
    for (size_t i = 0; i < model.images.size(); ++i) {
      EXPECT_EQ(model.images[i].image_id, reread.RegImageIds()[i]);
      const colmap::Image& image = reread.Image(model.images[i].image_id);
      EXPECT_EQ(model.images[i].name, image.Name());
      EXPECT_TRUE(
          model.images[i].cam_from_world_rotation.toRotationMatrix().isApprox(
              image.RotationMatrix()));
      EXPECT_TRUE(
          model.images[i].cam_from_world_translation.isApprox(image.Tvec()));
    }
    EXPECT_EQ(model.point_positions.size(), reread.NumPoints3D());
    EXPECT_EQ(model.cameras.at(7).fx, reread.Camera(7).FocalLengthX());
  }
}
#endif

}  // namespace
}  // namespace colmap_ext
