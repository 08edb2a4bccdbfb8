#pragma once

#include <memory>
#include <optional>

#include "gl/gl_objects.h"
#include "viewer/viewer_session.h"
#include "viewer_window/glfw_window.h"

namespace colmap_ext {

// Text and pictures over the scene, by Dear ImGui.
class Overlay {
 public:
  // To be made after the window's callbacks are set, which it passes events on
  // to.
  explicit Overlay(const GlfwWindow& window);
  ~Overlay();
  Overlay(const Overlay&) = delete;
  Overlay& operator=(const Overlay&) = delete;

  // Draws it into the window's framebuffer.
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
