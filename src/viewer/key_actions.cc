// What keys and mouse do: the table that the help is printed from.

#include <algorithm>

#include "viewer/viewer_session.h"

namespace colmap_ext {

// The actions, which alone see the session from inside.
struct ViewerActions {
  static KeyAction Mode(int key, const char* name, MeshMode mode,
                        const char* help) {
    return {{key}, name, help, [mode](ViewerSession* session) {
              session->settings_.mode = mode;
            }};
  }

  static KeyAction Toggle(int key, const char* name,
                          bool DrawSettings::*setting, const char* help) {
    return {{key}, name, help, [setting](ViewerSession* session) {
              session->settings_.*setting = !(session->settings_.*setting);
            }};
  }

  static void Image(ViewerSession* session) {
    session->SetImage(!session->settings_.image);
  }

  static void Opacity(ViewerSession* session, double change) {
    double& opacity = session->settings_.image_opacity;
    opacity = std::clamp(opacity + change, 0.0, 1.0);
  }

  static void NextMesh(ViewerSession* session) {
    const size_t count = session->scene_.meshes.size();
    if (count > 0) {
      session->settings_.mesh = (session->settings_.mesh + 1) % count;
      session->settings_.picked.reset();
      session->picked_.reset();
    }
  }

  static void Reset(ViewerSession* session) {
    session->LeaveView();
    if (session->first_camera_) {
      session->FlyTo(*session->first_camera_);
    }
  }

  static void Pause(ViewerSession* session) {
    if (!session->host_.pause) {
      session->message_ = "there is no refinement to pause";
      return;
    }
    session->is_paused_ = !session->is_paused_;
    session->host_.pause(session->is_paused_);
    session->message_ = session->is_paused_ ? "paused; T goes on" : "";
  }

  static std::vector<KeyAction> ForMeshes() {
    return {
        Mode('1', "1", MeshMode::kShaded, "shaded"),
        Mode('2', "2", MeshMode::kColor, "colours of the vertices"),
        Mode('3', "3", MeshMode::kNormals, "normals"),
        Mode('4', "4", MeshMode::kLabels, "labels: the pair of each face"),
        Mode('5', "5", MeshMode::kErrors, "errors"),
        Mode('6', "6", MeshMode::kConfidence, "confidence"),
        Toggle('W', "W", &DrawSettings::wireframe, "wireframe"),
        Toggle('B', "B", &DrawSettings::backfaces, "mark backs of faces"),
        Toggle('P', "P", &DrawSettings::points, "points"),
        Toggle('C', "C", &DrawSettings::cameras, "cameras with their images"),
    };
  }

  static std::vector<KeyAction> ForViews() {
    constexpr double kStep = 0.1;  // of the opacity
    using Session = ViewerSession*;
    return {
        {{kKeyRight, ']'},
         "Right ]",
         "next camera",
         [](Session session) { session->StepView(1); }},
        {{kKeyLeft, '['},
         "Left [",
         "previous camera",
         [](Session session) { session->StepView(-1); }},
        {{'G'}, "G", "the camera's image over the mesh", &Image},
        {{'+', '='},
         "+",
         "... stronger",
         [](Session session) { Opacity(session, kStep); }},
        {{'-'},
         "-",
         "... fainter",
         [](Session session) { Opacity(session, -kStep); }},
    };
  }

  static std::vector<KeyAction> ForAll() {
    using Session = ViewerSession*;
    return {
        {{kKeyTab}, "Tab", "next mesh", &NextMesh},
        {{'R'}, "R", "first view", &Reset},
        {{'S'},
         "S",
         "save a picture",
         [](Session session) { session->wants_screenshot_ = true; }},
        {{'T'}, "T", "pause the refinement, or go on", &Pause},
        {{'H'},
         "H",
         "this help",
         [](Session session) {
           session->is_help_shown_ = !session->is_help_shown_;
         }},
        {{kKeyEscape},
         "Esc",
         "close",
         [](Session session) { session->is_closed_ = true; }},
    };
  }
};

const std::vector<KeyAction>& KeyActions() {
  static const std::vector<KeyAction> actions = [] {
    std::vector<KeyAction> all = ViewerActions::ForMeshes();
    for (const auto& more :
         {ViewerActions::ForViews(), ViewerActions::ForAll()}) {
      all.insert(all.end(), more.begin(), more.end());
    }
    return all;
  }();
  return actions;
}

const std::vector<MouseHelp>& MouseActions() {
  static const std::vector<MouseHelp> actions = {
      {"left drag", "rotate"},
      {"right or Ctrl drag", "move"},
      {"wheel", "nearer, farther"},
      {"double click", "a face: its views, and how well they agree"},
  };
  return actions;
}

}  // namespace colmap_ext
