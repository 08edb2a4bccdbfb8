// facetwise_refiner as a user runs it: exit codes, messages, files.

#include <cstring>
#include <limits>
#include <map>
#include <set>

#include <fmt/format.h>
#include <Eigen/Geometry>

#include "formats/picture_files.h"
#include "tests/colmap_ext/refiner_fixture.h"
#include "tests/mesh/known_meshes.h"
#include "workspace/sparse_model.h"

namespace colmap_ext::facetwise_refiner_test {

namespace fs = std::filesystem;

using FacetwiseRefinerTest = RefinerFixture;

// Plots and pictures, which do not depend on time and memory.
std::string PicturesOf(const std::string& page) {
  const size_t start = page.find("<h2>Iterations");
  return page.substr(start, page.find("<h2>Figures") - start);
}

// A page with plots and all pictures.
void ExpectPage(const std::string& page, const Outcome& outcome) {
  ExpectPageOfRun(page, outcome);
  EXPECT_TRUE(
      HasAll(page, {"Mean ZNCC by iteration", "<h3>Photograph", "<h3>Before",
                    "<h3>After", "<h3>Labels", "<h3>Confidence"}));
  EXPECT_FALSE(Has(page, "there is none"));
  EXPECT_EQ(Count(page, "<img "), 15);
}

TEST_F(FacetwiseRefinerTest, RefinesAWorkspace) {
  const std::string before = List(path_);
  const std::string images = ReadFile(path_ / "sparse" / "images.bin");
  const Outcome outcome = Succeed(Refine(" @refine_cameras poses"));
  EXPECT_EQ(outcome.err, "");
  fs::path output = path_ / kOutput;
  ExpectGoodMesh(output);
  EXPECT_LT(Error(output), Error(path_ / kInput));
  EXPECT_TRUE(HasAll(
      outcome.out,
      {"memory, estimated", "computed by", "full size, iteration 1: energy",
       "mean ZNCC", "pairs", "self-intersections", "peak memory", "its .vis",
       "moved by, px", "belong together"}));
  EXPECT_EQ(ReadFile(path_ / "sparse" / "images.bin"), images);
  const fs::path refined = path_ / "sparse-refined";
  EXPECT_EQ(List(refined), List(path_ / "sparse"));
  const Outcome again = Refine(PathOption("sparse_path", refined));
  EXPECT_EQ(again.exit_code, 1);
  EXPECT_TRUE(Has(again.err, "--sparse_path is where"));
  Succeed(Refine(PathOption("sparse_path", refined) + " @refine_cameras none"));
  fs::remove(output);
  fs::remove(VisibilityPath(output));
  fs::remove_all(refined);
  EXPECT_EQ(List(path_), before) << "nothing else was written";
}

TEST_F(FacetwiseRefinerTest, WritesNoCamerasThatStayAsTheyAre) {
  const fs::path refined = path_ / "sparse-refined";
  const std::string quick = " @levels 1 @iterations 1";
  Outcome outcome = Refine(quick);
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_FALSE(fs::exists(refined));
  EXPECT_FALSE(Has(outcome.out, "belong together"));
  EXPECT_TRUE(Has(outcome.out, "unchanged, "));
  EXPECT_FALSE(Has(outcome.out, "of an earlier run"));
  Succeed(Refine(quick + " @refine_cameras poses"));
  const std::string images = ReadFile(refined / "images.bin");
  outcome = Refine(quick);
  EXPECT_TRUE(Has(outcome.out, "sparse-refined is of an earlier run"));
  EXPECT_TRUE(ReadFile(refined / "images.bin") == images);
  outcome = Refine(quick + " @refine_cameras none" +
                   Option("sparse_path", "sparse-refined"));
  EXPECT_FALSE(Has(outcome.out, "of an earlier run"));
}

TEST_F(FacetwiseRefinerTest, LeavesTheMeshWhereThePosesAreTooInaccurate) {
  // Inaccurate poses, and a mesh that is right.
  WriteWorkspace(MakeStatue(), 1, path_.string());
  fs::rename(path_ / "sparse", path_ / "sparse-true");
  WriteWorkspace(MakeStatue(1), 1, path_.string());
  TriangleMesh mesh = ReadPlyMesh(path_ / "truth" / "mesh.ply");
  mesh.facets.pop_back();
  WriteColoredMesh(path_ / "input.ply", mesh, {});
  const std::string arguments = Option("input_path", "input.ply") +
                                Option("output_path", "output.ply") +
                                " @levels 1 @iterations 1 @close_holes 9";
  const std::string refine = " @refine_cameras ";
  const std::string held = "too inaccurate";
  const auto expect_held = [&](const std::string& more) {
    const Outcome outcome = Succeed(Refine(arguments + more));
    EXPECT_TRUE(Has(outcome.out, held));
    const TriangleMesh before = ReadPlyMesh(path_ / "input.ply");
    const TriangleMesh after = ReadPlyMesh(path_ / "output.ply");
    EXPECT_EQ(after.facets, before.facets);
    EXPECT_TRUE(after.vertices == before.vertices);
    return outcome.out;
  };
  const auto expect_refined = [&](const std::string& more) {
    EXPECT_FALSE(Has(Succeed(Refine(arguments + more)).out, held));
  };
  EXPECT_TRUE(Has(expect_held(refine + "none"), "refine_cameras poses"));
  expect_refined(refine + "poses");
  expect_refined(Option("sparse_path", "sparse-true"));
}

// Where a frame's pose and its images' are, relative to each other.
std::vector<Eigen::Isometry3d> SensorsFromRigs(const SparseModel& model) {
  const auto pose = [](const Eigen::Quaterniond& rotation,
                       const Eigen::Vector3d& translation) {
    return Eigen::Isometry3d(Eigen::Translation3d(translation) * rotation);
  };
  const std::map<uint32_t, size_t> indices = ImageIndices(model);
  std::vector<Eigen::Isometry3d> sensors;
  for (const SparseFrame& frame : model.frames) {
    for (const uint32_t image_id : frame.image_ids) {
      const SparseImage& image = model.images[indices.at(image_id)];
      sensors.push_back(
          pose(image.cam_from_world_rotation,
               image.cam_from_world_translation) *
          pose(frame.rig_from_world_rotation, frame.rig_from_world_translation)
              .inverse());
    }
  }
  return sensors;
}

TEST_F(FacetwiseRefinerTest, MovesTheCamerasOfARigTogether) {
  const fs::path sparse = path_ / "sparse";
  SparseModel model = ReadSparseModel(sparse, SparseDetail::kAll);
  ASSERT_GT(model.images.size(), 3);
  model.rigs = {{1, {{0, 1}, {0, 2, 1}}}};
  model.frames.clear();
  for (size_t i = 0; i + 1 < model.images.size(); i += 2) {
    const SparseImage& image = model.images[i];
    const uint32_t next = model.images[i + 1].image_id;
    model.frames.push_back({static_cast<uint32_t>(i),
                            {image.image_id, next},
                            1,
                            image.cam_from_world_rotation,
                            image.cam_from_world_translation,
                            {{0, 1, image.image_id}, {0, 2, next}}});
  }
  WriteSparseModel(sparse, model);
  const std::string rigs = ReadFile(sparse / "rigs.bin");
  Succeed(Refine(" @refine_cameras poses"));
  const SparseModel refined =
      ReadSparseModel(path_ / "sparse-refined", SparseDetail::kAll);
  EXPECT_EQ(ReadFile(path_ / "sparse-refined" / "rigs.bin"), rigs);
  EXPECT_NE(refined.frames[0].rig_from_world_translation,
            model.frames[0].rig_from_world_translation);
  const std::vector<Eigen::Isometry3d> before = SensorsFromRigs(model);
  const std::vector<Eigen::Isometry3d> after = SensorsFromRigs(refined);
  ASSERT_EQ(after.size(), before.size());
  for (size_t i = 0; i < before.size(); ++i) {
    EXPECT_TRUE(after[i].isApprox(before[i], 1e-9)) << i;
  }
}

TEST_F(FacetwiseRefinerTest, GivesTheSameBytesOnAnyNumberOfThreads) {
  Succeed(Refine(" @num_threads 1"));
  const std::string bytes = BytesOf(path_ / kOutput);
  Succeed(Refine(" @num_threads 2"));
  EXPECT_TRUE(BytesOf(path_ / kOutput) == bytes);
}

TEST_F(FacetwiseRefinerTest, WorksInLittleMemory) {
  const std::string arguments = " @levels 2 @iterations 2";
  Succeed(Refine(arguments));
  const std::string mesh = ReadFile(path_ / kOutput);
  Succeed(Refine(arguments + " --max_memory_gb 1e-9"));
  EXPECT_EQ(ReadFile(path_ / kOutput), mesh);
}

TEST_F(FacetwiseRefinerTest, RefinesInOtherWays) {
  const auto refine = [&](const std::string& option) {
    Succeed(Refine(" @levels 1 @iterations 2" + option));
    ExpectGoodMesh(path_ / kOutput);
    return ReadFile(path_ / kOutput);
  };
  const std::string by_default = refine("");
  std::set<std::string> results = {by_default};
  for (const std::string option :
       {"solver descent", "pair_selection classical", "pairs_per_face 3",
        "final_pairs_per_face 1", "occlusion_masking 0", "window 7",
        "image_scale 0.5"}) {
    EXPECT_TRUE(results.insert(refine(" @" + option)).second) << option;
  }
  EXPECT_TRUE(refine(" @solver gauss_newton") == by_default);
}

TEST_F(FacetwiseRefinerTest, DrawsByOpenGl) {
  const Outcome outcome = Refine(" @backend gl @levels 2 @iterations 2");
  if (Has(outcome.err, "backend cpu needs none")) {
    GTEST_SKIP() << "there is no OpenGL: " << outcome.err;
  }
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_TRUE(Has(outcome.out, "OpenGL, "));
  EXPECT_EQ(outcome.out.find("(software)") != std::string::npos,
            outcome.out.find("drawn by software") != std::string::npos);
  ExpectGoodMesh(path_ / kOutput);
}

TEST_F(FacetwiseRefinerTest, WritesReportAndLabels) {
  const Outcome outcome = Succeed(Refine(Option("report_path", "energy.csv") +
                                         Option("labels_path", "labels.ply") +
                                         " @levels 2 @iterations 2"));
  const std::string csv = ReadFile(path_ / "energy.csv");
  EXPECT_TRUE(csv.starts_with("level,final,iteration,energy,"));
  EXPECT_TRUE(HasAll(csv, {"\n1,0,", "\n0,0,", "\n0,1,"}));
  EXPECT_TRUE(HasNone(csv, {"\n1,1,", "\n2,"}));
  ExpectGoodMesh(path_ / kOutput);
  const std::string labels = ReadFile(path_ / "labels.ply");
  EXPECT_TRUE(HasAll(labels, {"comment label 0: 000", "property int label\n"}));
  EXPECT_EQ(ReadPlyMesh(path_ / "labels.ply").facets.size(),
            ReadPlyMesh(path_ / kOutput).facets.size());
  ExpectPage(ReadFile(path_ / "energy.html"), outcome);
}

TEST_F(FacetwiseRefinerTest, WritesAPageOfWhateverFilesAreCalled) {
  const std::string name = "<b> & 'x' \xc3\xa4\xff.html";
  const std::string arguments =
      Option("report_path", name) +
      " @refine_cameras poses @levels 1 @iterations 2";
  const Outcome outcome = Succeed(Refine(arguments));
  const std::string page = ReadFile(path_ / name);
  ExpectPage(page, outcome);
  EXPECT_TRUE(HasAll(page, {"&lt;b&gt; &amp; &#39;x&#39; \xc3\xa4\xef\xbf\xbd",
                            "moved by, px"}));
  EXPECT_TRUE(fs::exists(fs::path(path_ / name).replace_extension(".csv")));
  Succeed(Refine(arguments));
  EXPECT_EQ(PicturesOf(ReadFile(path_ / name)), PicturesOf(page));
}

TEST_F(FacetwiseRefinerTest, FindsTheWorkspaceOfAutomaticReconstructor) {
  const fs::path top = folder_.Path() / "top";
  fs::create_directories(top / "dense");
  fs::rename(path_, top / "dense" / "0");
  path_ = top;
  Succeed(Refine(" @levels 1"));
  EXPECT_TRUE(fs::exists(top / "dense" / "0" / kOutput));
}

TEST_F(FacetwiseRefinerTest, TakesMeshesOfOtherTools) {
  const ColoredMesh mesh = ReadColoredPlyMesh(path_ / kInput);
  WriteColoredMesh(path_ / "other.ply", mesh.mesh, {});
  const std::string arguments = Option("input_path", "other.ply") +
                                Option("output_path", "other-refined.ply");
  EXPECT_TRUE(Has(Succeed(Refine(arguments)).out, "nearest fused points"));
  ExpectGoodMesh(path_ / "other-refined.ply");
  EXPECT_LT(Error(path_ / "other-refined.ply"), Error(path_ / kInput));
  EXPECT_FALSE(fs::exists(path_ / kOutput));
  fs::remove(path_ / "fused.ply");
  fs::remove(path_ / kInput);
  ExpectRefused(arguments, "not known which images see the mesh");
}

TEST_F(FacetwiseRefinerTest, NeedsNoFusedPointsBesideAVis) {
  fs::remove(path_ / "fused.ply");
  fs::remove(path_ / "fused.ply.vis");
  // Few vertices of a mesh do not tell the order of the images.
  EXPECT_TRUE(Has(Succeed(Refine(" --image_order file")).out,
                  "pairs of images by the mesh's vertices"));
  ExpectGoodMesh(path_ / kOutput);
  EXPECT_LT(Error(path_ / kOutput), Error(path_ / kInput));
}

TEST_F(FacetwiseRefinerTest, SplitsWhatIsNotManifold) {
  ColoredMesh read = ReadColoredPlyMesh(path_ / kInput);
  TriangleMesh& mesh = read.mesh;
  const Facet facet = mesh.facets[0];
  const auto tip = static_cast<uint32_t>(mesh.vertices.size());
  mesh.vertices.emplace_back(mesh.vertices[facet[0]] +
                             Eigen::Vector3f(0, 0, 0.01f));
  mesh.vertices.emplace_back(std::numeric_limits<float>::quiet_NaN(), 0, 0);
  mesh.facets.push_back({facet[0], facet[1], tip});  // a fin
  mesh.facets.push_back({facet[0], facet[1], tip + 1});
  mesh.facets.push_back({facet[0], facet[0], facet[1]});
  mesh.facets.push_back(facet);
  read.colors.resize(mesh.vertices.size());
  WriteColoredMesh(path_ / "soup.ply", mesh, read.colors);
  const Outcome outcome =
      Succeed(Refine(Option("input_path", "soup.ply") +
                     Option("output_path", "refined.ply") + " @levels 1"));
  EXPECT_TRUE(
      HasAll(outcome.out, {"not manifold", "split off", "repeat a vertex",
                           "duplicate faces", "not finite"}));
  ExpectGoodMesh(path_ / "refined.ply");
}

TEST_F(FacetwiseRefinerTest, ListsImagesThatCanNotBeUsed) {
  const fs::path images = path_ / "images";
  fs::remove(images / "0000.png");
  fs::copy_file(images / "0002.png", images / "0001.png",
                fs::copy_options::overwrite_existing);
  const std::string bytes = ReadFile(images / "0002.png");
  WriteFile(images / "0002.png", bytes.substr(0, bytes.size() / 2));
  std::string ppm = "P6\n100 120\n255\n";
  ppm.resize(ppm.size() + 3 * 100 * 120, 'x');
  WriteFile(images / "0003.png", ppm);
  const Outcome refused = Refine();
  for (const char* text :
       {"3 of 8", "0000.png no such file", "0002.png cannot be read",
        "0003.png is 100 x 120 pixels, but its camera is 160 x 120",
        "skip_missing_images"}) {
    ExpectRefusal(refused, text);
  }
  EXPECT_TRUE(Has(Succeed(Refine(" @skip_missing_images 1" +
                                 Option("labels_path", "labels.ply")))
                      .out,
                  "images ignored"));
  ExpectGoodMesh(path_ / kOutput);
  const std::string labels = ReadFile(path_ / "labels.ply");
  EXPECT_TRUE(HasNone(labels, {"0000.png", "0002.png", "0003.png"}));
  fs::remove(path_ / kOutput);
  fs::remove_all(images);
  ExpectRefused(" @skip_missing_images 1", "fewer than two images");
}

TEST_F(FacetwiseRefinerTest, RefinesARegion) {
  const auto box_of = [](const TriangleMesh& mesh) {
    Eigen::AlignedBox3f box;
    for (const Eigen::Vector3f& vertex : mesh.vertices) {
      box.extend(vertex);
    }
    return box;
  };
  const double middle = box_of(ReadPlyMesh(path_ / kInput)).center().z();
  EXPECT_TRUE(
      Has(Succeed(Refine(fmt::format(" --region=-9,-9,{},9,9,9", middle) +
                         " @levels 1 @iterations 2"))
              .out,
          "region, center"));
  const TriangleMesh refined = ReadPlyMesh(path_ / kOutput);
  EXPECT_TRUE(Analyze(refined).IsManifold());
  EXPECT_NEAR(box_of(refined).min().z(), middle, 1e-4);
  fs::remove(path_ / kOutput);
  ExpectRefused(" --region 50,50,50,60,60,60",
                "none of its faces lies in the region");
}

TEST_F(FacetwiseRefinerTest, LeavesOutWhatIsMasked) {
  const fs::path masks = path_ / "masks";
  for (const fs::directory_entry& entry :
       fs::directory_iterator(path_ / "images")) {
    View view;
    view.name = entry.path().filename().string();
    view.width = 160;
    view.height = 120;
    WriteMask(masks, view, 0.5);
  }
  const std::string arguments =
      Option("mask_path", "masks") + " @levels 1 @iterations 2";
  for (const char* scale : {"1", "0.5"}) {
    EXPECT_TRUE(Has(Succeed(Refine(arguments + " @image_scale " + scale)).out,
                    "points masked in all views"));
    EXPECT_TRUE(Analyze(ReadPlyMesh(path_ / kOutput)).IsManifold());
  }
  fs::remove(path_ / kOutput);
  fs::remove_all(masks);
  ExpectRefused(arguments, "no such folder of masks");
}

TEST_F(FacetwiseRefinerTest, RefusesFilesThatAreMissingOrDoNotFit) {
  ExpectRefusal(Run("--workspace_path /none"), "no such folder");
  const auto expect_refused = [this](const std::string& mesh,
                                     const std::string& message) {
    ExpectRefused(Option("input_path", mesh) + Option("output_path", "out.ply"),
                  message);
  };
  expect_refused("none.ply", "no such file");
  ExpectRefused(Option("input_path", kInput) + Option("output_path", kInput),
                "is to be refined");
  const fs::path visibility_path = VisibilityPath(path_ / kInput);
  const std::string visibility = ReadFile(visibility_path);
  WriteFile(visibility_path, visibility.substr(0, visibility.size() - 1));
  ExpectRefused("", "truncated");
  std::string other = visibility;
  const uint32_t no_image = 77;
  std::memcpy(other.data() + 12, &no_image, sizeof(no_image));
  WriteFile(visibility_path, other);
  ExpectRefused("", "lists image 77");
  other = visibility;
  ++other[0];
  WriteFile(visibility_path, other);
  ExpectRefused("", "was the mesh edited?");
  WriteColoredMesh(path_ / "points.ply", {{{0, 0, 0}}, {}}, {});
  expect_refused("points.ply", "no faces");
  WriteColoredMesh(path_ / "far.ply",
                   Shifted(ReadPlyMesh(path_ / kInput), {1e9f, 1e9f, 1e9f}),
                   {});
  expect_refused("far.ply", "too large for 32-bit floats");
  fs::remove(path_ / kInput);
  ExpectRefused("", "delaunay_manifold_mesher` first");
  fs::remove(path_ / "fused.ply");
  ExpectRefused("", "delaunay_manifold_mesher --workspace_path");
}

TEST_F(FacetwiseRefinerTest, OnAFullDiskAllFilesStayAsTheyWere) {
  const std::string command =
      CommandOf(Workspace() + Option("labels_path", "labels.ply") +
                Option("report_path", "steps.csv") +
                " @levels 1 @iterations 1 --region auto @refine_cameras poses");
  Succeed(RunShell(command));
  uintmax_t largest = 0;
  for (const char* name :
       {kOutput, "meshed-refined.ply.vis", "meshed-refined.region.txt",
        "sparse-refined/points3D.bin", "labels.ply", "steps.csv",
        "steps.html"}) {
    largest = std::max(largest, fs::file_size(path_ / name));
    WriteFile(path_ / name, kEarlierOutput);
  }
  const auto before = FilesOf(path_);
  // The page has the times of the run, so that its size varies.
  for (const uintmax_t size : {largest / 100, largest / 10, largest / 2}) {
    ExpectFullDisk(command, size);
    EXPECT_TRUE(FilesOf(path_) == before) << size;
  }
}

TEST_F(FacetwiseRefinerTest, RefusesToReplaceWhatItReads) {
  const auto before = FilesOf(path_);
  for (const auto& [option, name] : {std::pair("output_path", "fused.ply"),
                                     {"labels_path", kInput},
                                     {"output_path", "fused.ply.vis"},
                                     {"output_path", "images/0000.png"},
                                     {"output_path", "sparse/cameras.bin"}}) {
    ExpectRefusal(Refine(Option(option, name)), "would be replaced");
  }
  ExpectRefused(Option("labels_path", kOutput), "two outputs");
  EXPECT_TRUE(FilesOf(path_) == before);
}

TEST_F(FacetwiseRefinerTest, RefusesPlacesThatCanNotBeWrittenBeforeTheWork) {
  WriteFile(path_ / kInput, "not read");
  for (const char* option : {"output_path", "report_path", "labels_path"}) {
    for (const char* place : {"/proc/file.ply", "/dev/null/file.ply"}) {
      ExpectRefused(" --" + std::string(option) + " " + std::string(place),
                    "cannot be written");
    }
  }
}

}  // namespace colmap_ext::facetwise_refiner_test
