#include "viewer_window/window_input.h"

#include <imgui.h>

#include <utility>

namespace colmap_ext {

namespace {

// GLFW's name for a key in the session's terms; letters and signs are the same.
int SessionKey(int key) {
  switch (key) {
    case GLFW_KEY_ESCAPE:
      return kKeyEscape;
    case GLFW_KEY_TAB:
      return kKeyTab;
    case GLFW_KEY_LEFT:
      return kKeyLeft;
    case GLFW_KEY_RIGHT:
      return kKeyRight;
    case GLFW_KEY_KP_ADD:
      return '+';
    case GLFW_KEY_KP_SUBTRACT:
      return '-';
    default:
      return key < kKeyEscape ? key : 0;
  }
}

WindowInput* Of(GLFWwindow* window) {
  return static_cast<WindowInput*>(glfwGetWindowUserPointer(window));
}

}  // namespace

WindowInput::WindowInput(const GlfwWindow& window, ViewerSession* session)
    : window_(window), session_(session) {
  glfwSetWindowUserPointer(window.Get(), this);
  InstallCallbacks();
  glfwGetCursorPos(window.Get(), &last_.x(), &last_.y());
  last_ = last_.cwiseProduct(window.Scale());
}

void WindowInput::InstallCallbacks() {
  GLFWwindow* const window = window_.Get();
  glfwSetKeyCallback(window, [](GLFWwindow* w, int key, int, int action, int) {
    Of(w)->OnKey(key, action);
  });
  glfwSetMouseButtonCallback(
      window, [](GLFWwindow* w, int button, int action, int modifiers) {
        Of(w)->OnButton(button, action, modifiers);
      });
  glfwSetCursorPosCallback(window, [](GLFWwindow* w, double x, double y) {
    Of(w)->OnMotion(Eigen::Vector2d(x, y).cwiseProduct(Of(w)->window_.Scale()));
  });
  glfwSetScrollCallback(window, [](GLFWwindow* w, double, double steps) {
    Of(w)->OnScroll(steps);
  });
  const auto redraw = [](GLFWwindow* w) { Of(w)->has_changed_ = true; };
  glfwSetWindowRefreshCallback(window, redraw);
  glfwSetFramebufferSizeCallback(
      window, [](GLFWwindow* w, int, int) { Of(w)->has_changed_ = true; });
}

void WindowInput::OnKey(int key, int action) {
  if (action != GLFW_RELEASE) {
    session_->Press(SessionKey(key));
    has_changed_ = true;
  }
}

void WindowInput::OnButton(int button, int action, int modifiers) {
  constexpr double kDoubleTime = 0.4;  // seconds
  constexpr double kDoubleWay = 4;     // px
  has_changed_ = true;
  if (action == GLFW_RELEASE) {
    drag_.reset();
    return;
  }
  if (ImGui::GetIO().WantCaptureMouse) {
    return;
  }
  const bool is_left = button == GLFW_MOUSE_BUTTON_LEFT;
  drag_ = is_left && (modifiers & GLFW_MOD_CONTROL) == 0 ? DragKind::kRotate
                                                         : DragKind::kPan;
  if (!is_left) {
    return;
  }
  const double now = glfwGetTime();
  if (now - last_click_time_ < kDoubleTime &&
      (last_ - last_click_).norm() < kDoubleWay) {
    double_click_ = last_.cast<int>();
    last_click_time_ = -1;
  } else {
    last_click_time_ = now;
    last_click_ = last_;
  }
}

void WindowInput::OnMotion(const Eigen::Vector2d& position) {
  if (drag_) {
    session_->Drag(*drag_, last_, position);
    has_changed_ = true;
  }
  last_ = position;
}

void WindowInput::OnScroll(double steps) {
  if (!ImGui::GetIO().WantCaptureMouse) {
    session_->Scroll(steps);
    has_changed_ = true;
  }
}

std::optional<Eigen::Vector2i> WindowInput::TakeDoubleClick() {
  return std::exchange(double_click_, std::nullopt);
}

bool WindowInput::TakeChange() { return std::exchange(has_changed_, false); }

}  // namespace colmap_ext
