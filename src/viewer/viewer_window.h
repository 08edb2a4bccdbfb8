#pragma once

#include <functional>
#include <stdexcept>
#include <string>

#include "viewer/viewer_session.h"

namespace colmap_ext {

// There is no window: no display, no OpenGL 4.5 on it, or the program was built
// without GLFW.
class NoWindowError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

struct WindowOptions {
  std::string title;
  int width = 1024;                         // px
  int height = 768;                         // px
  std::function<void()> on_open = nullptr;  // once there is a window
};

// Shows a session in a window until that is closed. To be called by the
// program's first thread; in viewer_window/, or no_window/ without GLFW.
// \throw NoWindowError if there is no window, GlError if OpenGL fails.
void RunViewerWindow(const WindowOptions& options, ViewerSession* session);

}  // namespace colmap_ext
