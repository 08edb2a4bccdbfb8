#pragma once

namespace colmap_ext {

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
