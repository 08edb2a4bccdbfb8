// facetwise_refiner as a user runs it: exit codes, messages, files.

#include <cstring>
#include <limits>
#include <set>

#include <fmt/format.h>

#include "formats/encode_png.h"
#include "formats/picture_size.h"
#include "tests/colmap_ext/page_of_run.h"
#include "tests/colmap_ext/refiner_fixture.h"
#include "tests/workspace/sphere_workspace.h"
#include "workspace/sparse_model.h"

namespace colmap_ext {
namespace facetwise_refiner_test {

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
  for (const char* text :
       {"Energy by iteration", "Mean ZNCC by iteration", "<h3>Photograph",
        "<h3>Before", "<h3>After", "<h3>Labels", "<h3>Confidence"}) {
    EXPECT_NE(page.find(text), std::string::npos) << text;
  }
  EXPECT_EQ(page.find("there is none"), std::string::npos);
  EXPECT_EQ(NumPictures(page), 15);
}

TEST_F(FacetwiseRefinerTest, ExplainsItsOptions) {
  const Outcome outcome = Run("-h");
  EXPECT_EQ(outcome.exit_code, 0);
  for (const char* option :
       {"--workspace_path", "--input_path", "--output_path", "--report_path",
        "--labels_path", "--resume", "--FacetwiseRefinement.levels",
        "--FacetwiseRefinement.window", "--FacetwiseRefinement.backend",
        "--FacetwiseRefinement.skip_missing_images"}) {
    EXPECT_NE(outcome.out.find(option), std::string::npos) << option;
  }
}

TEST_F(FacetwiseRefinerTest, RefinesAWorkspace) {
  const std::string before = List(path_);
  const std::string images = ReadFile(path_ / "sparse" / "images.bin");
  const Outcome outcome =
      Run(Workspace() + " --FacetwiseRefinement.refine_cameras poses");
  ASSERT_EQ(outcome.exit_code, 0) << outcome.out << outcome.err;
  EXPECT_EQ(outcome.err, "");
  fs::path output = path_ / kOutput;
  ExpectGoodMesh(output);
  EXPECT_LT(Error(output), Error(path_ / kInput));
  for (const char* text :
       {"computed by", "full size, iteration 1: energy", "mean ZNCC", "pairs",
        "self-intersections", "flipped faces", "peak memory", "its .vis",
        "moved by, px", "belong together"}) {
    EXPECT_NE(outcome.out.find(text), std::string::npos) << text;
  }
  EXPECT_EQ(ReadFile(path_ / "sparse" / "images.bin"), images);
  const fs::path refined = path_ / "sparse-refined";
  EXPECT_EQ(List(refined), List(path_ / "sparse"));
  const Outcome again =
      Run(Workspace() + " --sparse_path " + Quote(refined.string()));
  EXPECT_EQ(again.exit_code, 1);
  EXPECT_NE(again.err.find("--sparse_path is where"), std::string::npos)
      << again.err;
  EXPECT_EQ(Run(Workspace() + " --sparse_path " + Quote(refined.string()) +
                " --FacetwiseRefinement.refine_cameras none")
                .exit_code,
            0);
  fs::remove(output);
  fs::remove(VisibilityPath(output));
  fs::remove_all(refined);
  EXPECT_EQ(List(path_), before) << "nothing else was written";
}

TEST_F(FacetwiseRefinerTest, WritesNoCamerasThatStayAsTheyAre) {
  const fs::path refined = path_ / "sparse-refined";
  const std::string quick = Workspace() +
                            " --FacetwiseRefinement.levels 1"
                            " --FacetwiseRefinement.iterations 1";
  Outcome outcome = Run(quick);
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_FALSE(fs::exists(refined));
  EXPECT_EQ(outcome.out.find("belong together"), std::string::npos);
  EXPECT_NE(outcome.out.find("as they were, "), std::string::npos);
  EXPECT_EQ(outcome.out.find("of an earlier run"), std::string::npos);
  ASSERT_EQ(
      Run(quick + " --FacetwiseRefinement.refine_cameras poses").exit_code, 0);
  const std::string images = ReadFile(refined / "images.bin");
  outcome = Run(quick);
  EXPECT_NE(outcome.out.find("sparse-refined is of an earlier run"),
            std::string::npos);
  EXPECT_TRUE(ReadFile(refined / "images.bin") == images);
  outcome = Run(quick + " --FacetwiseRefinement.refine_cameras none" +
                Option("sparse_path", "sparse-refined"));
  EXPECT_EQ(outcome.out.find("of an earlier run"), std::string::npos);
}

// A workspace whose poses are off, and a mesh that is right.
struct InaccuratePoses {
  explicit InaccuratePoses(const fs::path& path) {
    synthetic::DenseSceneOptions options;
    options.scene.num_images = 8;
    options.scene.width = 160;
    options.scene.height = 120;
    WriteWorkspace(MakeDenseScene(options), 1, path.string());
    fs::rename(path / "sparse", path / "sparse-true");
    options.pose_noise.pixels = 1;
    WriteWorkspace(MakeDenseScene(options), 1, path.string());
    TriangleMesh mesh = ReadPlyMesh(path / "truth" / "mesh.ply");
    mesh.facets.pop_back();
    WriteColoredMesh(path / "input.ply", mesh, {});
  }
};

// Makes frames of two images each of a sparse model.
void AddRigs(const fs::path& sparse) {
  const SparseModel model = ReadSparseModel(sparse, SparseDetail::kAll);
  std::string bytes;
  Append(uint64_t{model.images.size() / 2}, &bytes);
  for (size_t i = 0; i < model.images.size(); ++i) {
    if (i % 2 == 0) {
      Append(static_cast<uint32_t>(i + 1), &bytes);
      Append(uint32_t{1}, &bytes);  // rig id
      for (const double value : {1, 0, 0, 0, 0, 0, 0}) {
        Append(value, &bytes);
      }
      Append(uint32_t{2}, &bytes);
    }
    Append(int32_t{0}, &bytes);  // a camera
    Append(static_cast<uint32_t>(i % 2), &bytes);
    Append(uint64_t{model.images[i].image_id}, &bytes);
  }
  WriteFile(sparse / "frames.bin", bytes);
}

TEST_F(FacetwiseRefinerTest, LeavesTheMeshWhereThePosesAreTooInaccurate) {
  const InaccuratePoses workspace(path_);
  const std::string arguments =
      Workspace() + Option("input_path", "input.ply") +
      Option("output_path", "output.ply") +
      " --FacetwiseRefinement.levels 1 --FacetwiseRefinement.iterations 1"
      " --FacetwiseRefinement.close_holes 9";
  const std::string refine = " --FacetwiseRefinement.refine_cameras ";
  const std::string held = "too inaccurate";
  const auto expect_held = [&](const std::string& more) {
    const Outcome outcome = Run(arguments + more);
    EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
    EXPECT_NE(outcome.out.find(held), std::string::npos) << outcome.out;
    const TriangleMesh before = ReadPlyMesh(path_ / "input.ply");
    const TriangleMesh after = ReadPlyMesh(path_ / "output.ply");
    EXPECT_EQ(after.facets, before.facets);
    EXPECT_TRUE(after.vertices == before.vertices);
    return outcome.out;
  };
  const auto expect_refined = [&](const std::string& more) {
    const Outcome outcome = Run(arguments + more);
    EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
    EXPECT_EQ(outcome.out.find(held), std::string::npos);
  };
  EXPECT_NE(expect_held(refine + "none").find("refine_cameras poses"),
            std::string::npos);
  expect_refined(refine + "poses");
  AddRigs(path_ / "sparse");
  AddRigs(path_ / "sparse-true");
  const std::string of_rigs = expect_held("");
  EXPECT_EQ(of_rigs.find("refine_cameras poses"), std::string::npos);
  EXPECT_NE(of_rigs.find("bundle_adjuster"), std::string::npos);
  expect_refined(Option("sparse_path", "sparse-true"));
}

TEST_F(FacetwiseRefinerTest, GivesTheSameBytesOnAnyNumberOfThreads) {
  std::string mesh;
  std::string visibility;
  for (const char* num_threads : {"1", "2"}) {
    ASSERT_EQ(
        Run(Workspace() + " --FacetwiseRefinement.num_threads " + num_threads)
            .exit_code,
        0);
    const std::string new_mesh = ReadFile(path_ / kOutput);
    const std::string new_visibility =
        ReadFile(VisibilityPath(path_ / kOutput));
    EXPECT_TRUE(mesh.empty() || new_mesh == mesh);
    EXPECT_TRUE(visibility.empty() || new_visibility == visibility);
    mesh = new_mesh;
    visibility = new_visibility;
  }
}

TEST_F(FacetwiseRefinerTest, WorksInLittleMemory) {
  const std::string arguments = Workspace() +
                                " --FacetwiseRefinement.levels 2"
                                " --FacetwiseRefinement.iterations 2";
  ASSERT_EQ(Run(arguments).exit_code, 0);
  const std::string mesh = ReadFile(path_ / kOutput);
  ASSERT_EQ(
      Run(arguments + " --FacetwiseRefinement.max_memory_gb 1e-9").exit_code,
      0);
  EXPECT_EQ(ReadFile(path_ / kOutput), mesh);
}

TEST_F(FacetwiseRefinerTest, RefinesInOtherWays) {
  const auto refine = [&](const std::string& option) {
    const Outcome outcome = Run(Workspace() +
                                " --FacetwiseRefinement.levels 1"
                                " --FacetwiseRefinement.iterations 2" +
                                option);
    EXPECT_EQ(outcome.exit_code, 0) << option << outcome.err;
    ExpectGoodMesh(path_ / kOutput);
    return ReadFile(path_ / kOutput);
  };
  const std::string by_default = refine("");
  std::set<std::string> results = {by_default};
  for (const std::string option :
       {"solver descent", "pair_selection classical", "pairs_per_facet 3",
        "final_pairs_per_facet 1", "occlusion_masking 0", "window 7"}) {
    EXPECT_TRUE(
        results.insert(refine(" --FacetwiseRefinement." + option)).second)
        << option;
  }
  EXPECT_TRUE(refine(" --FacetwiseRefinement.solver gauss_newton") ==
              by_default);
}

TEST_F(FacetwiseRefinerTest, DrawsByOpenGl) {
  const Outcome outcome = Run(Workspace() +
                              " --FacetwiseRefinement.backend gl"
                              " --FacetwiseRefinement.levels 2"
                              " --FacetwiseRefinement.iterations 2");
  if (outcome.err.find("backend cpu needs none") != std::string::npos) {
    GTEST_SKIP() << "there is no OpenGL: " << outcome.err;
  }
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_NE(outcome.out.find("OpenGL, "), std::string::npos);
  EXPECT_EQ(outcome.out.find("(software)") != std::string::npos,
            outcome.out.find("drawn by software") != std::string::npos);
  ExpectGoodMesh(path_ / kOutput);
}

TEST_F(FacetwiseRefinerTest, WritesReportLabelsAndSnapshots) {
  const Outcome outcome =
      Run(Workspace() + Option("report_path", "energy.csv") +
          Option("labels_path", "labels.ply") +
          " --FacetwiseRefinement.snapshot_interval 1"
          " --FacetwiseRefinement.levels 2 --FacetwiseRefinement.iterations 2");
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  const std::string csv = ReadFile(path_ / "energy.csv");
  EXPECT_TRUE(csv.starts_with("level,final,iteration,energy,"));
  for (const char* row : {"\n1,0,", "\n0,0,", "\n0,1,"}) {
    EXPECT_NE(csv.find(row), std::string::npos) << row;
  }
  for (const char* row : {"\n1,1,", "\n2,"}) {
    EXPECT_EQ(csv.find(row), std::string::npos) << row;
  }
  const std::string svg = ReadFile(path_ / "energy.svg");
  EXPECT_TRUE(svg.starts_with("<svg "));
  EXPECT_TRUE(svg.ends_with("</svg>\n"));
  EXPECT_NE(svg.find("1/2 size"), std::string::npos);
  ExpectGoodMesh(path_ / kOutput);
  const std::string labels = ReadFile(path_ / "labels.ply");
  EXPECT_NE(labels.find("comment label 0: 000"), std::string::npos);
  EXPECT_NE(labels.find("property int label\n"), std::string::npos);
  EXPECT_EQ(ReadPlyMesh(path_ / "labels.ply").facets.size(),
            ReadPlyMesh(path_ / kOutput).facets.size());
  ExpectPage(ReadFile(path_ / "energy.html"), outcome);
  const auto size = ReadPictureSize(path_ / "labels.png");
  ASSERT_TRUE(size);
  EXPECT_EQ(size->width, 1024);
  for (const char* name :
       {"meshed-refined.1.1.ply", "meshed-refined.0.1.ply"}) {
    EXPECT_GT(ReadPlyMesh(path_ / name).facets.size(), 1000) << name;
  }
}

TEST_F(FacetwiseRefinerTest, WritesAPageOfWhateverFilesAreCalled) {
  const std::string name = "<b> & 'x' \xc3\xa4\xff.html";
  const std::string arguments = Workspace() + Option("report_path", name) +
                                " --FacetwiseRefinement.refine_cameras poses"
                                " --FacetwiseRefinement.levels 1"
                                " --FacetwiseRefinement.iterations 2";
  const Outcome outcome = Run(arguments);
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  const std::string page = ReadFile(path_ / name);
  ExpectPage(page, outcome);
  EXPECT_NE(page.find("&lt;b&gt; &amp; &#39;x&#39; \xc3\xa4\xef\xbf\xbd"),
            std::string::npos);
  EXPECT_NE(page.find("moved by, px"), std::string::npos);
  for (const char* extension : {".csv", ".svg"}) {
    EXPECT_TRUE(
        fs::exists(fs::path(path_ / name).replace_extension(extension)));
  }
  ASSERT_EQ(Run(arguments).exit_code, 0);
  EXPECT_EQ(PicturesOf(ReadFile(path_ / name)), PicturesOf(page));
}

TEST_F(FacetwiseRefinerTest, FindsTheWorkspaceOfAutomaticReconstructor) {
  const fs::path top = folder_.Path() / "top";
  fs::create_directories(top / "dense");
  fs::rename(path_, top / "dense" / "0");
  path_ = top;
  EXPECT_EQ(Run(Workspace() + " --FacetwiseRefinement.levels 1").exit_code, 0);
  EXPECT_TRUE(fs::exists(top / "dense" / "0" / kOutput));
}

TEST_F(FacetwiseRefinerTest, TakesMeshesOfOtherTools) {
  const ColoredMesh mesh = ReadColoredPlyMesh(path_ / kInput);
  WriteColoredMesh(path_ / "other.ply", mesh.mesh, {});
  const std::string arguments = Workspace() +
                                Option("input_path", "other.ply") +
                                Option("output_path", "other-refined.ply");
  const Outcome outcome = Run(arguments);
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_NE(outcome.out.find("nearest fused points"), std::string::npos);
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
  const Outcome outcome = Run(Workspace());
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_NE(outcome.out.find("pairs of images by the mesh's vertices"),
            std::string::npos);
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
  const Outcome outcome = Run(Workspace() + Option("input_path", "soup.ply") +
                              Option("output_path", "refined.ply") +
                              " --FacetwiseRefinement.levels 1");
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  for (const char* text : {"not manifold", "split off", "repeat a vertex",
                           "there twice", "not finite"}) {
    EXPECT_NE(outcome.out.find(text), std::string::npos) << text;
  }
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
  const Outcome refused = Run(Workspace());
  for (const char* text :
       {"3 of 8", "0000.png no such file", "0002.png can not be read",
        "0003.png is 100 x 120 pixels, but its camera is 160 x 120",
        "skip_missing_images"}) {
    ExpectRefusal(refused, text);
  }
  const Outcome outcome =
      Run(Workspace() + " --FacetwiseRefinement.skip_missing_images 1" +
          Option("labels_path", "labels.ply"));
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_NE(outcome.out.find("images ignored"), std::string::npos);
  ExpectGoodMesh(path_ / kOutput);
  const std::string labels = ReadFile(path_ / "labels.ply");
  for (const char* name : {"0000.png", "0002.png", "0003.png"}) {
    EXPECT_EQ(labels.find(name), std::string::npos) << name;
  }
  fs::remove(path_ / kOutput);
  fs::remove_all(images);
  ExpectRefused(Workspace() + " --FacetwiseRefinement.skip_missing_images 1",
                "fewer than two images");
}

TEST_F(FacetwiseRefinerTest, RefinesARegion) {
  const TriangleMesh input = ReadPlyMesh(path_ / kInput);
  float top = -1e9f;
  float bottom = 1e9f;
  for (const Eigen::Vector3f& vertex : input.vertices) {
    top = std::max(top, vertex.z());
    bottom = std::min(bottom, vertex.z());
  }
  const double middle = (top + bottom) / 2;
  const Outcome outcome =
      Run(Workspace() + fmt::format(" --region=-9,-9,{},9,9,9", middle) +
          " --FacetwiseRefinement.levels 1 --FacetwiseRefinement.iterations 2");
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_NE(outcome.out.find("region, center"), std::string::npos);
  const TriangleMesh refined = ReadPlyMesh(path_ / kOutput);
  EXPECT_TRUE(Analyze(refined).IsManifold());
  float refined_bottom = 1e9f;
  for (const Eigen::Vector3f& vertex : refined.vertices) {
    refined_bottom = std::min(refined_bottom, vertex.z());
  }
  EXPECT_NEAR(refined_bottom, middle, 1e-4);
  fs::remove(path_ / kOutput);
  ExpectRefused(Workspace() + " --region 50,50,50,60,60,60",
                "none of its faces lies in the region");
}

TEST_F(FacetwiseRefinerTest, LeavesOutWhatIsMasked) {
  const fs::path masks = path_ / "masks";
  fs::create_directory(masks);
  for (const fs::directory_entry& entry :
       fs::directory_iterator(path_ / "images")) {
    ColorImage mask{160, 120, std::vector<Color>(160 * 120, {9, 9, 9})};
    std::fill(mask.pixels.begin(), mask.pixels.begin() + 160 * 60,
              Color{0, 0, 0});
    WriteFile(masks / (entry.path().filename().string() + ".png"),
              EncodePng(mask));
  }
  const std::string arguments =
      Workspace() + Option("mask_path", "masks") +
      " --FacetwiseRefinement.levels 1 --FacetwiseRefinement.iterations 2";
  const Outcome outcome = Run(arguments);
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_NE(outcome.out.find("points masked in all views"), std::string::npos);
  EXPECT_TRUE(Analyze(ReadPlyMesh(path_ / kOutput)).IsManifold());
  fs::remove(path_ / kOutput);
  fs::remove_all(masks);
  ExpectRefused(arguments, "no such folder of masks");
}

TEST_F(FacetwiseRefinerTest, RefusesBadOptions) {
  const std::string prefix = Workspace() + " --FacetwiseRefinement.";
  ExpectRefused("", "--workspace_path is required");
  ExpectRefused(Workspace() + Option("input_path", kInput),
                "--output_path is required");
  ExpectRefused(Workspace() + " --image_order random", "image_order");
  ExpectRefused(Workspace() + Option("report_path", "plot.svg"),
                "--report_path");
  ExpectRefused(Workspace() + Option("labels_path", "labels.png"),
                "--labels_path");
  // One of each kind; tests/options has the others.
  ExpectRefused(prefix + "levels 0", "levels");
  ExpectRefused(prefix + "solver magic", "gauss_newton or descent");
  ExpectRefused(prefix + "num_threads abc", "abc");
}

TEST_F(FacetwiseRefinerTest, RefusesFilesThatAreMissingOrDoNotFit) {
  ExpectRefused("--workspace_path /none", "no such folder");
  ExpectRefused(Workspace() + Option("input_path", "none.ply") +
                    Option("output_path", "out.ply"),
                "no such file");
  ExpectRefused(Workspace() + Option("input_path", kInput) +
                    Option("output_path", kInput),
                "is to be refined");
  const fs::path visibility_path = VisibilityPath(path_ / kInput);
  const std::string visibility = ReadFile(visibility_path);
  WriteFile(visibility_path, visibility.substr(0, visibility.size() - 1));
  ExpectRefused(Workspace(), "truncated");
  std::string other = visibility;
  const uint32_t no_image = 77;
  std::memcpy(other.data() + 12, &no_image, sizeof(no_image));
  WriteFile(visibility_path, other);
  ExpectRefused(Workspace(), "lists image 77");
  other = visibility;
  ++other[0];
  WriteFile(visibility_path, other);
  ExpectRefused(Workspace(), "was the mesh edited?");
  WriteColoredMesh(path_ / "points.ply", {{{0, 0, 0}}, {}}, {});
  ExpectRefused(Workspace() + Option("input_path", "points.ply") +
                    Option("output_path", "out.ply"),
                "no faces");
  fs::remove(path_ / kInput);
  ExpectRefused(Workspace(), "run `colmap delaunay_manifold_mesher`");
  fs::remove(path_ / "fused.ply");
  ExpectRefused(Workspace(), "run `colmap delaunay_manifold_mesher");
}

TEST_F(FacetwiseRefinerTest, RefusesDistortedCameras) {
  SphereWorkspace sphere;
  const fs::path folder = folder_.Path() / "sphere";
  sphere.Write(folder);
  std::string cameras = sphere.ModelFile("cameras.bin");
  cameras[12] = 2;  // SIMPLE_RADIAL, of four parameters too
  WriteFile(folder / "sparse" / "cameras.bin", cameras);
  fs::copy(path_ / kInput, folder / kInput);
  ExpectRefused("--workspace_path " + Quote(folder.string()),
                "image_undistorter");
}

// A limit on the size of files stands for a full disk.
TEST_F(FacetwiseRefinerTest, OnAFullDiskAllFilesStayAsTheyWere) {
  const std::string arguments =
      Quote(kProgram) + " facetwise_refiner " + Workspace() +
      " --FacetwiseRefinement.backend cpu --FacetwiseRefinement.levels 1"
      " --FacetwiseRefinement.iterations 1 --region auto"
      " --FacetwiseRefinement.refine_cameras poses" +
      Option("labels_path", "labels.ply") + Option("report_path", "steps.csv");
  ASSERT_EQ(RunShell(arguments).exit_code, 0);
  uintmax_t largest = 0;
  for (const char* name :
       {kOutput, "meshed-refined.ply.vis", "meshed-refined.region.txt",
        "sparse-refined/points3D.bin", "labels.ply", "labels.png", "steps.csv",
        "steps.svg", "steps.html"}) {
    largest = std::max(largest, fs::file_size(path_ / name));
    WriteFile(path_ / name, kEarlierOutput);
  }
  const auto before = FilesOf(path_);
  // The page has the times of the run, so that its size varies.
  for (const uintmax_t size : {largest / 100, largest / 10, largest / 2}) {
    ExpectRefusal(RunShell("trap '' XFSZ; prlimit --fsize=" +
                           std::to_string(size) + " " + arguments),
                  "File too large");
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
    ExpectRefusal(Run(Workspace() + Option(option, name)), "would be replaced");
  }
  ExpectRefused(Workspace() + Option("labels_path", kOutput), "two outputs");
  EXPECT_TRUE(FilesOf(path_) == before);
}

TEST_F(FacetwiseRefinerTest, RefusesPlacesThatCanNotBeWrittenBeforeTheWork) {
  WriteFile(path_ / kInput, "not read");
  for (const char* option : {"output_path", "report_path", "labels_path"}) {
    for (const char* place : {"/proc/file.ply", "/dev/null/file.ply"}) {
      ExpectRefused(
          Workspace() + " --" + std::string(option) + " " + std::string(place),
          "can not be written");
    }
  }
}

}  // namespace facetwise_refiner_test
}  // namespace colmap_ext
