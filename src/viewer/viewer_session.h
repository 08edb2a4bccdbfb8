#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include <Eigen/Core>

#include "labeling/view_pairs.h"
#include "scene/images.h"
#include "scene/view.h"
#include "viewer/orbit_camera.h"
#include "viewer/shown_scene.h"

namespace colmap_ext {

// Callbacks of the viewer into its program. All return at once; the SceneInbox
// delivers the loaded data.
struct ViewerHost {
  // \param index  of the view in the scene.
  std::function<void(size_t index, const View& view)> load_image;
  std::function<void(const std::vector<View>& views)> load_thumbnails;
  std::function<void(std::shared_ptr<const ShownMesh> mesh, uint32_t facet,
                     const View& first, const View& second)>
      match_facet;

  // \return the outcome, in one line.
  std::function<std::string(const ColorImage& picture)> save_picture;

  // Pauses or resumes the computation; empty without one.
  std::function<void(bool is_paused)> pause;
};

// Keys: capital letters, digits and signs by their characters, and these.
enum ViewerKey : int { kKeyEscape = 256, kKeyTab, kKeyLeft, kKeyRight };

enum class DragKind { kRotate, kPan };

class ViewerSession;

struct KeyAction {
  std::vector<int> keys;
  const char* name;  // of the keys, in the help
  const char* help;
  std::function<void(ViewerSession*)> act;
};

// The state of the viewer, changed by keys and mouse: all but its window.
class ViewerSession {
 public:
  // A double-clicked facet.
  struct Picked {
    uint32_t facet = 0;
    std::vector<uint32_t> views;   // that see it
    std::optional<ViewPair> pair;  // whose images are compared
    bool is_by_label = false;      // the pair comes from its label
  };

  // \param inbox  has to outlive the session.
  ViewerSession(SceneInbox* inbox, ViewerHost host, DrawSettings settings);

  // Applies the changes in the inbox and moves a flying camera.
  // \param seconds  since an arbitrary start
  // \return whether the picture changed.
  bool Update(double seconds);
  bool IsFlying() const { return flight_.has_value(); }

  void SetSize(int width, int height);  // of the picture, px
  void Press(int key);
  // In the order of the help.
  static const std::vector<KeyAction>& KeyActions();
  void Drag(DragKind kind, const Eigen::Vector2d& from,
            const Eigen::Vector2d& to);
  void Scroll(double steps);
  void Pick(uint32_t facet);

  // The camera of the picture; nullopt before the first mesh has arrived.
  std::optional<View> Picture() const;
  const ShownScene& Scene() const { return scene_; }
  const DrawSettings& Settings() const { return settings_; }
  const std::optional<Picked>& GetPicked() const { return picked_; }
  // The comparison of the picked facet; nullptr until it is done.
  std::shared_ptr<const FacetMatch> PickedMatch() const;

  // Lines of text about the picture.
  std::vector<std::string> Lines() const;
  bool IsHelpShown() const { return is_help_shown_; }
  bool IsClosed() const { return is_closed_ || scene_.is_over; }

  // Whether the user asked to save a picture since the last call.
  bool TakeScreenshotWish() { return std::exchange(wants_screenshot_, false); }
  void SavePicture(const ColorImage& picture);

 private:
  struct Flight {
    OrbitCamera from;
    OrbitCamera to;
    double start;  // seconds
  };

  void Fly(double seconds);
  void FlyTo(const OrbitCamera& camera);
  void GoToView(size_t view);
  void StepView(int step);
  void SetImage(bool is_shown);
  void LeaveView();
  std::string CameraLine() const;

  // Actions of keys.
  void ChangeOpacity(double change);
  void NextMesh();
  void Reset();
  void Pause();
  static std::vector<KeyAction> MakeKeyActions();

  SceneInbox* inbox_;
  ViewerHost host_;
  ShownScene scene_;
  DrawSettings settings_;
  std::optional<OrbitCamera> first_camera_;
  std::optional<OrbitCamera> camera_;
  std::optional<Flight> flight_;
  std::optional<size_t> at_view_;  // the scene's view that the camera is at
  std::optional<Picked> picked_;
  std::shared_ptr<const ShownMesh> picked_mesh_;
  std::string message_;  // of the last action
  double seconds_ = 0;
  int width_ = 1;
  int height_ = 1;
  bool are_thumbnails_asked_ = false;
  bool is_help_shown_ = false;
  bool is_paused_ = false;
  bool is_closed_ = false;
  bool wants_screenshot_ = false;
};

// Names and effects of the mouse's buttons, for the help.
inline constexpr std::pair<const char*, const char*> kMouseActions[] = {
    {"left drag", "rotate"},
    {"right or Ctrl drag", "pan"},
    {"wheel", "zoom"},
    {"double click", "select a face: its views and their agreement"},
};

// No window can be opened: no display, no OpenGL 4.5 on it, or a program
// without GLFW.
class NoWindowError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

struct WindowOptions {
  std::string title;
  int width = 1024;                         // px
  int height = 768;                         // px
  std::function<void()> on_open = nullptr;  // when the window is open
};

// Shows a session in a window until that is closed. Call it in the program's
// first thread.
// \throw NoWindowError if no window can be opened, GlError if OpenGL fails.
void RunViewerWindow(const WindowOptions& options, ViewerSession* session);

}  // namespace colmap_ext
