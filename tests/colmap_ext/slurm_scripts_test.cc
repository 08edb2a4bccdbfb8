// scripts/slurm with stand-ins for Slurm's programs, which write down how they
// are called.

#include <filesystem>
#include <string>

#include <gtest/gtest.h>

#include "tests/colmap_ext/run_shell.h"
#include "tests/formats/test_files.h"
#include "tests/workspace/sphere_workspace.h"

namespace colmap_ext {
namespace slurm_scripts_test {

namespace fs = std::filesystem;

class SlurmScriptsTest : public testing::Test {
 protected:
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
            ",\n   \"pixels\": 1e5,\n   \"memory_gb\": 0.5,\n   \"thread_gb\": "
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

}  // namespace slurm_scripts_test
}  // namespace colmap_ext
