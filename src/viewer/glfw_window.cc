#include "viewer/glfw_window.h"

#include <map>

#include <imgui.h>

namespace colmap_ext {
namespace {

std::string LastGlfwError() {
  const char* text = nullptr;
  glfwGetError(&text);
  return text != nullptr ? text : "unknown error";
}

// The session's code of a GLFW key; letters and signs are the same.
int SessionKey(int key) {
  static const std::map<int, int> keys = {
      {GLFW_KEY_ESCAPE, kKeyEscape}, {GLFW_KEY_TAB, kKeyTab},
      {GLFW_KEY_LEFT, kKeyLeft},     {GLFW_KEY_RIGHT, kKeyRight},
      {GLFW_KEY_KP_ADD, '+'},        {GLFW_KEY_KP_SUBTRACT, '-'}};
  const auto found = keys.find(key);
  return found != keys.end() ? found->second : key < kKeyEscape ? key : 0;
}

WindowInput* InputOf(GLFWwindow* window) {
  return static_cast<WindowInput*>(glfwGetWindowUserPointer(window));
}

}  // namespace

GlfwWindow::GlfwWindow(const std::string& title, int width, int height) {
  if (glfwInit() != GLFW_TRUE) {
    throw NoWindowError("No display: " + LastGlfwError());
  }
  glfwWindowHint(GLFW_CONTEXT_VERSION_MAJOR, 4);
  glfwWindowHint(GLFW_CONTEXT_VERSION_MINOR, 5);
  glfwWindowHint(GLFW_OPENGL_PROFILE, GLFW_OPENGL_CORE_PROFILE);
  // The scene is drawn into textures first.
  glfwWindowHint(GLFW_DEPTH_BITS, 0);
  glfwWindowHint(GLFW_STENCIL_BITS, 0);
  window_ = glfwCreateWindow(width, height, title.c_str(), nullptr, nullptr);
  if (window_ == nullptr) {
    const std::string error = LastGlfwError();
    glfwTerminate();
    throw NoWindowError("No window with OpenGL 4.5: " + error);
  }
  glfwMakeContextCurrent(window_);
  glfwSwapInterval(1);
}

GlfwWindow::~GlfwWindow() {
  glfwDestroyWindow(window_);
  glfwTerminate();
}

Eigen::Vector2i GlfwWindow::Size() const {
  Eigen::Vector2i size;
  glfwGetFramebufferSize(window_, &size.x(), &size.y());
  return size;
}

Eigen::Vector2d GlfwWindow::Scale() const {
  Eigen::Vector2i units;
  glfwGetWindowSize(window_, &units.x(), &units.y());
  return Size().cast<double>().cwiseQuotient(units.cwiseMax(1).cast<double>());
}

WindowInput::WindowInput(const GlfwWindow& window, ViewerSession* session)
    : window_(window), session_(session) {
  glfwSetWindowUserPointer(window.Get(), this);
  glfwSetKeyCallback(window.Get(),
                     [](GLFWwindow* w, int key, int, int action, int) {
                       if (action != GLFW_RELEASE) {
                         InputOf(w)->session_->Press(SessionKey(key));
                         InputOf(w)->has_changed_ = true;
                       }
                     });
  glfwSetMouseButtonCallback(
      window.Get(), [](GLFWwindow* w, int button, int action, int modifiers) {
        InputOf(w)->OnButton(button, action, modifiers);
      });
  glfwSetCursorPosCallback(window.Get(), [](GLFWwindow* w, double x, double y) {
    InputOf(w)->OnMotion({x, y});
  });
  glfwSetScrollCallback(window.Get(), [](GLFWwindow* w, double, double steps) {
    if (!ImGui::GetIO().WantCaptureMouse) {
      InputOf(w)->session_->Scroll(steps);
      InputOf(w)->has_changed_ = true;
    }
  });
  glfwSetWindowRefreshCallback(
      window.Get(), [](GLFWwindow* w) { InputOf(w)->has_changed_ = true; });
  glfwSetFramebufferSizeCallback(window.Get(), [](GLFWwindow* w, int, int) {
    InputOf(w)->has_changed_ = true;
  });
  glfwGetCursorPos(window.Get(), &last_.x(), &last_.y());
  last_ = last_.cwiseProduct(window.Scale());
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
  const Eigen::Vector2d pixel = position.cwiseProduct(window_.Scale());
  if (drag_) {
    session_->Drag(*drag_, last_, pixel);
    has_changed_ = true;
  }
  last_ = pixel;
}

}  // namespace colmap_ext
