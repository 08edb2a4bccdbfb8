// facetwise_refiner as a user runs it: exit codes, messages, files.

#include <fcntl.h>
#include <limits.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <csignal>
#include <limits>
#include <memory>
#include <stdexcept>
#include <utility>

#include "formats/picture_size.h"
#include "formats/read_ply_cloud.h"
#include "formats/read_ply_mesh.h"
#include "formats/read_visibility.h"
#include "formats/write_mesh.h"
#include "mesh/topology.h"
#include "tests/colmap_ext/run_shell.h"
#include "tests/formats/test_files.h"
#include "tests/synthetic/write_workspace.h"
#include "tests/workspace/sphere_workspace.h"

namespace colmap_ext {
namespace {

namespace fs = std::filesystem;

constexpr const char* kInput = "meshed-delaunay-manifold.ply";
constexpr const char* kOutput = "meshed-refined.ply";
constexpr const char* kEarlierOutput = "of an earlier run";

#ifdef COLMAP_EXT_PROGRAM
const std::string kProgram = COLMAP_EXT_PROGRAM;
#else
const std::string kProgram;
#endif

std::string Quote(const std::string& text) { return "\"" + text + "\""; }

// A workspace that delaunay_manifold_mesher has been run on.
struct MeshedWorkspace {
  MeshedWorkspace() {
    synthetic::DenseSceneOptions options;
    options.scene.num_images = 8;
    options.scene.width = 160;
    options.scene.height = 120;
    const synthetic::DenseScene scene = MakeDenseScene(options);
    truth = scene.scene.surface;
    WriteWorkspace(scene, 1, folder.Path().string());
    fs::remove_all(folder.Path() / "truth");
    RunShell(Quote(kProgram) + " delaunay_manifold_mesher --workspace_path " +
             Quote(folder.Path().string()));
  }

  TemporaryFolder folder;
  TriangleMesh truth;
};

// The program while it runs, which waits after each line that it prints until
// the line is read: its standard output is a pipe of packets with room for one.
class Process {
 public:
  Process(const std::vector<std::string>& arguments, const fs::path& err) {
    std::vector<char*> argv = {const_cast<char*>(kProgram.c_str())};
    for (const std::string& argument : arguments) {
      argv.push_back(const_cast<char*>(argument.c_str()));
    }
    argv.push_back(nullptr);
    int ends[2];
    if (pipe2(ends, O_DIRECT | O_CLOEXEC) != 0) {
      throw std::runtime_error("no pipe");
    }
    fcntl(ends[1], F_SETPIPE_SZ, 1);  // rounded up to one page
    id_ = fork();
    if (id_ == 0) {
      for (const int number : {SIGINT, SIGTERM}) {
        std::signal(number, SIG_DFL);
      }
      dup2(ends[1], 1);
      dup2(open(err.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0600), 2);
      execv(argv[0], argv.data());
      _exit(127);
    }
    close(ends[1]);
    output_ = ends[0];
  }

  ~Process() { close(output_); }
  Process(const Process&) = delete;
  Process& operator=(const Process&) = delete;

  // Reads what the program prints until that has the text.
  // \return whether it has.
  bool WaitFor(const std::string& text) {
    std::string printed;
    while (printed.find(text) == std::string::npos) {
      if (!Read(&printed)) {
        return false;
      }
    }
    return true;
  }

  void Signal(int number) const { kill(id_, number); }

  // Reads what is left. As waitpid() has it.
  int Wait() {
    for (std::string rest; Read(&rest);) {
    }
    int status = 0;
    waitpid(id_, &status, 0);
    return status;
  }

 private:
  bool Read(std::string* printed) const {
    char packet[PIPE_BUF];
    const ssize_t size = read(output_, packet, sizeof(packet));
    printed->append(packet, size > 0 ? static_cast<size_t>(size) : 0);
    return size > 0;
  }

  pid_t id_ = 0;
  int output_ = -1;
};

class FacetwiseRefinerTest : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    if (!kProgram.empty()) {
      meshed_ = std::make_unique<MeshedWorkspace>();
    }
  }

  static void TearDownTestSuite() { meshed_.reset(); }

  void SetUp() override {
    if (kProgram.empty()) {
      GTEST_SKIP() << "there is no stand-alone program";
    }
    MakeWorkspace();
    ASSERT_TRUE(fs::exists(path_ / kInput));
  }

  void MakeWorkspace() const {
    fs::remove_all(path_);
    fs::copy(meshed_->folder.Path(), path_, fs::copy_options::recursive);
  }

  Outcome Run(const std::string& arguments) const {
    const std::string backend = "--FacetwiseRefinement.backend ";
    return RunShell(Quote(kProgram) + " facetwise_refiner " + arguments +
                    (arguments.find(backend) == std::string::npos
                         ? " " + backend + "cpu"
                         : ""));
  }

  std::string Option(const std::string& option, const std::string& name) const {
    return " --" + option + " " + Quote((path_ / name).string());
  }

  std::string Workspace() const {
    return "--workspace_path " + Quote(path_.string());
  }

  void ExpectRefused(const std::string& arguments, const std::string& message) {
    ExpectRefusal(Run(arguments), message);
    EXPECT_FALSE(fs::exists(path_ / kOutput)) << arguments;
  }

  // The output is as promised.
  void ExpectGoodMesh(const fs::path& path) const {
    const ColoredMesh refined = ReadColoredPlyMesh(path);
    EXPECT_TRUE(Analyze(refined.mesh).IsManifold())
        << Analyze(refined.mesh).Defects();
    EXPECT_EQ(refined.colors.size(), refined.mesh.vertices.size());
    const Visibility visibility = ReadVisibility(
        VisibilityPath(path), refined.mesh.vertices.size(), kFusedCloud);
    EXPECT_GT(visibility.values.size(), refined.mesh.vertices.size());
    EXPECT_LT(
        *std::max_element(visibility.values.begin(), visibility.values.end()),
        8);
  }

  // The average score of what the images see of a mesh, scene units.
  double Error(const fs::path& path) const {
    const fs::path truth = folder_.Path() / "truth.ply";
    WriteColoredMesh(truth, meshed_->truth, {});
    const fs::path json = folder_.Path() / "figures.json";
    const Outcome outcome = RunShell(
        Quote(kProgram) + " mesh_evaluator --mesh_path " +
        Quote(path.string()) + " --truth_path " + Quote(truth.string()) +
        " --workspace_path " + Quote(path_.string()) + " --json_path " +
        Quote(json.string()) + " --MeshEvaluation.spacing 0.01");
    EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
    const std::string key = "\"average_score\": ";
    const std::string figures = ReadFile(json);
    const size_t at = figures.find(key);
    return at == std::string::npos ? std::nan("")
                                   : std::stod(figures.substr(at + key.size()));
  }

  // Runs the program in a workspace where there is an output already, and sends
  // it signals, one after the other, when it has printed the text.
  // \return as waitpid() has it.
  int Interrupt(const std::vector<std::string>& more_arguments,
                const std::string& text,
                const std::vector<int>& signals) const {
    WriteFile(path_ / kOutput, kEarlierOutput);
    std::vector<std::string> arguments = {
        "facetwise_refiner", "--FacetwiseRefinement.backend", "cpu",
        "--workspace_path", path_.string()};
    arguments.insert(arguments.end(), more_arguments.begin(),
                     more_arguments.end());
    Process process(arguments, folder_.Path() / "err");
    EXPECT_TRUE(process.WaitFor(text)) << ErrorOutput();
    for (const int number : signals) {
      process.Signal(number);
    }
    return process.Wait();
  }

  // Of a run that is interrupted at the second level.
  void InterruptAtTheSecondLevel() const {
    const int status = Interrupt({}, "1/2 size, iteration 0", {SIGINT});
    ASSERT_TRUE(WIFEXITED(status));
    ASSERT_EQ(WEXITSTATUS(status), 130) << ErrorOutput();
  }

  // As Interrupt() makes it.
  std::string ListWithEarlierOutput() const {
    WriteFile(path_ / kOutput, kEarlierOutput);
    return List(path_);
  }

  void ExpectResumeRefused(const std::string& message) const {
    ExpectRefusal(Run(Workspace() + " --resume 1"), message);
  }

  std::string ErrorOutput() const { return ReadFile(folder_.Path() / "err"); }

  static inline std::unique_ptr<MeshedWorkspace> meshed_;
  TemporaryFolder folder_;
  fs::path path_ = folder_.Path() / "a workspace";
};

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
  const Outcome outcome = Run(Workspace());
  ASSERT_EQ(outcome.exit_code, 0) << outcome.out << outcome.err;
  EXPECT_EQ(outcome.err, "");
  fs::path output = path_ / kOutput;
  ExpectGoodMesh(output);
  EXPECT_LT(Error(output), Error(path_ / kInput));
  for (const char* text :
       {"computed by", "full size, iteration 1: energy", "mean ZNCC", "pairs",
        "self-intersections", "flipped faces", "peak memory", "its .vis"}) {
    EXPECT_NE(outcome.out.find(text), std::string::npos) << text;
  }
  fs::remove(output);
  fs::remove(VisibilityPath(output));
  EXPECT_EQ(List(path_), before) << "nothing else was written";
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
  const std::string prefix = Workspace() +
                             " --FacetwiseRefinement.levels 1"
                             " --FacetwiseRefinement.iterations 2";
  std::string before;
  for (const char* option :
       {"solver gauss_newton", "solver descent", "pair_selection classical",
        "pairs_per_facet 3", "final_pairs_per_facet 1", "occlusion_masking 0",
        "window 7"}) {
    const Outcome outcome =
        Run(prefix + " --FacetwiseRefinement." + std::string(option));
    ASSERT_EQ(outcome.exit_code, 0) << option << outcome.err;
    ExpectGoodMesh(path_ / kOutput);
    const std::string bytes = ReadFile(path_ / kOutput);
    EXPECT_TRUE(bytes != before) << option;
    before = bytes;
  }
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
  for (const char* row : {"\n1,0,", "\n1,1,", "\n0,0,", "\n0,1,"}) {
    EXPECT_NE(csv.find(row), std::string::npos) << row;
  }
  EXPECT_EQ(csv.find("\n2,"), std::string::npos);
  const std::string svg = ReadFile(path_ / "energy.svg");
  EXPECT_TRUE(svg.starts_with("<svg "));
  EXPECT_TRUE(svg.ends_with("</svg>\n"));
  EXPECT_NE(svg.find("1/2 size"), std::string::npos);
  ExpectGoodMesh(path_ / kOutput);
  const std::string labels = ReadFile(path_ / "labels.ply");
  EXPECT_NE(labels.find("comment label 0: 000"), std::string::npos);
  EXPECT_NE(labels.find("property int label\n"), std::string::npos);
  EXPECT_EQ(ReadPlyMesh(path_ / "labels.ply").facets,
            ReadPlyMesh(path_ / kOutput).facets);
  const auto size = ReadPictureSize(path_ / "labels.png");
  ASSERT_TRUE(size);
  EXPECT_EQ(size->width, 1024);
  for (const char* name :
       {"meshed-refined.1.1.ply", "meshed-refined.0.1.ply"}) {
    EXPECT_GT(ReadPlyMesh(path_ / name).facets.size(), 1000) << name;
  }
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
  EXPECT_NE(outcome.out.find("images left out"), std::string::npos);
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
  ExpectRefused(prefix + "levels 0", "levels");
  ExpectRefused(prefix + "iterations -1", "iterations");
  ExpectRefused(prefix + "window 4", "window");
  ExpectRefused(prefix + "window 1", "window");
  ExpectRefused(prefix + "window 17", "window");
  ExpectRefused(prefix + "noise_variance 0", "noise_variance");
  ExpectRefused(prefix + "residual_floor -1", "residual_floor");
  ExpectRefused(prefix + "min_cosine 1", "min_cosine");
  ExpectRefused(prefix + "smoothness_weight -1", "smoothness_weight");
  ExpectRefused(prefix + "max_face_area 0", "max_face_area");
  ExpectRefused(prefix + "pairs_per_image 0", "pairs_per_image");
  ExpectRefused(prefix + "pairs_per_facet 0", "pairs_per_facet");
  ExpectRefused(prefix + "potts_weight -1", "potts_weight");
  ExpectRefused(prefix + "pair_selection best", "facetwise or classical");
  ExpectRefused(prefix + "solver magic", "gauss_newton or descent");
  ExpectRefused(prefix + "backend cuda", "auto, cpu or gl");
  ExpectRefused(prefix + "gpu_index -2", "gpu_index");
  ExpectRefused(prefix + "max_memory_gb 0", "max_memory_gb");
  ExpectRefused(prefix + "max_memory_gb nan", "max_memory_gb");
  ExpectRefused(prefix + "snapshot_interval -1", "snapshot_interval");
  ExpectRefused(prefix + "num_threads 0", "num_threads");
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
  std::string cameras = sphere.CamerasBinary();
  cameras[12] = 2;  // SIMPLE_RADIAL, of four parameters too
  WriteFile(folder / "sparse" / "cameras.bin", cameras);
  fs::copy(path_ / kInput, folder / kInput);
  ExpectRefused("--workspace_path " + Quote(folder.string()),
                "image_undistorter");
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

TEST_F(FacetwiseRefinerTest, GoesOnAfterAnInterruption) {
  const fs::path output = path_ / kOutput;
  ASSERT_EQ(Run(Workspace() + Option("report_path", "steps.csv")).exit_code, 0);
  const auto num_steps = [this] {
    const std::string csv = ReadFile(path_ / "steps.csv");
    return std::count(csv.begin(), csv.end(), '\n');
  };
  const auto num_steps_of_all = num_steps();
  const std::string mesh = ReadFile(output);
  const std::string visibility = ReadFile(VisibilityPath(output));
  const fs::path state = path_ / "meshed-refined.ply.resume";
  InterruptAtTheSecondLevel();
  EXPECT_NE(ErrorOutput().find("--resume 1"), std::string::npos);
  EXPECT_EQ(ReadFile(output), kEarlierOutput);
  const fs::path level_mesh = path_ / "meshed-refined.level2.ply";
  EXPECT_NE(ErrorOutput().find(level_mesh.string()), std::string::npos);
  ExpectGoodMesh(level_mesh);
  ExpectRefusal(
      Run(Workspace() + " --resume 1 --FacetwiseRefinement.iterations 3"),
      "iterations was '15' and is '3'");
  const std::string level_bytes = ReadFile(level_mesh);
  WriteFile(level_mesh, level_bytes + " ");
  ExpectResumeRefused("not what the interrupted run wrote");
  WriteFile(level_mesh, level_bytes);
  const std::string state_bytes = ReadFile(state);
  WriteFile(state, state_bytes.substr(0, state_bytes.size() - 8));
  ExpectResumeRefused("damaged");
  WriteFile(state, state_bytes);
  const Outcome outcome =
      Run(Workspace() + " --resume 1" + Option("report_path", "steps.csv"));
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_NE(outcome.out.find("goes on after"), std::string::npos);
  EXPECT_TRUE(ReadFile(output) == mesh);
  EXPECT_TRUE(ReadFile(VisibilityPath(output)) == visibility);
  EXPECT_FALSE(fs::exists(state));
  EXPECT_FALSE(fs::exists(level_mesh));
  EXPECT_FALSE(fs::exists(VisibilityPath(level_mesh)));
  EXPECT_FALSE(
      fs::exists(fs::path(level_mesh).replace_extension(".origin.ply")));
  EXPECT_EQ(num_steps(), num_steps_of_all);
}

// What the mesh depends on has to be the same.
TEST_F(FacetwiseRefinerTest, RefusesToGoOnWithOtherPosesOrPictures) {
  InterruptAtTheSecondLevel();
  // The last binary digit of a focal length, a translation and a coordinate,
  // and a colour.
  for (const auto& [name, position] :
       {std::pair("sparse/cameras.bin", 32), std::pair("sparse/images.bin", 44),
        std::pair("sparse/points3D.bin", 16), std::pair("fused.ply", -1)}) {
    const std::string bytes = ReadFile(path_ / name);
    std::string other = bytes;
    char& byte = position < 0 ? other.back() : other[position];
    byte = static_cast<char>(byte ^ 1);
    WriteFile(path_ / name, other);
    ExpectResumeRefused(name);
    WriteFile(path_ / name, bytes);
  }
  const fs::path picture = path_ / "images" / "0003.png";
  const std::string bytes = ReadFile(picture);
  WriteFile(picture, bytes + "x");  // which decoders do not read
  ExpectResumeRefused("images/0003.png");
  WriteFile(picture, bytes);
  EXPECT_EQ(Run(Workspace() + " --resume 1").exit_code, 0);
}

TEST_F(FacetwiseRefinerTest, RefusesToGoOnInAnotherOrderOfTheImages) {
  InterruptAtTheSecondLevel();
  ExpectRefusal(Run(Workspace() + " --resume 1 --image_order image_id"),
                "image_order was 'file' and is 'image_id'");
}

TEST_F(FacetwiseRefinerTest, StartsWhereThereIsNothingToGoOnFrom) {
  const Outcome outcome =
      Run(Workspace() + " --resume 1 --FacetwiseRefinement.levels 1");
  EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_NE(outcome.out.find("starts from the beginning"), std::string::npos);
}

TEST_F(FacetwiseRefinerTest, WritesNothingBeforeTheFirstLevelIsComplete) {
  const std::string before = ListWithEarlierOutput();
  const int status = Interrupt({"--FacetwiseRefinement.levels", "1"},
                               "iteration 0", {SIGTERM});
  ASSERT_TRUE(WIFEXITED(status));
  EXPECT_EQ(WEXITSTATUS(status), 143);
  EXPECT_NE(ErrorOutput().find("nothing was written"), std::string::npos);
  EXPECT_EQ(List(path_), before);
}

TEST_F(FacetwiseRefinerTest, EndsAtOnceAtTheSecondSignal) {
  const std::string before = ListWithEarlierOutput();
  const int status = Interrupt({"--FacetwiseRefinement.levels", "1"},
                               "iteration 0", {SIGINT, SIGTERM});
  ASSERT_TRUE(WIFSIGNALED(status));
  EXPECT_EQ(List(path_), before);
}

}  // namespace
}  // namespace colmap_ext
