#include "colmap_ext/terminal/terminal.h"

#include <sys/ioctl.h>
#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <csignal>
#include <cstdint>
#include <fstream>
#include <iterator>
#include <ostream>

#include <fmt/format.h>

#include "formats/atomic_file.h"

namespace colmap_ext {
namespace {

constexpr double kTerminalInterval = 0.1;  // seconds
constexpr double kLogInterval = 10;        // seconds

// Width of the terminal, characters; 0 if unknown.
size_t TerminalWidth() {
  winsize size{};
  return ioctl(STDOUT_FILENO, TIOCGWINSZ, &size) == 0 ? size.ws_col : 0;
}

std::string FormatSeconds(double seconds) {
  if (seconds < 60) {
    return fmt::format("{:.1f} s", seconds);
  }
  const auto whole_seconds = static_cast<int64_t>(seconds);
  return fmt::format("{} min {:02} s", whole_seconds / 60, whole_seconds % 60);
}

double Seconds(std::chrono::steady_clock::duration duration) {
  return std::chrono::duration<double>(duration).count();
}

constexpr int kSignals[] = {SIGINT, SIGTERM};

std::atomic<int> received{0};
static_assert(std::atomic<int>::is_always_lock_free);

struct sigaction previous_actions[std::size(kSignals)];

extern "C" void RememberSignal(int signal) {
  if (received.exchange(signal) != 0) {
    DieOfSignal(signal);
    return;
  }
  constexpr char kMessage[] =
      "\nStopping after this iteration; once more ends at once.\n";
  [[maybe_unused]] const ssize_t ignored =
      write(STDERR_FILENO, kMessage, sizeof(kMessage) - 1);
}

}  // namespace

std::string& ProgramName() {
  static std::string name = "colmap";
  return name;
}

std::string InShell(const std::filesystem::path& path) {
  std::string word = "'";
  for (const char c : path.string()) {
    word += c == '\'' ? "'\\''" : std::string(1, c);
  }
  return word + "'";
}

ProgressReporter::ProgressReporter(std::ostream& stream, bool is_terminal)
    : stream_(stream), is_terminal_(is_terminal) {}

// Ends the line of unfinished work.
ProgressReporter::~ProgressReporter() {
  if (is_terminal_ && !stage_.empty()) {
    stream_ << std::endl;
  }
}

void ProgressReporter::Update(std::string_view stage, double share) {
  share_ = share;
  if (stage != stage_) {
    Finish();
    stage_ = stage;
    stage_start_ = last_shown_ = Clock::now();
    if (is_terminal_) {
      Show();
    }
    return;
  }
  const double interval = is_terminal_ ? kTerminalInterval : kLogInterval;
  if (Seconds(Clock::now() - last_shown_) >= interval) {
    Show();
  }
}

void ProgressReporter::Note(const std::string& text) {
  if (is_terminal_) {
    note_ = text;
    Show();
  } else {
    stream_ << text << std::endl;
  }
}

void ProgressReporter::Finish() {
  if (stage_.empty()) {
    return;
  }
  const double seconds = Seconds(Clock::now() - stage_start_);
  std::string line = stage_ + " ... " + FormatSeconds(seconds);
  line.resize(std::max(line.size(), shown_length_), ' ');
  stream_ << (is_terminal_ ? "\r" : "") << line << std::endl;
  shown_length_ = 0;
  const auto same = std::ranges::find(stage_times_, stage_, &StageTime::stage);
  if (same != stage_times_.end()) {
    same->seconds += seconds;
  } else {
    stage_times_.push_back({stage_, seconds});
  }
  stage_.clear();
  note_.clear();
}

void ProgressReporter::Show() {
  const Clock::time_point now = Clock::now();
  const double elapsed = Seconds(now - stage_start_);
  std::string line = fmt::format("{} ... {:.0f} %", stage_, 100 * share_);
  if (share_ > 0.02 && elapsed > 2) {
    line += ", " + FormatSeconds(elapsed * (1 - share_) / share_) + " left";
  }
  if (!note_.empty()) {
    line += ", " + note_;
  }
  if (is_terminal_) {
    // A line that wraps cannot be overwritten.
    if (const size_t width = TerminalWidth(); width > 0) {
      line.resize(std::min(line.size(), width - 1));
    }
    const size_t length = line.size();
    line.resize(std::max(length, shown_length_), ' ');
    shown_length_ = length;
    stream_ << '\r' << line << std::flush;
  } else {
    stream_ << line << std::endl;
  }
  last_shown_ = now;
}

size_t PeakMemory() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return static_cast<size_t>(usage.ru_maxrss) * 1024;
}

size_t MachineMemory() {
  auto least = static_cast<size_t>(sysconf(_SC_PHYS_PAGES)) *
               static_cast<size_t>(sysconf(_SC_PAGESIZE));
  // Of version 2, "max" where there is no limit, and of version 1.
  for (const char* path : {"/sys/fs/cgroup/memory.max",
                           "/sys/fs/cgroup/memory/memory.limit_in_bytes"}) {
    if (size_t limit = 0; std::ifstream(path) >> limit) {
      least = std::min(least, limit);
    }
  }
  return least;
}

StopSignal::StopSignal() {
  received = 0;
  struct sigaction action = {};
  action.sa_handler = &RememberSignal;
  action.sa_flags = SA_RESTART;
  for (size_t i = 0; i < std::size(kSignals); ++i) {
    sigaction(kSignals[i], nullptr, &previous_actions[i]);
    if (previous_actions[i].sa_handler != SIG_IGN) {
      sigaction(kSignals[i], &action, nullptr);
    }
  }
}

StopSignal::~StopSignal() {
  for (size_t i = 0; i < std::size(kSignals); ++i) {
    sigaction(kSignals[i], &previous_actions[i], nullptr);
  }
}

int StopSignal::Received() { return received; }

}  // namespace colmap_ext
