#pragma once

#include <memory>
#include <optional>
#include <string>
#include <utility>

#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>
#include <Eigen/Core>

#include "gl/gl_objects.h"
#include "viewer/viewer_session.h"

namespace colmap_ext {

// A window with an OpenGL 4.5 core context, current in the calling thread.
class GlfwWindow {
 public:
  // \throw NoWindowError if there is no display, or no OpenGL 4.5 on it.
  GlfwWindow(const std::string& title, int width, int height);
  ~GlfwWindow();
  GlfwWindow(const GlfwWindow&) = delete;
  GlfwWindow& operator=(const GlfwWindow&) = delete;

  GLFWwindow* Get() const { return window_; }

  // Size of the framebuffer, px.
  Eigen::Vector2i Size() const;
  // Pixels per unit of the mouse.
  Eigen::Vector2d Scale() const;

 private:
  GLFWwindow* window_ = nullptr;
};

// Passes keys and mouse of a window on to a session, with the meaning that they
// have in COLMAP's own window. Both have to outlive the object.
class WindowInput {
 public:
  WindowInput(const GlfwWindow& window, ViewerSession* session);

  // Position of a double click since the last call, px.
  std::optional<Eigen::Vector2i> TakeDoubleClick() {
    return std::exchange(double_click_, std::nullopt);
  }

  // Whether there was any input since the last call.
  bool TakeChange() { return std::exchange(has_changed_, false); }

 private:
  void OnButton(int button, int action, int modifiers);
  // \param position  units of the mouse
  void OnMotion(const Eigen::Vector2d& position);

  const GlfwWindow& window_;
  ViewerSession* session_;
  std::optional<DragKind> drag_;
  // Position of the mouse by the events so far, px.
  Eigen::Vector2d last_ = {0, 0};
  Eigen::Vector2d last_click_ = {0, 0};  // px
  double last_click_time_ = -1;          // seconds
  std::optional<Eigen::Vector2i> double_click_;
  bool has_changed_ = true;
};

// Text and pictures over the scene, by Dear ImGui.
class Overlay {
 public:
  // \pre the window's callbacks are set; the overlay passes events on to them.
  explicit Overlay(const GlfwWindow& window);
  ~Overlay();
  Overlay(const Overlay&) = delete;
  Overlay& operator=(const Overlay&) = delete;

  // Draws into the window's framebuffer.
  void Draw(const ViewerSession& session);

 private:
  // The pictures of a match.
  struct MatchTextures {
    std::shared_ptr<const FacetMatch> match;
    GlTexture first;
    GlTexture warped;
  };

  void DrawLines(const ViewerSession& session);
  void DrawHelp();
  void DrawPicked(const ViewerSession& session);
  void DrawMatch(const std::shared_ptr<const FacetMatch>& match);

  std::optional<MatchTextures> textures_;
};

}  // namespace colmap_ext
