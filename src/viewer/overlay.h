#pragma once

#include <memory>
#include <optional>

#include "gl/gl_objects.h"
#include "viewer/glfw_window.h"
#include "viewer/viewer_session.h"

namespace colmap_ext {

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
