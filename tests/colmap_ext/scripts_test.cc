// The commands as scripts run them that were written for delaunay_mesher: in a
// shell, with COLMAP's options, from other folders, several at a time.

#include <filesystem>
#include <string>

#include <gtest/gtest.h>

#include "tests/colmap_ext/run_shell.h"
#include "tests/workspace/sphere_workspace.h"

namespace colmap_ext::scripts_test {

namespace fs = std::filesystem;

struct ScriptsTest : testing::TestWithParam<std::string> {
  // A little rough, or no point would lie within others and be thinned.
  void SetUp() override {
    for (size_t i = 0; i < sphere_.points.size(); ++i) {
      sphere_.points[i] *= 1 + 0.02F * (static_cast<float>(i * 7919 % 13) / 13);
    }
    sphere_.Write(path_);
  }

  // Runs the lines in the test's folder, by a shell that stops at errors.
  // `mesher` and `refiner` stand for the commands.
  Outcome RunScript(const std::string& lines) {
    const fs::path script = folder_.Path() / "script.sh";
    WriteFile(script, "set -euo pipefail\ncd " + Quote(folder_.Path()) +
                          "\nmesher() { " + Quote(GetParam()) +
                          " delaunay_manifold_mesher \"$@\"; }\n"
                          "refiner() { " +
                          Quote(GetParam()) + " facetwise_refiner \"$@\"; }\n" +
                          lines + "\n");
    return RunShell("bash " + Quote(script));
  }

  void ExpectSuccess(const std::string& lines) {
    SCOPED_TRACE(lines);
    out_ = Succeed(RunScript(lines)).out;
  }

  std::string Bytes(const std::string& name) {
    return ReadFile(folder_.Path() / name);
  }

  TemporaryFolder folder_;
  fs::path path_ = folder_.Path() / "a scène";
  SphereWorkspace sphere_;
  std::string out_;  // of the last success
};

TEST_P(ScriptsTest, TakesTheOptionsOfDelaunayMesher) {
  ExpectSuccess(
      "mesher --input_path 'a scène' --output_path 'a scène/scene.ply' "
      "--DelaunayMeshing.quality_regularization 1. "
      "--DelaunayMeshing.max_proj_dist 3\n"
      "test ! -e 'a scène/meshed-delaunay-manifold.ply'\n"
      "mesher --workspace_path 'a scène' --output_path same.ply "
      "--DelaunayManifoldMeshing.quality_regularization 1 "
      "--DelaunayManifoldMeshing.max_proj_dist 3\n"
      "cmp same.ply 'a scène/scene.ply'");
  ExpectSuccess(
      "mesher --input_path 'a scène' --input_type sparse --output_path s1.ply\n"
      "mesher --input_path 'a scène/sparse' --input_type SPARSE --output_path "
      "s2.ply\ncmp s1.ply s2.ply");
  ExpectSuccess(
      "mesher --input_path 'a scène' --output_path x.ply --log_level 1 "
      "--DelaunayMeshing.of_another_version 3");
  EXPECT_TRUE(Has(
      out_, "ignored: --DelaunayMeshing.of_another_version, --log_level\n"));
}

// What image_undistorter writes into run-colmap-geometric.sh.
TEST_P(ScriptsTest, RunsTheScriptOfImageUndistorter) {
  fs::create_symlink(GetParam(), path_ / "colmap");
  WriteFile(path_ / "run-colmap-geometric.sh",
            "# You must set $COLMAP_EXE_PATH to \n"
            "# the directory containing the COLMAP executables.\n"
            "$COLMAP_EXE_PATH/colmap delaunay_manifold_mesher \\\n"
            "  --input_path . \\\n"
            "  --input_type dense \\\n"
            "  --output_path ./meshed-delaunay.ply\n");
  ExpectSuccess(
      "cd 'a scène'\nCOLMAP_EXE_PATH=. sh run-colmap-geometric.sh\n"
      "test -s meshed-delaunay.ply\ntest -s meshed-delaunay.ply.vis");
}

TEST_P(ScriptsTest, CountsThePixelsOfTheCameraLikeDelaunayMesher) {
  for (SphereWorkspace::Image& image : sphere_.images) {
    image.view.width = 40;  // of the picture; the camera stays 80 x 60
    image.view.height = 30;
  }
  sphere_.Write(path_);
  ExpectSuccess(
      "mesher --workspace_path 'a scène' --output_path camera.ply "
      "--DelaunayMeshing.max_proj_dist 8");
  EXPECT_TRUE(
      Has(out_, "8 px of the cameras, as COLMAP has it: 4 px of images"));
  ExpectSuccess(
      "mesher --workspace_path 'a scène' --output_path image.ply "
      "--DelaunayManifoldMeshing.max_proj_dist 4");
  EXPECT_FALSE(Has(out_, "of the cameras"));
  EXPECT_EQ(Bytes("camera.ply.vis"), Bytes("image.ply.vis"));
  ExpectSuccess(
      "mesher --workspace_path 'a scène' --output_path other.ply "
      "--DelaunayManifoldMeshing.max_proj_dist 8");
  EXPECT_NE(Bytes("other.ply.vis"), Bytes("image.ply.vis"));
}

TEST_P(ScriptsTest, TakesTheProjectFileOfProjectGenerator) {
  WriteFile(folder_.Path() / "project.ini",
            "log_to_stderr=true\nrandom_seed=0\nlog_level=0\n"
            "database_path=/some/where.db\nimage_path=/some/where\n"
            "[ImageReader]\nsingle_camera=false\nmask_path=\n"
            "[DelaunayMeshing]\nmax_proj_dist=3\nnum_threads=1\n");
  ExpectSuccess(
      "mesher --project_path project.ini --workspace_path 'a scène'\n"
      "mesher --workspace_path 'a scène' --output_path same.ply "
      "--DelaunayMeshing.max_proj_dist 3\n"
      "cmp same.ply 'a scène/meshed-delaunay-manifold.ply'");
  EXPECT_EQ(RunScript("mesher --project_path none.ini").exit_code, 1);
}

#ifdef COLMAP_EXT_COLMAP_PROGRAM
TEST_P(ScriptsTest, TakesWhatThisColmapWritesAsAProject) {
  ExpectSuccess(
      Quote(COLMAP_EXT_COLMAP_PROGRAM) +
      " project_generator --output_path generated.ini\n"
      "mesher --project_path generated.ini --workspace_path 'a scène'");
  EXPECT_TRUE(Has(out_, "are ignored: ")) << out_;
}
#endif

TEST_P(ScriptsTest, FindsCloudsOfAnotherName) {
  ExpectSuccess("mesher --workspace_path 'a scène' --output_path as_ever.ply");
  ExpectSuccess(
      "mkdir clouds\n"
      "mv 'a scène/fused.ply' 'clouds/fused geometric.ply'\n"
      "mv 'a scène/fused.ply.vis' 'clouds/fused geometric.ply.vis'\n"
      "mesher --workspace_path 'a scène' --fused_path 'clouds/fused "
      "geometric.ply'\n"
      "cmp as_ever.ply 'a scène/meshed-delaunay-manifold.ply'\n"
      "rm 'a scène/meshed-delaunay-manifold.ply.vis'\n"
      "refiner --workspace_path 'a scène' --fused_path 'clouds/fused "
      "geometric.ply' --FacetwiseRefinement.levels 1 "
      "--FacetwiseRefinement.iterations 1\n"
      "test -s 'a scène/meshed-refined.ply'");
  const Outcome outcome = RunScript(
      "mesher --workspace_path 'a scène' --fused_path clouds/none.ply");
  ExpectRefusal(outcome, "clouds/none.ply");
}

// automatic_reconstructor's layout, where the points have another name.
TEST_P(ScriptsTest, FindsTheWorkspaceOfACloudByItsStereoFolder) {
  fs::create_directories(folder_.Path() / "ws/dense/0/stereo");
  ExpectSuccess(
      "mv 'a scène'/* ws/dense/0/\n"
      "mv ws/dense/0/fused.ply ws/dense/0/fused-2.ply\n"
      "mv ws/dense/0/fused.ply.vis ws/dense/0/fused-2.ply.vis\n"
      "mesher --workspace_path ws --fused_path ws/dense/0/fused-2.ply\n"
      "test -s ws/dense/0/meshed-delaunay-manifold.ply");
}

TEST_P(ScriptsTest, TakesPathsOfAllKinds) {
  ExpectSuccess("mesher --workspace_path 'a scène' --output_path direct.ply");
  ExpectSuccess(
      "mkdir -p 'other folder'\nln -s 'a scène' link\n"
      "mesher --workspace_path 'a scène/' --output_path slash.ply\n"
      "mesher --workspace_path link/ --output_path 'other folder/link.ply'\n"
      "cd link\nmesher --workspace_path . --output_path ../dot.ply\n"
      "cd ..\nmesher --input_path ./link/../'a scène'//. --output_path "
      "\"$PWD/absolute.ply\"\n"
      "touch target.ply\nln -s target.ply linked.ply\n"
      "mesher --workspace_path link --output_path linked.ply\n"
      "test -L linked.ply\n"
      "for mesh in slash.ply 'other folder/link.ply' dot.ply absolute.ply "
      "target.ply; do cmp direct.ply \"$mesh\"; done");
}

TEST_P(ScriptsTest, TakesImagesInSubfolders) {
  for (size_t i = 0; i < sphere_.images.size(); ++i) {
    sphere_.images[i].view.name =
        "caméra " + std::to_string(i % 2) + "/ö/" + std::to_string(i) + ".ppm";
  }
  sphere_.Write(path_);
  fs::remove(path_ / "images" / "0.ppm");
  ExpectSuccess(
      "mesher --workspace_path 'a scène'\n"
      "refiner --workspace_path 'a scène' --FacetwiseRefinement.levels 1 "
      "--FacetwiseRefinement.iterations 1");
  EXPECT_TRUE(fs::exists(path_ / "meshed-refined.ply"));
}

// Two jobs write whole files each, even over one another.
TEST_P(ScriptsTest, RunsTwiceInOneWorkspaceAtATime) {
  ExpectSuccess(
      "mesher --workspace_path 'a scène' --output_path alone.ply\n"
      "for i in 1 2; do mesher --workspace_path 'a scène' & mesher "
      "--workspace_path 'a scène' --output_path both$i.ply & done\n"
      "for job in $(jobs -p); do wait \"$job\"; done\n"
      "for mesh in both1.ply both2.ply 'a scène/meshed-delaunay-manifold.ply'; "
      "do cmp alone.ply \"$mesh\"; cmp alone.ply.vis \"$mesh.vis\"; done");
  EXPECT_EQ(List(path_),
            "fused.ply fused.ply.vis images meshed-delaunay-manifold.ply "
            "meshed-delaunay-manifold.ply.vis sparse");
}

TEST_P(ScriptsTest, StopsScriptsByItsExitCode) {
  const Outcome outcome =
      RunScript("mesher --workspace_path nowhere | cat\necho 'never printed'");
  EXPECT_EQ(outcome.exit_code, 1);
  EXPECT_FALSE(Has(outcome.out, "never printed"));
  ExpectSuccess(
      "if mesher --workspace_path nowhere; then exit 5; fi\n"
      "mesher -h | grep max_proj_dist > help.txt\n"
      "mesher --workspace_path 'a scène' > log.txt\necho 'goes on'");
  EXPECT_TRUE(Has(out_, "goes on"));
}

INSTANTIATE_TEST_SUITE_P(Programs, ScriptsTest, testing::ValuesIn(Programs()));

// scripts/slurm with stand-ins for Slurm's programs, which write down how they
// are called.

struct SlurmScriptsTest : testing::Test {
  SlurmScriptsTest() {
    fs::create_directories(bin_);
    WriteProgram("sbatch",
                 "echo \"$*\" >> \"$CALLS\"\n"
                 "echo \"10$(($(wc -l < \"$CALLS\") - 1));cluster\"");
    WriteProgram("scontrol", "echo \"scontrol $*\" >> \"$CALLS\"");
    WriteProgram("squeue", "echo \"$STATE\"");
    WriteProgram("sleep", ":");
    fs::create_directories(plan_);
  }

  void WriteProgram(const std::string& name, const std::string& text) const {
    WriteFile(bin_ / name, "#!/bin/bash\n" + text + "\n");
    fs::permissions(bin_ / name, fs::perms::owner_all);
  }

  Outcome Run(const std::string& script, const std::string& environment = "") {
    fs::remove(calls_);
    return RunShell("env PATH=" + Quote(bin_) +
                    ":\"$PATH\" CALLS=" + Quote(calls_) + " " + environment +
                    " bash " + COLMAP_EXT_SLURM_SCRIPTS + "/" + script);
  }

  // The task 2 of an array, whose program ends like this.
  Outcome RunTask(const std::string& script, int code,
                  const std::string& environment) {
    WriteProgram("program", "exit " + std::to_string(code));
    return Run(script + " " + Quote(plan_),
               "COLMAP=" + Quote(bin_ / "program") +
                   " SLURM_ARRAY_JOB_ID=7 SLURM_ARRAY_TASK_ID=2 " +
                   environment);
  }

  bool HasCall(const std::string& text) const {
    return fs::exists(calls_) &&
           ReadFile(calls_).find(text) != std::string::npos;
  }

  TemporaryFolder folder_;
  fs::path bin_ = folder_.Path() / "bin";
  fs::path plan_ = folder_.Path() / "a plan";
  fs::path calls_ = folder_.Path() / "calls";
};

TEST_F(SlurmScriptsTest, MergesBehindAllTiles) {
  const fs::path workspace = folder_.Path() / "workspace";
  SphereWorkspace().Write(workspace);
  Succeed(RunProgram("mesh_planner --num_tiles 3" +
                     PathOption("workspace_path", workspace) +
                     PathOption("output_path", plan_)));
  Succeed(Run("mesh_tiles " + Quote(plan_) + " " +
              Quote(folder_.Path() / "mesh.ply") + " --partition=big"));
  EXPECT_TRUE(HasCall("--array=0-2 --mem=")) << ReadFile(calls_);
  EXPECT_TRUE(HasCall("--dependency=afterok:100_0:100_1:100_2 --kill-on"));
  EXPECT_TRUE(HasCall("--partition=big"));
}

TEST_F(SlurmScriptsTest, RefinesColourAfterColour) {
  const std::string mesh = Quote(folder_.Path() / "mesh.ply");
  EXPECT_EQ(Run("refine_tiles " + Quote(plan_) + " " + mesh).exit_code, 1);
  std::string json = "{\n";
  for (const char* color : {"0", "1", "0", "2"}) {
    json += std::string("  {\n   \"color\": ") + color +
            ",\n   \"facets\": 1e4,\n   \"memory_gb\": 0.5,\n   \"thread_gb\": "
            "0.1\n"
            "  },\n";
  }
  WriteFile(plan_ / "refine.json", json);
  Succeed(Run("refine_tiles " + Quote(plan_) + " " + mesh));
  EXPECT_TRUE(HasCall("--array=0,2 --mem=676M")) << ReadFile(calls_);
  EXPECT_TRUE(HasCall("--array=1 "));
  EXPECT_TRUE(HasCall("--dependency=afterok:100_0:100_2 "));
  EXPECT_TRUE(HasCall("--array=3 "));
  EXPECT_TRUE(HasCall("--dependency=afterok:101_1 "));
  EXPECT_TRUE(HasCall("--dependency=afterok:102_3 "));
  EXPECT_TRUE(HasCall("--refined 1"));
  // Each thread of a job takes memory.
  for (const char* cores : {"--cpus-per-task=4", "--cpus-per-task 4", "-c 4"}) {
    Run("refine_tiles " + Quote(plan_) + " " + mesh + " " + cores);
    EXPECT_TRUE(HasCall("--array=0,2 --mem=1014M")) << ReadFile(calls_);
  }
}

TEST_F(SlurmScriptsTest, QueuesAgainWhatASignalHasEnded) {
  const std::string again = "scontrol requeue 7_2\n";
  for (const char* script : {"tile.sbatch", "refine.sbatch"}) {
    EXPECT_EQ(RunTask(script, 137, "STATE=RUNNING").exit_code, 137);
    EXPECT_TRUE(HasCall(again)) << script;
    RunTask(script, 137, "STATE=COMPLETING");  // after scancel
    EXPECT_FALSE(HasCall(again)) << script;
    RunTask(script, 137, "STATE=RUNNING SLURM_RESTART_COUNT=3");
    EXPECT_FALSE(HasCall(again)) << script;
    EXPECT_EQ(RunTask(script, 1, "STATE=RUNNING").exit_code, 1);
    EXPECT_FALSE(HasCall(again)) << script;
    Succeed(RunTask(script, 0, "STATE=RUNNING"));
    EXPECT_FALSE(HasCall(again)) << script;
  }
}

}  // namespace colmap_ext::scripts_test
