#include "colmap_ext/terminal/progress_reporter.h"

#include <chrono>
#include <sstream>
#include <thread>

#include <gtest/gtest.h>

namespace colmap_ext {
namespace progress_reporter_test {

TEST(ProgressReporterTest, WritesALineAStageIntoALog) {
  std::ostringstream stream;
  ProgressReporter reporter(stream, false);
  reporter.Update("First", 0);
  reporter.Update("First", 0.5);
  reporter.Update("Second", 0);
  reporter.Finish();
  reporter.Finish();
  EXPECT_EQ(stream.str(), "First ... 0.0 s\nSecond ... 0.0 s\n");
  ASSERT_EQ(reporter.StageTimes().size(), 2);
  EXPECT_EQ(reporter.StageTimes()[1].stage, "Second");
}

TEST(ProgressReporterTest, MovesOneLineOnATerminal) {
  std::ostringstream stream;
  ProgressReporter reporter(stream, true);
  reporter.Update("First", 0);
  std::this_thread::sleep_for(std::chrono::milliseconds(150));
  reporter.Update("First", 0.25);
  reporter.Finish();
  EXPECT_NE(stream.str().find("\rFirst ... 25 %"), std::string::npos);
  EXPECT_TRUE(stream.str().ends_with("s \n") || stream.str().ends_with("s\n"));
}

TEST(ProgressReporterTest, NotesHowItGoes) {
  for (const bool is_terminal : {false, true}) {
    std::ostringstream stream;
    ProgressReporter reporter(stream, is_terminal);
    reporter.Update("First", 0);
    reporter.Update("First", 0.5);
    reporter.Note("energy -7");
    EXPECT_NE(stream.str().find(is_terminal ? "\rFirst ... 50 %, energy -7"
                                            : "energy -7\n"),
              std::string::npos)
        << stream.str();
    reporter.Update("Second", 0);
    EXPECT_EQ(stream.str().find("Second ... 0 %, energy"), std::string::npos);
  }
}

TEST(ProgressReporterTest, AddsUpStagesThatComeAgain) {
  std::ostringstream stream;
  ProgressReporter reporter(stream, false);
  for (const char* stage : {"First", "Second", "First"}) {
    reporter.Update(stage, 0);
  }
  reporter.Finish();
  EXPECT_EQ(reporter.StageTimes().size(), 2);
}

TEST(ProgressReporterTest, KnowsThePeakOfMemory) {
  EXPECT_GT(PeakMemory(), size_t{1} << 20);
}

}  // namespace progress_reporter_test
}  // namespace colmap_ext
