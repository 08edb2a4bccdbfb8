#include "colmap_ext/jobs/mesh_tiles.h"

#include <map>
#include <mutex>

#include "tests/formats/test_files.h"
#include "tests/workspace/sphere_workspace.h"

namespace colmap_ext {
namespace make_plan_test {

namespace fs = std::filesystem;

class MakePlanTest : public testing::Test {
 protected:
  MakePlanTest() {
    sphere_.Write(workspace_);
    options_.mesher.workspace_path = workspace_.string();
    options_.output_path = plan_.string();
    options_.num_tiles = 3;
  }

  SphereWorkspace sphere_;
  TemporaryFolder folder_;
  fs::path workspace_ = folder_.Path() / "workspace";
  fs::path plan_ = folder_.Path() / "plan";
  PlannerOptions options_;
  PlanReport report_;
};

TEST_F(MakePlanTest, ADamagedPlanIsMadeAgain) {
  options_.Finish();
  MakePlan(options_, NetpbmDecoder(), {}, &report_);
  EXPECT_FALSE(report_.is_kept);
  const auto files = FilesOf(plan_);
  MakePlan(options_, NetpbmDecoder(), {}, &report_);
  EXPECT_TRUE(report_.is_kept);
  for (const char* name : {"blocks.bin", "plan.json"}) {
    const std::string bytes = ReadFile(plan_ / name);
    for (const size_t at : {size_t{0}, bytes.size() / 3, bytes.size() - 3}) {
      std::string damaged = bytes;
      damaged[at] = static_cast<char>(damaged[at] ^ 1);
      for (const std::string& other : {damaged, bytes.substr(0, at)}) {
        WriteFile(plan_ / name, other);
        PlanReport report;
        MakePlan(options_, NetpbmDecoder(), {}, &report);
        EXPECT_FALSE(report.is_kept) << name << " " << at;
        EXPECT_TRUE(FilesOf(plan_) == files) << name << " " << at;
      }
    }
  }
}

TEST_F(MakePlanTest, DecodesEachMaskOnce) {
  const fs::path masks = folder_.Path() / "masks";
  for (const SphereWorkspace::Image& image : sphere_.images) {
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
  options_.mesher.scene.mask_path = masks.string();
  options_.mesher.scene.region.text = "-0.9,-2,-2,0.9,2,2";
  options_.mesher.mask_background = true;
  options_.Finish();
  MakePlan(options_, decoder, {}, &report_);
  ASSERT_TRUE(report_.masks);
  EXPECT_EQ(report_.masks->num_masks, sphere_.images.size());
  EXPECT_GT(report_.masks->num_masked_points, 0u);
  for (const SphereWorkspace::Image& image : sphere_.images) {
    EXPECT_EQ(num_decoded[masks / (image.view.name + ".png")], 1)
        << image.view.name;
  }
}

}  // namespace make_plan_test
}  // namespace colmap_ext
