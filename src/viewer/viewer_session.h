#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "scene/view.h"
#include "viewer/draw_settings.h"
#include "viewer/orbit_camera.h"
#include "viewer/scene_inbox.h"
#include "viewer/shown_scene.h"
#include "viewer/viewer_host.h"

namespace colmap_ext {

// Keys are capital letters, digits and signs as they are, and these.
enum ViewerKey : int { kKeyEscape = 256, kKeyTab, kKeyLeft, kKeyRight };

enum class DragKind { kRotate, kPan };

// What a person looks at, and what keys and mouse do to it: all of the viewer
// but its window.
class ViewerSession {
 public:
  // What was double-clicked.
  struct Picked {
    uint32_t facet = 0;
    std::vector<uint32_t> views;   // that see it
    std::optional<ViewPair> pair;  // that it is compared in
    bool is_by_label = false;      // the pair is that of its label
  };

  // \param inbox  has to outlive it.
  ViewerSession(SceneInbox* inbox, ViewerHost host, DrawSettings settings);

  // Takes what has come, and goes on with a flight.
  // \param seconds  since some start
  // \return whether there is something new to be seen.
  bool Update(double seconds);
  bool IsFlying() const { return flight_.has_value(); }

  void SetSize(int width, int height);  // of the picture, px
  void Press(int key);
  void Drag(DragKind kind, const Eigen::Vector2d& from,
            const Eigen::Vector2d& to);
  void Scroll(double steps);
  void Pick(uint32_t facet);

  // What the picture shows; nothing before the first mesh has come.
  std::optional<View> Picture() const;
  const ShownScene& Scene() const { return scene_; }
  const DrawSettings& Settings() const { return settings_; }
  const std::optional<Picked>& GetPicked() const { return picked_; }
  // What two images show of what was picked; nullptr until they are compared.
  std::shared_ptr<const FacetMatch> PickedMatch() const;

  // Lines about what is seen.
  std::vector<std::string> Lines() const;
  bool IsHelpShown() const { return is_help_shown_; }
  bool IsClosed() const { return is_closed_ || scene_.is_over; }

  // Whether a picture is to be saved; once for each time.
  bool TakeScreenshotWish();
  void SavePicture(const ColorImage& picture);

 private:
  friend struct ViewerActions;

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

  SceneInbox* inbox_;
  ViewerHost host_;
  ShownScene scene_;
  DrawSettings settings_;
  std::optional<OrbitCamera> first_camera_;
  std::optional<OrbitCamera> camera_;
  std::optional<Flight> flight_;
  std::optional<size_t> at_view_;  // the camera is this one of the scene
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

// What keys do, in the order of the help.
struct KeyAction {
  std::vector<int> keys;
  const char* name;  // of the keys, in the help
  const char* help;
  std::function<void(ViewerSession*)> act;
};
const std::vector<KeyAction>& KeyActions();

// Names and effects of the mouse's buttons, for the help.
struct MouseHelp {
  const char* name;
  const char* help;
};
const std::vector<MouseHelp>& MouseActions();

}  // namespace colmap_ext
