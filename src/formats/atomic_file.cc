#include "formats/atomic_file.h"

#include <fcntl.h>
#include <sched.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <csignal>
#include <cstdio>
#include <cstring>

#include "formats/errors.h"

namespace colmap_ext {
namespace {

constexpr size_t kWriteBufferSize = 1 << 20;  // bytes
constexpr int kMaxTemporaries = 16;
constexpr size_t kMaxPathLength = 4096;
constexpr int kSignals[] = {SIGINT, SIGTERM, SIGHUP};

// What a signal handler may touch: the temporary files that are there. An empty
// path is a free slot.
char temporaries[kMaxTemporaries][kMaxPathLength];
std::atomic<bool> is_dying = false;
std::atomic<pid_t> listing_thread = 0;  // that holds a Listing; 0: none

// While a thread adds or removes a temporary file: one at a time. A handler
// that runs in another thread waits until the list is right; after that no more
// files are made.
class Listing {
 public:
  Listing() {
    for (pid_t none = 0; !listing_thread.compare_exchange_weak(none, gettid());
         none = 0) {
      sched_yield();
    }
    if (is_dying) {
      listing_thread = 0;
      while (true) {
        pause();
      }
    }
  }
  ~Listing() { listing_thread = 0; }
  Listing(const Listing&) = delete;
  Listing& operator=(const Listing&) = delete;
};

extern "C" void HandleSignal(int signal) { DieOfSignal(signal); }

// Signals that would end the program end it by HandleSignal from now on.
int AddTemporary(const std::string& path) {
  for (const int signal : kSignals) {
    struct sigaction action = {};
    sigaction(signal, nullptr, &action);
    if (action.sa_handler == SIG_DFL) {
      action.sa_handler = &HandleSignal;
      sigaction(signal, &action, nullptr);
    }
  }
  for (int slot = 0; slot < kMaxTemporaries; ++slot) {
    if (temporaries[slot][0] == '\0' && path.size() < kMaxPathLength) {
      std::memcpy(temporaries[slot], path.c_str(), path.size() + 1);
      return slot;
    }
  }
  return -1;
}

void RemoveTemporary(int slot) {
  if (slot >= 0) {
    temporaries[slot][0] = '\0';
  }
}

std::string LastError() { return std::strerror(errno); }

std::filesystem::path FolderOf(const std::filesystem::path& path) {
  return path.has_parent_path() ? path.parent_path() : ".";
}

// Through a symbolic link, so that it stays one.
std::filesystem::path Resolve(const std::filesystem::path& path) {
  std::error_code error;
  const std::filesystem::path resolved =
      std::filesystem::weakly_canonical(path, error);
  return error ? path : resolved;
}

void SyncFolder(const std::filesystem::path& folder) {
  const int descriptor = open(folder.c_str(), O_RDONLY | O_DIRECTORY);
  if (descriptor >= 0) {
    fsync(descriptor);
    close(descriptor);
  }
}

void CheckPlace(const std::filesystem::path& path) {
  const std::filesystem::path resolved = Resolve(path);
  const std::filesystem::path folder = FolderOf(resolved);
  std::error_code error;
  if (!std::filesystem::is_directory(folder, error)) {
    throw FileError(
        path, "cannot be written: " + folder.string() + " is not a folder");
  }
  if (std::filesystem::exists(resolved, error) &&
      !std::filesystem::is_regular_file(resolved, error)) {
    throw FileError(path, "cannot be written: it is not a regular file");
  }
  if (access(folder.c_str(), W_OK | X_OK) != 0) {
    throw FileError(path, "cannot be written: " + LastError());
  }
}

}  // namespace

void DieOfSignal(int signal) {
  is_dying = true;
  for (pid_t other = listing_thread; other != 0 && other != gettid();
       other = listing_thread) {
    sched_yield();
  }
  for (const char* path : temporaries) {
    if (path[0] != '\0') {
      unlink(path);
    }
  }
  std::signal(signal, SIG_DFL);
  std::raise(signal);
}

// Some folders say that they can be written, and cannot, such as /proc.
void ExpectWritable(const std::filesystem::path& path) {
  const AtomicFile file(path);
}

AtomicFile::AtomicFile(const std::filesystem::path& path)
    : path_(Resolve(path)) {
  CheckPlace(path);
  buffer_.reserve(kWriteBufferSize);
  const std::string prefix =
      (FolderOf(path_) / ("." + path_.filename().string())).string() + "." +
      std::to_string(getpid()) + ".tmp";
  for (int i = 0; descriptor_ < 0; ++i) {
    temporary_path_ = prefix + std::to_string(i);
    const Listing listing;
    // Before the file is there, so that a signal that comes as it is made
    // removes it.
    cleanup_slot_ = AddTemporary(temporary_path_);
    descriptor_ = open(temporary_path_.c_str(),
                       O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
    if (descriptor_ < 0) {
      const int error = errno;
      RemoveTemporary(cleanup_slot_);
      if (error != EEXIST) {
        throw FileError(
            path_, std::string("cannot be written: ") + std::strerror(error));
      }
    }
  }
}

AtomicFile::~AtomicFile() {
  if (descriptor_ >= 0) {
    close(descriptor_);
  }
  const Listing listing;
  if (!temporary_path_.empty()) {
    unlink(temporary_path_.c_str());
  }
  RemoveTemporary(cleanup_slot_);
}

void AtomicFile::Write(const void* bytes, size_t num_bytes) {
  const char* begin = static_cast<const char*>(bytes);
  buffer_.insert(buffer_.end(), begin, begin + num_bytes);
  if (buffer_.size() >= kWriteBufferSize) {
    Flush();
  }
}

void AtomicFile::Flush() {
  size_t num_written = 0;
  while (num_written < buffer_.size()) {
    const ssize_t count = write(descriptor_, buffer_.data() + num_written,
                                buffer_.size() - num_written);
    if (count < 0 && errno != EINTR) {
      throw FileError(path_, "cannot be written: " + LastError());
    }
    num_written += count > 0 ? static_cast<size_t>(count) : 0;
  }
  buffer_.clear();
}

void AtomicFile::Sync() {
  if (descriptor_ < 0) {
    return;
  }
  Flush();
  const bool is_synced = fsync(descriptor_) == 0;
  const bool is_closed = close(descriptor_) == 0;
  descriptor_ = -1;
  if (!is_synced || !is_closed) {
    throw FileError(path_, "cannot be written: " + LastError());
  }
}

void AtomicFile::Rename() {
  if (std::rename(temporary_path_.c_str(), path_.c_str()) != 0) {
    throw FileError(path_, "cannot be written: " + LastError());
  }
  temporary_path_.clear();
}

AtomicFile* AtomicFiles::Add(const std::filesystem::path& path) {
  return files_.emplace_back(std::make_unique<AtomicFile>(path)).get();
}

void AtomicFiles::Sync() {
  for (const auto& file : files_) {
    file->Sync();
  }
}

void AtomicFiles::Commit() {
  Sync();
  for (const auto& file : files_) {
    file->Rename();
    SyncFolder(FolderOf(file->path_));
  }
}

void WriteText(const std::filesystem::path& path, const std::string& text,
               AtomicFiles* together) {
  AtomicFiles alone;
  (together != nullptr ? together : &alone)
      ->Add(path)
      ->Write(text.data(), text.size());
  alone.Commit();
}

}  // namespace colmap_ext
