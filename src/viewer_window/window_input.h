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

  // Whether a button is held.
  bool IsDragging() const { return drag_.has_value(); }

 private:
  void OnKey(int key, int action);
  void OnButton(int button, int action, int modifiers);
  void OnMotion(const Eigen::Vector2d& position);
  void OnScroll(double steps);
  void InstallCallbacks();
  Eigen::Vector2d Position() const;

  const GlfwWindow& window_;
  ViewerSession* session_;
  std::optional<DragKind> drag_;
  Eigen::Vector2d last_ = {0, 0};        // of the mouse while it drags, px
  Eigen::Vector2d last_click_ = {0, 0};  // px
  double last_click_time_ = -1;          // seconds
  std::optional<Eigen::Vector2i> double_click_;
  bool has_changed_ = true;
};

}  // namespace colmap_ext
