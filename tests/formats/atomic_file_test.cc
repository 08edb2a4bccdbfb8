#include "formats/atomic_file.h"

#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <thread>
#include <vector>

#include "tests/formats/test_files.h"

namespace colmap_ext::atomic_file_test {

namespace fs = std::filesystem;

constexpr uid_t kNobody = 65534;

using AtomicFileTest = FolderTest;

TEST_F(AtomicFileTest, AppearsWhenCommitted) {
  WriteFile(path_ / "b", "old");
  {
    AtomicFiles files;
    WriteText(path_ / "a", "new a", &files);
    WriteText(path_ / "b", "new b", &files);
    files.Sync();
    EXPECT_FALSE(fs::exists(path_ / "a"));
    EXPECT_EQ(ReadFile(path_ / "b"), "old");
    files.Commit();
  }
  EXPECT_EQ(List(path_), "a b");
  EXPECT_EQ(ReadFile(path_ / "a"), "new a");
  EXPECT_EQ(ReadFile(path_ / "b"), "new b");
}

TEST_F(AtomicFileTest, LeavesNothingBehindUncommitted) {
  WriteFile(path_ / "a", "old");
  {
    AtomicFile a(path_ / "a");
    const std::string text(3 << 20, 'x');
    a.Write(text.data(), text.size());
    EXPECT_NE(List(path_), "a");
  }
  EXPECT_EQ(List(path_), "a");
  EXPECT_EQ(ReadFile(path_ / "a"), "old");
}

TEST_F(AtomicFileTest, KeepsTheOldFileWhenTheDiskIsFull) {
  WriteFile(path_ / "a", "old");
  EXPECT_TRUE(FailsOnAFullDisk(
      1 << 20, [this] { WriteText(path_ / "a", std::string(3 << 20, 'x')); }));
  EXPECT_EQ(ReadFile(path_ / "a"), "old");
  EXPECT_EQ(List(path_), "a");
}

TEST_F(AtomicFileTest, OfFilesThatBelongTogetherNoneAppearsOnAFullDisk) {
  WriteFile(path_ / "a", "old");
  for (const size_t size : {20, 3 << 20}) {  // as it is written, and synced
    EXPECT_TRUE(FailsOnAFullDisk(10, [&] {
      AtomicFiles files;
      WriteText(path_ / "a", "new", &files);
      WriteText(path_ / "b", std::string(size, 'x'), &files);
      files.Commit();
    }));
    EXPECT_EQ(ReadFile(path_ / "a"), "old");
    EXPECT_EQ(List(path_), "a");
  }
}

TEST_F(AtomicFileTest, RefusesPlacesThatCanNotBeWritten) {
  WriteFile(path_ / "file", "");
  fs::create_directory(path_ / "folder");
  for (const fs::path& path :
       {path_ / "none" / "a", path_ / "file" / "a", path_ / "folder",
        fs::path("/proc/a"), path_ / std::string(300, 'a')}) {
    SCOPED_TRACE(path);
    ExpectFileError("can not be written", [&] { AtomicFile file(path); });
  }
  EXPECT_NE(FileErrorOf([&] { ExpectWritable(path_ / "folder"); }), "");
  EXPECT_NO_THROW(ExpectWritable(path_ / "file"));
  EXPECT_EQ(List(path_), "file folder");
}

TEST_F(AtomicFileTest, RefusesFoldersWithoutPermission) {
  fs::permissions(path_, fs::perms::owner_read | fs::perms::owner_exec |
                             fs::perms::others_read | fs::perms::others_exec);
  const int status = RunInChild([&] {
    if (geteuid() == 0 && setuid(kNobody) != 0) {  // root may write everywhere
      _exit(1);
    }
    AtomicFile file(path_ / "a");
  });
  fs::permissions(path_, fs::perms::owner_all);
  EXPECT_EQ(WEXITSTATUS(status), 7);
}

TEST_F(AtomicFileTest, WritesThroughSymbolicLinks) {
  WriteFile(path_ / "there" / "file", "old");
  fs::create_symlink(path_ / "there" / "file", path_ / "link");
  WriteText(path_ / "link", "new");
  EXPECT_TRUE(fs::is_symlink(path_ / "link"));
  EXPECT_EQ(ReadFile(path_ / "there" / "file"), "new");
}

TEST_F(AtomicFileTest, LeavesNothingBehindWhenInterrupted) {
  for (const int signal : {SIGINT, SIGTERM, SIGHUP}) {
    const int status = RunInChild([&] {
      AtomicFile a(path_ / "a");
      AtomicFile b(path_ / "b");
      raise(signal);
    });
    EXPECT_TRUE(WIFSIGNALED(status));
    EXPECT_EQ(WTERMSIG(status), signal);
    EXPECT_EQ(List(path_), "");
  }
}

// Whole files, and no others. That the list of temporary files has no data race
// is seen by the thread sanitizer.
TEST_F(AtomicFileTest, SeveralThreadsMayMakeFiles) {
  std::vector<std::thread> threads;
  for (int thread = 0; thread < 4; ++thread) {
    threads.emplace_back([this, text = std::string(9, '0' + thread)] {
      for (int i = 0; i < 20; ++i) {
        const AtomicFile dropped(path_ / "a");
        WriteText(path_ / "b", text);
      }
    });
  }
  for (std::thread& thread : threads) {
    thread.join();
  }
  EXPECT_EQ(List(path_), "b");
  const std::string text = ReadFile(path_ / "b");
  EXPECT_EQ(text, std::string(9, text.front()));
}

}  // namespace colmap_ext::atomic_file_test
