#include "formats/atomic_file.h"

#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <thread>
#include <vector>

#include "tests/formats/test_files.h"

namespace colmap_ext {
namespace atomic_file_test {

namespace fs = std::filesystem;

constexpr uid_t kNobody = 65534;

class AtomicFileTest : public testing::Test {
 protected:
  static void WriteText(std::string_view text, AtomicFile* file) {
    file->Write(text.data(), text.size());
  }

  TemporaryFolder folder_;
  fs::path path_ = folder_.Path();
};

TEST_F(AtomicFileTest, AppearsWhenCommitted) {
  WriteFile(path_ / "b", "old");
  {
    AtomicFiles files;
    WriteText("new a", files.Add(path_ / "a"));
    colmap_ext::WriteText(path_ / "b", "new b", &files);
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
    WriteText(std::string(3 << 20, 'x'), &a);
    EXPECT_NE(List(path_), "a");
  }
  EXPECT_EQ(List(path_), "a");
  EXPECT_EQ(ReadFile(path_ / "a"), "old");
}

TEST_F(AtomicFileTest, KeepsTheOldFileWhenTheDiskIsFull) {
  WriteFile(path_ / "a", "old");
  EXPECT_TRUE(FailsOnAFullDisk(1 << 20, [this] {
    colmap_ext::WriteText(path_ / "a", std::string(3 << 20, 'x'));
  }));
  EXPECT_EQ(ReadFile(path_ / "a"), "old");
  EXPECT_EQ(List(path_), "a");
}

TEST_F(AtomicFileTest, OfFilesThatBelongTogetherNoneAppearsOnAFullDisk) {
  WriteFile(path_ / "a", "old");
  for (const size_t size : {20, 3 << 20}) {  // as it is written, and synced
    EXPECT_TRUE(FailsOnAFullDisk(10, [&] {
      AtomicFiles files;
      colmap_ext::WriteText(path_ / "a", "new", &files);
      colmap_ext::WriteText(path_ / "b", std::string(size, 'x'), &files);
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
    EXPECT_NE(
        FileErrorOf([&] { AtomicFile file(path); }).find("can not be written"),
        std::string::npos)
        << path;
  }
  EXPECT_NE(FileErrorOf([&] { ExpectWritable(path_ / "folder"); }), "");
  EXPECT_NO_THROW(ExpectWritable(path_ / "file"));
  EXPECT_EQ(List(path_), "file folder");
}

TEST_F(AtomicFileTest, RefusesFoldersWithoutPermission) {
  fs::permissions(path_, fs::perms::owner_read | fs::perms::owner_exec |
                             fs::perms::others_read | fs::perms::others_exec);
  const pid_t child = fork();
  if (child == 0) {
    if (geteuid() == 0 && setuid(kNobody) != 0) {  // root may write everywhere
      _exit(1);
    }
    try {
      AtomicFile file(path_ / "a");
    } catch (const FileError&) {
      _exit(7);
    }
    _exit(0);
  }
  int status = 0;
  waitpid(child, &status, 0);
  fs::permissions(path_, fs::perms::owner_all);
  EXPECT_EQ(WEXITSTATUS(status), 7);
}

TEST_F(AtomicFileTest, WritesThroughSymbolicLinks) {
  WriteFile(path_ / "there" / "file", "old");
  fs::create_symlink(path_ / "there" / "file", path_ / "link");
  colmap_ext::WriteText(path_ / "link", "new");
  EXPECT_TRUE(fs::is_symlink(path_ / "link"));
  EXPECT_EQ(ReadFile(path_ / "there" / "file"), "new");
}

TEST_F(AtomicFileTest, LeavesNothingBehindWhenInterrupted) {
  for (const int signal : {SIGINT, SIGTERM, SIGHUP}) {
    const pid_t child = fork();
    if (child == 0) {
      AtomicFile a(path_ / "a");
      AtomicFile b(path_ / "b");
      raise(signal);
      _exit(0);
    }
    int status = 0;
    waitpid(child, &status, 0);
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
        colmap_ext::WriteText(path_ / "b", text);
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

}  // namespace atomic_file_test
}  // namespace colmap_ext
