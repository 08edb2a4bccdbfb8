#pragma once

#include <chrono>
#include <cstddef>
#include <filesystem>
#include <iosfwd>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

namespace colmap_ext {

struct StageTime {
  std::string stage;
  double seconds = 0;  // wall time
};

// Shows the progress of long work and records the duration of each stage: one
// updated line on a terminal; in a log, a line every few seconds and at the end
// of each stage.
class ProgressReporter {
 public:
  ProgressReporter(std::ostream& stream, bool is_terminal);
  ~ProgressReporter();
  ProgressReporter(const ProgressReporter&) = delete;
  ProgressReporter& operator=(const ProgressReporter&) = delete;

  // \param share  finished fraction of the stage, 0 ... 1.
  void Update(std::string_view stage, double share);

  // Prints a note on the current stage: in the updated line on a terminal, on a
  // separate line in a log.
  void Note(const std::string& text);

  // Ends the last stage. A new one may follow.
  void Finish();

  // Times of the stages that have ended, in order of their first start; times
  // of repeated stages are added up.
  const std::vector<StageTime>& StageTimes() const { return stage_times_; }

 private:
  using Clock = std::chrono::steady_clock;

  void Show();

  std::ostream& stream_;
  bool is_terminal_;
  std::string stage_;  // empty between stages
  std::string note_;   // in the updated line
  double share_ = 0;   // of the last Update()
  Clock::time_point stage_start_;
  Clock::time_point last_shown_;
  size_t shown_length_ = 0;  // of the updated line, characters
  std::vector<StageTime> stage_times_;
};

// Peak memory of this process, bytes.
size_t PeakMemory();

// Memory of the machine, or of the container that the process runs in, bytes.
size_t MachineMemory();

// The running program in the commands that it prints: "colmap", unless changed.
std::string& ProgramName();

// A path as a word of such a command, whatever characters it has.
std::string InShell(const std::filesystem::path& path);

// A signal that ended the work before it was done.
class Interruption : public std::runtime_error {
 public:
  Interruption(int signal, const std::string& message)
      : std::runtime_error(message), signal_(signal) {}

  int Signal() const { return signal_; }

 private:
  int signal_;
};

// While it exists, the first SIGINT or SIGTERM is stored, so that work can end
// at a suitable point, and the second one ends the program. Ignored signals
// stay ignored. At most one object exists at a time.
class StopSignal {
 public:
  StopSignal();
  ~StopSignal();
  StopSignal(const StopSignal&) = delete;
  StopSignal& operator=(const StopSignal&) = delete;

  // The received signal, or 0.
  static int Received();
};

}  // namespace colmap_ext
