#include "viewer_window/glfw_window.h"

#include <algorithm>

#include "viewer/viewer_window.h"

namespace colmap_ext {

namespace {

std::string LastError() {
  const char* text = nullptr;
  glfwGetError(&text);
  return text != nullptr ? text : "unknown error";
}

}  // namespace

GlfwWindow::GlfwWindow(const std::string& title, int width, int height) {
  if (glfwInit() != GLFW_TRUE) {
    throw NoWindowError("No display: " + LastError());
  }
  glfwWindowHint(GLFW_CONTEXT_VERSION_MAJOR, 4);
  glfwWindowHint(GLFW_CONTEXT_VERSION_MINOR, 5);
  glfwWindowHint(GLFW_OPENGL_PROFILE, GLFW_OPENGL_CORE_PROFILE);
  // All is drawn into textures first.
  glfwWindowHint(GLFW_DEPTH_BITS, 0);
  glfwWindowHint(GLFW_STENCIL_BITS, 0);
  window_ = glfwCreateWindow(width, height, title.c_str(), nullptr, nullptr);
  if (window_ == nullptr) {
    const std::string error = LastError();
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

}  // namespace colmap_ext
