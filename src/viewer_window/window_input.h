#pragma once

#include <optional>

#include <Eigen/Core>

#include "viewer/viewer_session.h"
#include "viewer_window/glfw_window.h"

namespace colmap_ext {

// Passes keys and mouse of a window on to a session, as COLMAP's own window
// has them. Both have to outlive it.
class WindowInput {
 public:
  WindowInput(const GlfwWindow& window, ViewerSession* session);

  // Where a double click was, px, since the last call.
  std::optional<Eigen::Vector2i> TakeDoubleClick();

  // Whether anything came in since the last call.
  bool TakeChange();

 private:
  void OnKey(int key, int action);
  void OnButton(int button, int action, int modifiers);
  void OnMotion(const Eigen::Vector2d& position);
  void OnScroll(double steps);
  void InstallCallbacks();

  const GlfwWindow& window_;
  ViewerSession* session_;
  std::optional<DragKind> drag_;
  // Where the mouse is by the events up to now, px: it may be elsewhere
  // already.
  Eigen::Vector2d last_ = {0, 0};
  Eigen::Vector2d last_click_ = {0, 0};  // px
  double last_click_time_ = -1;          // seconds
  std::optional<Eigen::Vector2i> double_click_;
  bool has_changed_ = true;
};

}  // namespace colmap_ext
