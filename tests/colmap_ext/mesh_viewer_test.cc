// mesh_viewer as a person uses it: pictures without a display, and a window on
// a display of its own, with keys and mouse.

#include <fmt/format.h>

#include "colmap_ext/colmap_compat.h"
#include "tests/colmap_ext/refiner_fixture.h"
#include "tests/gl/gl_test.h"
#include "tests/pictures/compare_pictures.h"

namespace colmap_ext::mesh_viewer_test {

namespace fs = std::filesystem;

// An image where a picture of a mesh shows it; white elsewhere.
ColorImage OnMesh(const ColorImage& mesh, ColorImage image) {
  for (size_t i = 0; i < image.pixels.size(); ++i) {
    if (mesh.pixels[i] == Color{255, 255, 255}) {
      image.pixels[i] = {255, 255, 255};
    }
  }
  return image;
}

struct MeshViewerTest : RefinerFixture {
  void SetUp() override {
    RefinerFixture::SetUp();
    std::string missing;
    try {
      const EglContext context;
    } catch (const NoGlError& error) {
      missing = error.what();
    }
    SkipWithout(missing);
  }

  // Where what is missing is not asked for.
  static void SkipWithout(const std::string& missing) {
    if (!missing.empty() && IsGlRequired()) {
      FAIL() << "COLMAP_EXT_REQUIRE_GL is 1, but: " << missing;
    }
    if (!missing.empty()) {
      GTEST_SKIP() << "the viewer is NOT TESTED here: " << missing;
    }
  }

  Outcome View(const std::string& arguments) const {
    return RunShell("cd " + Quote(folder_.Path()) + " && " +
                    CommandLine("mesh_viewer " + arguments));
  }

  ColorImage Picture(const std::string& name) const {
    const auto image = ColmapPictureDecoder().read_color(folder_.Path() / name);
    return image ? *image : ColorImage();
  }

  // The name of the n-th picture that the window saves.
  static std::string Saved(size_t n) {
    return fmt::format("mesh_viewer.{:03}.png", n);
  }

  ColorImage Screenshot(const std::string& arguments) const {
    Succeed(View(Workspace() + " --screenshot_path shot.png " + arguments));
    return Picture("shot.png");
  }
};

TEST_F(MeshViewerTest, EachModeIsAnotherPictureOrSaysWhatItMisses) {
  const ColorImage shaded = Screenshot("");
  EXPECT_EQ(shaded.width, 1024);
  EXPECT_EQ(shaded.height, 768);
  for (const char* option :
       {"--mode color", "--mode normals", "--mode confidence", "--wireframe 1",
        "--points 1", "--cameras 1", "--zoom 2"}) {
    EXPECT_GT(MeanDifference(Screenshot(option), shaded), 0.05) << option;
  }
  const Outcome outcome =
      Succeed(View(Workspace() + " --mode labels --screenshot_path shot.png"));
  EXPECT_TRUE(
      Has(outcome.out, "has no labels; facetwise_refiner --labels_path"));
}

// Half of the scene, in the same view.
TEST_F(MeshViewerTest, ShowsARegion) {
  const std::string camera = " --image_name 0000.png --width 200";
  const ColorImage whole = Screenshot(camera);
  const ColorImage half = Screenshot("--region=-9,-9,-9,0,9,9" + camera);
  size_t num_whole = 0;
  size_t num_half = 0;
  for (size_t i = 0; i < whole.pixels.size(); ++i) {
    num_whole += whole.pixels[i] != Color{255, 255, 255};
    num_half += half.pixels[i] != Color{255, 255, 255};
  }
  EXPECT_GT(num_half, num_whole / 10);
  EXPECT_LT(num_half, num_whole * 9 / 10);
  for (const char* name : {kInput, "fused.ply"}) {
    ExpectRefusal(View(PathOption("mesh_path", (path_ / name)) +
                       " --screenshot_path a.png --region 70,70,70,80,80,80"),
                  "it has no part in the region");
  }
  ExpectRefusal(View(Workspace() + " --screenshot_path a.png --region auto"),
                ".region.txt");
}

TEST_F(MeshViewerTest, TakesMeshesAndCloudsWithoutAWorkspace) {
  for (const char* name : {kInput, "fused.ply"}) {
    Succeed(View(PathOption("mesh_path", (path_ / name)) +
                 " --screenshot_path alone.png --width 200"));
    const ColorImage picture = Picture("alone.png");
    EXPECT_EQ(picture.height, 150);
    EXPECT_GT(
        MeanDifference(picture,
                       {200, 150, std::vector<Color>(30000, {255, 255, 255})}),
        5);
  }
}

// The image lies over the mesh: half of both is between them.
TEST_F(MeshViewerTest, TheCamerasImageLiesOverTheMesh) {
  const std::string name =
      fs::directory_iterator(path_ / "images")->path().filename().string();
  const std::string camera = "--image_name " + name;
  const ColorImage mesh = Screenshot(camera + " --mode color");
  const ColorImage both = Screenshot(camera + " --image_opacity 0.5");
  const ColorImage image = Screenshot(camera + " --image_opacity 1");
  EXPECT_EQ(mesh.width, 160);
  const auto photo = ColmapPictureDecoder().read_color(path_ / "images" / name);
  EXPECT_LT(MeanDifference(image, *photo), 3);
  EXPECT_GT(MeanDifference(both, image), 5);
  // The mesh has the colours that the image shows there.
  const ColorImage masked = OnMesh(mesh, *photo);
  EXPECT_LT(MeanDifference(mesh, masked), 25);
  EXPECT_GT(MeanDifference(masked, *photo), 5);
}

TEST_F(MeshViewerTest, TurntableDrawsAllAround) {
  Succeed(View(Workspace() + " --screenshot t.png --turntable 3 --width 99"));
  EXPECT_GT(MeanDifference(Picture("t.000.png"), Picture("t.001.png")), 1);
  EXPECT_GT(MeanDifference(Picture("t.001.png"), Picture("t.002.png")), 1);
  EXPECT_FALSE(fs::exists(folder_.Path() / "t.003.png"));
}

TEST_F(MeshViewerTest, RefusesWhatMakesNoSenseOrNeedsADisplay) {
  const std::string shot = " --screenshot_path shot.png ";
  ExpectRefusal(View(""), "--workspace_path or --mesh_path is required");
  ExpectRefusal(View(Workspace() + shot + "--image_name none.png"),
                "the workspace has no image none.png; one that it has is");
  ExpectRefusal(View("--mesh_path none.ply" + shot), "no such file");
  ExpectRefusal(View(Workspace() + " --turntable 3"), "need --screenshot_path");
  ExpectRefusal(View(Workspace() + " --screenshot_path no/shot.png"),
                "no/shot.png");
  ExpectRefusal(RunShell("env -u DISPLAY -u WAYLAND_DISPLAY " +
                         CommandLine("mesh_viewer" + Workspace())),
                "--screenshot_path FILE.png draws without one");
}

struct MeshViewerWindowTest : MeshViewerTest {
  void SetUp() override {
    MeshViewerTest::SetUp();
    if (IsSkipped()) {
      return;
    }
    for (const char* tool : {"Xvfb", "xdotool"}) {
      if (RunShell(std::string("command -v ") + tool).exit_code != 0) {
        SkipWithout(std::string("there is no ") + tool);
        return;
      }
    }
    if (Has(View(Workspace()).err, "built without")) {
      SkipWithout("the program was built without GLFW");
    }
  }

  // Does the steps of window_session to a command, which has to succeed.
  void Act(const std::string& arguments, const std::string& steps) const {
    WriteFile(folder_.Path() / "steps", steps);
    const Outcome outcome = Succeed(RunShell(
        "cd " + Quote(folder_.Path()) + " && " + COLMAP_EXT_WINDOW_SESSION +
        " steps " + CommandLine(arguments)));
    EXPECT_EQ(outcome.err, "");  // OpenGL has nothing to say, either.
  }
};

TEST_F(MeshViewerWindowTest, ShowsWhatTheOffscreenPictureShows) {
  Act("mesh_viewer " + Workspace(),
      "key s\nuntil mesh_viewer.001.png\nkey Escape\n");
  EXPECT_LT(MeanDifference(Picture(Saved(1)), Screenshot("")), 0.1);
}

// Each key changes the picture, and once more, or R, brings it back.
TEST_F(MeshViewerWindowTest, KeysAndMouseDoWhatTheHelpSays) {
  const std::vector<std::string> acts = {
      "key 3",
      "key 1",
      "key w",
      "key w",
      "key p",
      "key p",
      "key c",
      "key c",
      "mousemove 500 400 mousedown 1 mousemove 560 420 mouseup 1",
      "key r",
      "mousemove 500 400 mousedown 3 mousemove 560 420 mouseup 3",
      "key r",
      "click 4",
      "key r",
      "click --repeat 2 --delay 80 1"};
  std::string steps = "key s\nuntil mesh_viewer.001.png\nsleep 2\n";
  for (size_t i = 0; i < acts.size(); ++i) {
    steps +=
        acts[i] + "\nsleep 1.2\nkey h\nkey s\nuntil " + Saved(i + 2) + "\n";
  }
  Act("mesh_viewer " + Workspace(), steps + "key Escape\n");
  const ColorImage first = Picture(Saved(1));
  for (size_t i = 0; i < acts.size(); ++i) {
    const double difference = MeanDifference(Picture(Saved(i + 2)), first);
    if (i % 2 == 0) {
      EXPECT_GT(difference, 0.001) << acts[i];
    } else {
      EXPECT_LT(difference, 0.001) << acts[i];
    }
  }
}

TEST_F(MeshViewerWindowTest, FliesToCamerasWithTheirIntrinsics) {
  Act("mesh_viewer " + Workspace() + " --width 640 --height 480",
      "key s\nuntil mesh_viewer.001.png\nsleep 2\nkey Right\n"
      "sleep 2\nkey s\nuntil mesh_viewer.002.png\nkey g\nsleep 2\n"
      "key plus\nkey s\nuntil mesh_viewer.003.png\nkey Escape\n");
  std::vector<std::string> names;
  for (const auto& entry : fs::directory_iterator(path_ / "images")) {
    names.push_back(entry.path().filename().string());
  }
  const std::string camera = "--width 640 --height 480 --image_name " +
                             *std::ranges::min_element(names);
  EXPECT_LT(MeanDifference(Picture(Saved(2)), Screenshot(camera)), 0.1);
  EXPECT_LT(MeanDifference(Picture(Saved(3)),
                           Screenshot(camera + " --image_opacity 0.6")),
            0.1);
}

TEST_F(MeshViewerWindowTest, FollowsTheSizeOfTheWindow) {
  Act("mesh_viewer " + Workspace(),
      "search --name mesh_viewer windowsize 500 410\nsleep 1\n"
      "key s\nuntil mesh_viewer.001.png\nkey Escape\n");
  EXPECT_EQ(Picture(Saved(1)).width, 500);
  EXPECT_EQ(Picture(Saved(1)).height, 410);
}

TEST_F(MeshViewerWindowTest, MayBeClosedWhileItLoads) {
  Act("mesh_viewer " + Workspace(), "key Escape\n");
}

TEST_F(MeshViewerWindowTest, WorksWithoutImagesAndWithAnotherMesh) {
  fs::remove_all(path_ / "images");
  const fs::path other = folder_.Path() / "other.ply";
  fs::copy(meshed_->folder.Path() / kInput, other);
  WriteFile(VisibilityPath(other), "of another mesh");
  Act("mesh_viewer " + Workspace() + PathOption("mesh_path", other),
      "key s\nuntil mesh_viewer.001.png\nsleep 2\nkey Right\n"
      "key g\nkey c\nmousemove 500 400\n"
      "click --repeat 2 --delay 80 1\nsleep 2\nkey Escape\n");
}

// What the refinement writes does not depend on who looks, pauses or leaves.
TEST_F(MeshViewerWindowTest, ARefinementIsTheSameWhenItIsWatched) {
  const std::string command = "facetwise_refiner " + Workspace() +
                              " @backend cpu @levels 2 @iterations 3 --viewer ";
  Succeed(RunProgram(command + "0"));
  const std::string alone = ReadFile(path_ / kOutput);
  fs::remove(path_ / kOutput);
  Act(command + "1", "sleep 2\nkey t\nsleep 1\nkey t\nsleep 1\nkey Escape\n");
  EXPECT_EQ(ReadFile(path_ / kOutput), alone);
}

}  // namespace colmap_ext::mesh_viewer_test
