#include "colmap_ext/terminal/stop_signal.h"

#include <unistd.h>

#include <atomic>
#include <csignal>
#include <iterator>

#include "formats/atomic_file.h"

namespace colmap_ext {

namespace {

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
