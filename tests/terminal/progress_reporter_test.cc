#include "colmap_ext/terminal/terminal.h"

#include <chrono>
#include <sstream>
#include <thread>

#include <gtest/gtest.h>

#include "tests/texts.h"

namespace colmap_ext::progress_reporter_test {

TEST(ProgressReporterTest, WritesALineAStageIntoALogAndAddsUpStages) {
  std::ostringstream stream;
  ProgressReporter reporter(stream, false);
  reporter.Update("First", 0);
  reporter.Update("First", 0.5);
  reporter.Update("Second", 0);
  reporter.Update("First", 0);
  reporter.Finish();
  reporter.Finish();
  EXPECT_EQ(stream.str(),
            "First ... 0.0 s\nSecond ... 0.0 s\nFirst ... 0.0 s\n");
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
  EXPECT_TRUE(Has(stream.str(), "\rFirst ... 25 %"));
  EXPECT_TRUE(stream.str().ends_with("s \n") || stream.str().ends_with("s\n"));
}

TEST(ProgressReporterTest, NotesHowItGoes) {
  for (const bool is_terminal : {false, true}) {
    std::ostringstream stream;
    ProgressReporter reporter(stream, is_terminal);
    reporter.Update("First", 0);
    reporter.Update("First", 0.5);
    reporter.Note("energy -7");
    EXPECT_TRUE(Has(stream.str(), is_terminal ? "\rFirst ... 50 %, energy -7"
                                              : "energy -7\n"));
    reporter.Update("Second", 0);
    EXPECT_FALSE(Has(stream.str(), "Second ... 0 %, energy"));
  }
}

TEST(ProgressReporterTest, KnowsThePeakOfMemory) {
  EXPECT_GT(PeakMemory(), size_t{1} << 20);
}

TEST(InShell, IsOneWordForAnyPath) {
  EXPECT_EQ(InShell("a plan"), "'a plan'");
  EXPECT_EQ(InShell("an $other's"), "'an $other'\\''s'");
}

}  // namespace colmap_ext::progress_reporter_test
