
#include <epoxy/gl.h>

#include <algorithm>
#include <optional>

#include "gl/egl_context.h"
#include "viewer/glfw_window.h"
#include "viewer/scene_renderer.h"
#include "viewer/viewer_session.h"

namespace colmap_ext {
namespace {

constexpr double kWait = 0.05;  // seconds between looks into the inbox
// Seconds without a change until a coarse picture is drawn in full. A choice.
constexpr double kStill = 0.25;
// Frames after a change; a panel gets its size in the second one.
constexpr int kFrames = 3;
constexpr double kSlowFrame = 0.04;  // seconds; chosen by hand

// The loop of a window.
class WindowLoop {
 public:
  WindowLoop(const WindowOptions& options, ViewerSession* session)
      : session_(session),
        window_(options.title, options.width, options.height),
        input_(window_, session),
        overlay_(window_) {}

  void Run() {
    int frames_left = 0;
    while (glfwWindowShouldClose(window_.Get()) == GLFW_FALSE &&
           !session_->IsClosed()) {
      Wait(frames_left > 0);
      const Eigen::Vector2i size = window_.Size();
      session_->SetSize(size.x(), size.y());
      const bool has_come = session_->Update(glfwGetTime());
      const bool has_input = input_.TakeChange();
      PickDoubleClicked();
      if (has_come || has_input) {
        frames_left = kFrames;
        last_change_ = glfwGetTime();
      }
      const bool is_refined =
          is_coarse_ && glfwGetTime() - last_change_ > kStill;
      if (size.minCoeff() > 0 && (frames_left > 0 || is_refined)) {
        if (has_come || has_input || is_refined) {
          DrawScene(!is_refined);
        }
        DrawWindow();
        frames_left = std::max(frames_left - 1, 0);
      }
    }
  }

 private:
  // Waits until the next frame.
  void Wait(bool is_more_to_draw) {
    if (is_more_to_draw || session_->IsFlying()) {
      glfwPollEvents();
    } else {
      glfwWaitEventsTimeout(kWait);
    }
  }

  // If drawing is slow, moving scenes are drawn with fewer samples and coarse
  // meshes.
  void DrawScene(bool is_moving) {
    const std::optional<View> picture = session_->Picture();
    if (!picture) {
      return;
    }
    DrawSettings settings = session_->Settings();
    is_coarse_ = is_moving && is_slow_;
    settings.samples = is_coarse_ ? 1 : settings.samples;
    settings.stand_in = is_coarse_;
    const double start = glfwGetTime();
    renderer_.Draw(session_->Scene(), *picture, settings);
    glFinish();
    if (!is_coarse_) {
      is_slow_ = glfwGetTime() - start > kSlowFrame;
    }
    is_drawn_ = true;
    SaveWished(*picture);
  }

  void DrawWindow() {
    glBindFramebuffer(GL_FRAMEBUFFER, 0);
    glClearColor(1, 1, 1, 1);
    glClear(GL_COLOR_BUFFER_BIT);
    if (is_drawn_) {
      renderer_.ShowIn(0);
    }
    overlay_.Draw(*session_);
    ThrowOnGlError("Drawing the window");
    glfwSwapBuffers(window_.Get());
  }

  void SaveWished(const View& picture) {
    if (session_->TakeScreenshotWish()) {
      renderer_.Draw(session_->Scene(), picture, session_->Settings());
      session_->SavePicture(renderer_.Read());
    }
  }

  void PickDoubleClicked() {
    if (const auto place = input_.TakeDoubleClick()) {
      if (is_coarse_) {
        DrawScene(false);  // The facets of the mesh itself are needed.
      }
      session_->Pick(renderer_.FacetAt(place->y(), place->x()));
    }
  }

  ViewerSession* session_;
  GlfwWindow window_;
  WindowInput input_;
  Overlay overlay_;
  SceneRenderer renderer_;
  double last_change_ = 0;  // seconds
  bool is_slow_ = false;
  bool is_coarse_ = false;  // the picture
  bool is_drawn_ = false;   // there is a picture
};

}  // namespace

void RunViewerWindow(const WindowOptions& options, ViewerSession* session) {
  WindowLoop loop(options, session);
  if (options.on_open) {
    options.on_open();
  }
  loop.Run();
}

}  // namespace colmap_ext
