#pragma once

namespace colmap_ext {

// While it lives, the first SIGINT or SIGTERM is remembered, so that work can
// be ended where it makes sense, and the second one ends the program. Signals
// that are ignored stay so. There can be one at a time.
class StopSignal {
 public:
  StopSignal();
  ~StopSignal();
  StopSignal(const StopSignal&) = delete;
  StopSignal& operator=(const StopSignal&) = delete;

  // The signal that came, or 0.
  static int Received();
};

}  // namespace colmap_ext
