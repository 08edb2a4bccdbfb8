#pragma once

#include <string>

#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>
#include <Eigen/Core>

namespace colmap_ext {

// A window with an OpenGL 4.5 core context, which is the calling thread's
// current one.
class GlfwWindow {
 public:
  // \throw NoWindowError if there is no display, or no OpenGL 4.5 on it.
  GlfwWindow(const std::string& title, int width, int height);
  ~GlfwWindow();
  GlfwWindow(const GlfwWindow&) = delete;
  GlfwWindow& operator=(const GlfwWindow&) = delete;

  GLFWwindow* Get() const { return window_; }

  // Of what is drawn, px.
  Eigen::Vector2i Size() const;
  // Pixels for one of the units that the mouse has.
  Eigen::Vector2d Scale() const;

 private:
  GLFWwindow* window_ = nullptr;
};

}  // namespace colmap_ext
