#include "colmap_ext/jobs/make_plan.h"

#include <map>
#include <mutex>

#include "tests/formats/test_files.h"
#include "tests/workspace/sphere_workspace.h"

namespace colmap_ext {
namespace make_plan_test {

namespace fs = std::filesystem;

TEST(MakePlan, DecodesEachMaskOnce) {
  const TemporaryFolder folder;
  const fs::path workspace = folder.Path() / "workspace";
  const fs::path masks = folder.Path() / "masks";
  const SphereWorkspace sphere;
  sphere.Write(workspace);
  for (const SphereWorkspace::Image& image : sphere.images) {
    const View& view = image.view;
    std::string pixels(static_cast<size_t>(view.width) * view.height, '\xff');
    pixels.replace(0, pixels.size() / 4, pixels.size() / 4, '\0');
    WriteFile(masks / (view.name + ".png"),
              "P5\n" + std::to_string(view.width) + " " +
                  std::to_string(view.height) + "\n255\n" + pixels);
  }
  std::map<fs::path, int> num_decoded;
  std::mutex mutex;
  PictureDecoder decoder = NetpbmDecoder();
  decoder.read_gray = [&, read = decoder.read_gray](const fs::path& path) {
    const std::scoped_lock lock(mutex);
    ++num_decoded[path];
    return read(path);
  };
  PlannerOptions options;
  options.mesher.workspace_path = workspace.string();
  options.mesher.scene.mask_path = masks.string();
  options.mesher.scene.region.text = "-0.9,-2,-2,0.9,2,2";
  options.mesher.mask_background = true;
  options.output_path = (folder.Path() / "plan").string();
  options.num_tiles = 3;
  options.Finish();
  PlanReport report;
  MakePlan(options, decoder, {}, &report);
  ASSERT_TRUE(report.masks);
  EXPECT_EQ(report.masks->num_masks, sphere.images.size());
  EXPECT_GT(report.masks->num_masked_points, 0u);
  for (const SphereWorkspace::Image& image : sphere.images) {
    EXPECT_EQ(num_decoded[masks / (image.view.name + ".png")], 1)
        << image.view.name;
  }
}

}  // namespace make_plan_test
}  // namespace colmap_ext
